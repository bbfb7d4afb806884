/* SPDX-License-Identifier: Apache-2.0 */
/* muster completion: what bash, zsh and fish source to complete command lines. */
#include "cli/help/completion.h"

#include "core/exits.h"
#include "core/options.h"
#include "muster/limits.h"

#include <stdio.h>
#include <string.h>

static struct completion_live live;

static struct mu_option option_table[] = {
    MU_INTEGER("domain", "D", live.domain, "DDS domain, of names that live",
               .environment = "MUSTER_DOMAIN", .max = MU_DOMAIN_MAX),
    MU_REAL("wait-broker", "S", live.wait_s, "wait so long for a broker", .fallback = "0.3",
            .max = 1e9),
};

int completion_verb(int argc, char **argv)
{
    static struct mu_options o = {
        .program = "muster completion",
        .usage = "bash | zsh | fish | KIND [OPTION...]",
        .about =
            "Prints what a shell sources to complete verbs, options, files and names; make install "
            "puts it where the shells look for it.  By hand: source <(muster completion bash).  "
            "With a KIND it prints the words, a line each: agent, target, host, broker, group, "
            "service, run (what lives), experiment, rules, world (what belongs to muster).",
        MU_OPTION_TABLE(option_table)};
    static const struct {
        const char *name;
        bool (*print)(void);
    } shells[] = {{"bash", completion_bash_print},
                  {"zsh", completion_zsh_print},
                  {"fish", completion_fish_print}};
    live.domain = -1;
    mu_result parsed = mu_options_parse(&o, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    const char *word = o.words_count == 1 ? o.words[0] : "";
    for (size_t i = 0; i < sizeof shells / sizeof shells[0]; i++) {
        if (strcmp(word, shells[i].name) == 0) {
            return shells[i].print() ? MU_EXIT_DONE : MU_EXIT_CRASH;
        }
    }
    int code = completion_live(word, &live);
    if (code == MU_EXIT_USAGE) {
        fputs("muster completion: expected bash, zsh or fish, for example: "
              "source <(muster completion bash)\n",
              stderr);
    }
    return code;
}
