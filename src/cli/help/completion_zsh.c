/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/help/completion.h"

#include <stdio.h>
#include <string.h>

static const char head[] =
    "#compdef muster\n"
    "# Completion of muster for zsh.  Made by: muster completion zsh\n"
    "\n"
    "# Offers the words of kind $1.\n"
    "_muster_fill() {\n"
    "    local -a found where\n"
    "    local line\n"
    "    case $1 in\n"
    "        folder) _files -/; return ;;\n"
    "        file) _files; return ;;\n"
    "        recording) _files -g '*.mcap'; return ;;\n"
    "    esac\n"
    "    [[ -n ${opt_args[--domain]} ]] && where=(--domain ${opt_args[--domain]})\n"
    "    for line in ${(f)\"$(_call_program names muster completion $1 $where 2>/dev/null)\"}; do\n"
    "        found+=(\"${${line%%$'\\t'*}//:/\\\\:}:${line#*$'\\t'}\")\n"
    "    done\n"
    "    (( ${#found} )) && _describe -t names $1 found\n"
    "    case $1 in\n"
    "        experiment) _files -g '*.yaml' ;;\n"
    "        rules) _files -g '*.clp' ;;\n"
    "        world) _files -g '*.world' ;;\n"
    "    esac\n"
    "}\n"
    "\n"
    "_muster() {\n"
    "    local -A opt_args\n"
    "    local -a verbs\n";

static const char tail[] = "    esac\n"
                           "}\n"
                           "\n"
                           "if [[ $funcstack[1] == _muster ]]; then\n"
                           "    _muster \"$@\"\n"
                           "else\n"
                           "    compdef _muster muster\n"
                           "fi\n";

static void zsh_verbs(void)
{
    puts("    verbs=(");
    for (size_t i = 0; i < verbs_count; i++) {
        printf("        '%s:", verbs[i].name);
        completion_quote(verbs[i].help, ":", "'\\''");
        puts("'");
    }
    fputs("    )\n"
          "    if (( CURRENT == 2 )) || [[ $words[2] == help && CURRENT -eq 3 ]]; then\n"
          "        _describe -t verbs verb verbs\n"
          "        return\n"
          "    fi\n"
          "    shift words\n"
          "    (( CURRENT-- ))\n"
          "    case $words[1] in\n",
          stdout);
}

static void zsh_action(const char *kind)
{
    if (strchr(kind, '|')) {
        fputs("(", stdout);
        for (; *kind; kind++) {
            putchar(*kind == '|' ? ' ' : *kind);
        }
        fputs(")", stdout);
    } else {
        printf(strcmp(kind, "-") == 0 ? " " : " _muster_fill %s", kind);
    }
}

/* @param dashes  "--", and "=" behind the name; or "-" */
static void zsh_form(const struct completion_option *o, const char *dashes, const char *name,
                     const char *end)
{
    printf(" \\\n                '%s%s%s%s[", o->is_many ? "*" : "", dashes, name,
           o->kind[0] ? end : "");
    completion_quote(o->help, "[]\\", "'\\''");
    fputs("]", stdout);
    if (o->kind[0]) {
        fputs(":", stdout);
        completion_quote(o->unit, ":[]", "'\\''");
        fputs(":", stdout);
        zsh_action(o->kind);
    }
    fputs("'", stdout);
}

static void zsh_option(const struct completion_option *o)
{
    zsh_form(o, "--", o->name, "=");
    if (o->letter[0]) {
        zsh_form(o, "-", o->letter, "+");
    }
}

static void zsh_words(const struct verb *verb)
{
    const char *at = verb->words;
    for (unsigned place = 1; *at; place++) {
        char kind[128];
        size_t len = strcspn(at, " ");
        bool is_many = len > 3 && strncmp(at + len - 3, "...", 3) == 0;
        snprintf(kind, sizeof kind, "%.*s", (int)(is_many ? len - 3 : len), at);
        if (is_many) {
            printf(" \\\n                '*:word:");
        } else {
            printf(" \\\n                '%u:word:", place);
        }
        zsh_action(kind);
        fputs("'", stdout);
        at += len + (at[len] == ' ');
    }
}

bool completion_zsh_print(void)
{
    struct completion_option options[COMPLETION_OPTIONS_MAX];
    fputs(head, stdout);
    zsh_verbs();
    for (size_t i = 0; i < verbs_count; i++) {
        size_t count = completion_options(&verbs[i], options);
        if (count == 0) {
            return false;
        }
        printf("        %s)\n            _arguments -s", verbs[i].name);
        for (size_t k = 0; k < count; k++) {
            zsh_option(&options[k]);
        }
        zsh_words(&verbs[i]);
        puts("\n            ;;");
    }
    fputs(tail, stdout);
    return true;
}
