/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/help/completion.h"

#include <stdio.h>

static const char table[] = "'\n\n"
                            "# Sets words and options of verb $1: the kinds of its words, and each "
                            "option with the kind of\n"
                            "# its value.\n"
                            "_muster_table() {\n"
                            "    case $1 in\n";

static const char tail[] =
    "        *) words= options= ;;\n"
    "    esac\n"
    "}\n"
    "\n"
    "# Sets kind to that of the value of option $1; empty: it is a flag.\n"
    "_muster_value() {\n"
    "    local option\n"
    "    kind=\n"
    "    for option in $options; do\n"
    "        case $option in \"$1\":*) kind=${option#*:} ;; esac\n"
    "    done\n"
    "}\n"
    "\n"
    "# Offers the lines of $1 that begin like the word at the cursor.\n"
    "_muster_offer() {\n"
    "    local IFS=$'\\n' line\n"
    "    for line in $1; do\n"
    "        [[ $line == \"$cur\"* ]] && COMPREPLY+=(\"$line\")\n"
    "    done\n"
    "}\n"
    "\n"
    "# Offers files whose name ends with $1, and folders.\n"
    "_muster_files() {\n"
    "    compopt -o filenames 2>/dev/null\n"
    "    _muster_offer \"$(compgen -d -- \"$cur\")\"\n"
    "    [[ $1 ]] && _muster_offer \"$(compgen -f -X \"!*$1\" -- \"$cur\")\"\n"
    "}\n"
    "\n"
    "# Offers the words of kind $1.\n"
    "_muster_fill() {\n"
    "    case $1 in\n"
    "        - | '') return ;;\n"
    "        *'|'*) _muster_offer \"${1//|/$'\\n'}\"; return ;;\n"
    "        folder) _muster_files ''; return ;;\n"
    "        file) compopt -o filenames 2>/dev/null; _muster_offer \"$(compgen -f -- \"$cur\")\"; "
    "return ;;\n"
    "        recording) _muster_files .mcap; return ;;\n"
    "        experiment) _muster_files .yaml ;;\n"
    "        rules) _muster_files .clp ;;\n"
    "        world) _muster_files .world ;;\n"
    "    esac\n"
    "    _muster_offer \"$(\"$muster\" completion \"$1\" ${domain:+--domain \"$domain\"} "
    "2>/dev/null | cut -f1)\"\n"
    "}\n"
    "\n"
    "_muster() {\n"
    "    local muster=$1 cur=${COMP_WORDS[COMP_CWORD]} words options kind= domain= last= place=0 "
    "i\n"
    "    COMPREPLY=()\n"
    "    if ((COMP_CWORD == 1)) || { ((COMP_CWORD == 2)) && [[ ${COMP_WORDS[1]} == help ]]; }; "
    "then\n"
    "        _muster_offer \"${_muster_verbs// /$'\\n'}\"\n"
    "        return\n"
    "    fi\n"
    "    _muster_table \"${COMP_WORDS[1]}\"\n"
    "    for ((i = 2; i < COMP_CWORD; i++)); do\n"
    "        case ${COMP_WORDS[i]} in\n"
    "            =) ;; # bash takes --option=value apart\n"
    "            -*) last=${COMP_WORDS[i]}; _muster_value \"$last\" ;;\n"
    "            *)\n"
    "                [[ $last == --domain ]] && domain=${COMP_WORDS[i]}\n"
    "                [[ $kind ]] || ((place++))\n"
    "                kind= last= ;;\n"
    "        esac\n"
    "    done\n"
    "    [[ $cur == = ]] && cur=\n"
    "    if [[ $kind ]]; then\n"
    "        _muster_fill \"$kind\"\n"
    "    elif [[ $cur == -* ]]; then\n"
    "        _muster_offer \"$(printf '%s\\n' $options | cut -d: -f1 | grep -e '^--')\"\n"
    "    else\n"
    "        set -- $words\n"
    "        ((place >= $#)) && [[ ${words: -3} == ... ]] && place=$(($# - 1))\n"
    "        shift $((place < $# ? place : $#))\n"
    "        _muster_fill \"${1%...}\"\n"
    "    fi\n"
    "}\n"
    "complete -F _muster muster\n";

static void bash_option(const struct completion_option *o)
{
    const char *colon = o->kind[0] ? ":" : "";
    printf("--%s%s%s ", o->name, colon, o->kind);
    if (o->letter[0]) {
        printf("-%s%s%s ", o->letter, colon, o->kind);
    }
}

bool completion_bash_print(void)
{
    struct completion_option options[COMPLETION_OPTIONS_MAX];
    fputs("# Completion of muster for bash.  Made by: muster completion bash\n\n"
          "_muster_verbs='help",
          stdout);
    for (size_t i = 0; i < verbs_count; i++) {
        printf(" %s", verbs[i].name);
    }
    fputs(table, stdout);
    for (size_t i = 0; i < verbs_count; i++) {
        size_t count = completion_options(&verbs[i], options);
        if (count == 0) {
            return false;
        }
        printf("        %s) words='%s' options='", verbs[i].name, verbs[i].words);
        for (size_t k = 0; k < count; k++) {
            bash_option(&options[k]);
        }
        puts("' ;;");
    }
    fputs(tail, stdout);
    return true;
}
