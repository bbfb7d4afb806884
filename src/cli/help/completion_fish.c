/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/help/completion.h"

#include <stdio.h>
#include <string.h>

static const char head[] =
    "# Completion of muster for fish.  Made by: muster completion fish\n"
    "\n"
    "# The words before the cursor, without muster.\n"
    "function __muster_words\n"
    "    set -l words (commandline -opc)\n"
    "    set -e words[1]\n"
    "    string join -- \\n $words\n"
    "end\n"
    "\n"
    "function __muster_needs_verb\n"
    "    set -l words (__muster_words)\n"
    "    test (count $words) -eq 0; or test \"$words\" = help\n"
    "end\n"
    "\n"
    "function __muster_in --argument-names verb\n"
    "    set -l words (__muster_words)\n"
    "    test \"$words[1]\" = $verb\n"
    "end\n"
    "\n"
    "# Prints the words of a kind.\n"
    "function __muster_fill --argument-names kind\n"
    "    switch $kind\n"
    "        case '' -\n"
    "            return\n"
    "        case '*|*'\n"
    "            string split '|' -- $kind\n"
    "            return\n"
    "        case folder\n"
    "            __fish_complete_directories (commandline -ct) ''\n"
    "            return\n"
    "        case file\n"
    "            __fish_complete_path (commandline -ct)\n"
    "            return\n"
    "        case recording\n"
    "            __fish_complete_suffix .mcap\n"
    "            return\n"
    "        case experiment\n"
    "            __fish_complete_suffix .yaml\n"
    "        case rules\n"
    "            __fish_complete_suffix .clp\n"
    "        case world\n"
    "            __fish_complete_suffix .world\n"
    "    end\n"
    "    set -l words (__muster_words)\n"
    "    set -l where\n"
    "    if set -l at (contains -i -- --domain $words); and test $at -lt (count $words)\n"
    "        set where --domain $words[(math $at + 1)]\n"
    "    end\n"
    "    command muster completion $kind $where 2>/dev/null\n"
    "end\n"
    "\n"
    "# Prints what may stand at the cursor as a word of a verb: valued are its options that have "
    "a\n"
    "# value, kinds those of its words.\n"
    "function __muster_place --argument-names valued kinds\n"
    "    set -l words (__muster_words)\n"
    "    set valued (string split -n ' ' -- $valued)\n"
    "    set kinds (string split -n ' ' -- $kinds)\n"
    "    set -l place 1\n"
    "    set -l is_value no\n"
    "    for word in $words[2..]\n"
    "        if test $is_value = yes\n"
    "            set is_value no\n"
    "        else if contains -- $word $valued\n"
    "            set is_value yes\n"
    "        else if not string match -q -- '-*' $word\n"
    "            set place (math $place + 1)\n"
    "        end\n"
    "    end\n"
    "    if test $place -gt (count $kinds); and string match -q '*...' -- $kinds[-1]\n"
    "        set place (count $kinds)\n"
    "    end\n"
    "    __muster_fill (string replace '...' '' -- $kinds[$place])\n"
    "end\n"
    "\n"
    "complete -c muster -e\n"
    "complete -c muster -f\n"
    "complete -c muster -n __muster_needs_verb -a help -d 'help, of a verb'\n";

static void fish_verbs(void)
{
    for (size_t i = 0; i < verbs_count; i++) {
        printf("complete -c muster -n __muster_needs_verb -a %s -d '", verbs[i].name);
        completion_quote(verbs[i].help, "\\", "\\'");
        puts("'");
    }
}

static void fish_option(const struct verb *verb, const struct completion_option *o)
{
    printf("complete -c muster -n '__muster_in %s' -l %s", verb->name, o->name);
    if (o->letter[0]) {
        printf(" -s %s", o->letter);
    }
    if (o->kind[0]) {
        printf(" -x -a '(__muster_fill \"%s\")'", o->kind);
    }
    fputs(" -d '", stdout);
    completion_quote(o->help, "\\", "\\'");
    puts("'");
}

static void fish_words(const struct verb *verb, const struct completion_option *options,
                       size_t count)
{
    printf("complete -c muster -n '__muster_in %s' -a '(__muster_place \"", verb->name);
    for (size_t i = 0; i < count; i++) {
        if (options[i].kind[0]) {
            printf(" --%s%s%s", options[i].name, options[i].letter[0] ? " -" : "",
                   options[i].letter);
        }
    }
    printf("\" \"%s\")'\n", verb->words);
}

bool completion_fish_print(void)
{
    struct completion_option options[COMPLETION_OPTIONS_MAX];
    fputs(head, stdout);
    fish_verbs();
    for (size_t i = 0; i < verbs_count; i++) {
        size_t count = completion_options(&verbs[i], options);
        if (count == 0) {
            return false;
        }
        for (size_t k = 0; k < count; k++) {
            fish_option(&verbs[i], &options[k]);
        }
        fish_words(&verbs[i], options, count);
    }
    return true;
}
