/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "core/exits.h"
#include "core/name.h"

#include <stdio.h>
#include <string.h>

/* @return false, said so: there is no such policy */
static bool box_policy_read(const char *word, muster_BoxPolicy *policy)
{
    static const char *const words[] = {[muster_BOX_REFUSE_NEW] = "refuse",
                                        [muster_BOX_DROP_OLDEST] = "drop-oldest",
                                        [muster_BOX_DROP_LOWEST] = "drop-lowest"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(word, words[i]) == 0) {
            *policy = (muster_BoxPolicy)i;
            return true;
        }
    }
    fprintf(stderr, "muster broker: --box-policy %s: use refuse, drop-oldest or drop-lowest\n",
            word);
    return false;
}

/* @return false, said so */
static bool name_check(const struct mu_options *o)
{
    char shown[MU_TEXT_SHOWN];
    if (o->words_count != 1) {
        fprintf(stderr, "muster broker: give it one name, for example: muster broker main\n");
        return false;
    }
    if (!mu_name_valid(o->words[0])) {
        fprintf(stderr,
                "muster broker: '%s' is no name of a broker: it must match "
                "[A-Za-z_][A-Za-z0-9_.-]{0,30}\n",
                mu_text_show(shown, o->words[0]));
        return false;
    }
    if (mu_name_reserved(o->words[0])) {
        fprintf(stderr,
                "muster broker: '%s' is reserved; give it another name, for example: "
                "muster broker main\n",
                o->words[0]);
        return false;
    }
    return true;
}

/* @return false, said so */
static bool store_check(const char *store)
{
    if (store && store[0] == '\0') {
        fprintf(stderr, "muster broker: --store '': expected a file, or none\n");
        return false;
    }
    return true;
}

int settings_read(struct settings *s, int argc, char **argv)
{
    struct mu_option table[] = {
        MU_NETWORK_OPTIONS(s->network),
        MU_REAL("delivery-interval", "MS", s->delivery_interval_ms,
                "hand a process mail at most this often; 0: at once", .fallback = "0",
                .environment = "MUSTER_DELIVERY_INTERVAL", .max = DISPATCH_INTERVAL_MAX_MS),
        MU_STRING("policy", "FILE", s->policy,
                  "which agent may direct which (default: observer and operator all)",
                  .environment = "MUSTER_POLICY"),
        MU_INTEGER("names", "N", s->names,
                   "names that it knows at a time; else the most, MU_AGENTS_MAX",
                   .environment = "MUSTER_NAMES", .min = 1, .max = MU_AGENTS_MAX),
        MU_INTEGER("name-expiry", "SECONDS", s->name_expiry_s,
                   "a name that is absent for so long, and holds nothing, makes room when needed",
                   .fallback = "600", .environment = "MUSTER_NAME_EXPIRY", .min = 1,
                   .max = NAME_EXPIRY_MAX_S),
        MU_STRING("audit", "FILE", s->audit,
                  "append every directive to this file, a line of JSON each",
                  .environment = "MUSTER_AUDIT"),
        MU_INTEGER("box-mails", "N", s->box_mails,
                   "mails that one box holds; else the most, MU_BOX_MAX",
                   .environment = "MUSTER_BOX_MAILS", .min = 1, .max = MU_BOX_MAX),
        MU_INTEGER("box-bytes", "BYTES", s->box_bytes,
                   "memory that they take; else MU_BOX_BYTES_MAX",
                   .environment = "MUSTER_BOX_BYTES", .min = 1024, .max = MU_BOX_BYTES_MAX),
        MU_STRING("box-policy", "POLICY", s->box_policy_word,
                  "when a box is full: refuse, drop-oldest, drop-lowest", .fallback = "refuse",
                  .environment = "MUSTER_BOX_POLICY"),
        MU_STRING("store", "FILE", s->store,
                  "where names and durable mail are kept, or none (default: "
                  "~/.local/state/muster/D-NAME.db)",
                  .environment = "MUSTER_STORE"),
        MU_FLAG("counters", s->counters, "list what each part counts, as Markdown, and end"),
        MU_OPTION_VERBOSE(s->verbose),
    };
    static struct mu_options options;
    options = (struct mu_options){.program = "muster broker",
                                  .usage = "NAME [OPTION...]",
                                  .about = "Knows every agent by name and carries their mail.",
                                  MU_OPTION_TABLE(table)};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (s->counters) {
        metrics_print();
        return MU_EXIT_DONE;
    }
    if (!box_policy_read(s->box_policy_word, &s->box_policy) || !store_check(s->store) ||
        !name_check(&options)) {
        return MU_EXIT_USAGE;
    }
    s->name = options.words[0];
    return MU_EXIT_DONE;
}
