/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "core/exits.h"
#include "core/name.h"
#include "core/options.h"
#include "core/text.h"
#include "muster/limits.h"

#include <stdio.h>
#include <string.h>

#define BOX_OPTIONS(s)                                                                          \
    {.name = "box-mails",                                                                       \
     .kind = MU_OPTION_INTEGER,                                                                 \
     .unit = "N",                                                                               \
     .environment = "MUSTER_BOX_MAILS",                                                         \
     .help = "mails that one box holds; else the most, MU_BOX_MAX",                             \
     .target = &(s)->box_mails,                                                                 \
     .min = 1,                                                                                  \
     .max = MU_BOX_MAX},                                                                        \
        {.name = "box-bytes",                                                                   \
         .kind = MU_OPTION_INTEGER,                                                             \
         .unit = "BYTES",                                                                       \
         .environment = "MUSTER_BOX_BYTES",                                                     \
         .help = "memory that they take; else MU_BOX_BYTES_MAX",                                \
         .target = &(s)->box_bytes,                                                             \
         .min = 1024,                                                                           \
         .max = MU_BOX_BYTES_MAX},                                                              \
    {                                                                                           \
        .name = "box-policy", .kind = MU_OPTION_STRING, .unit = "POLICY", .fallback = "refuse", \
        .environment = "MUSTER_BOX_POLICY",                                                     \
        .help = "when a box is full: refuse, drop-oldest, drop-lowest",                         \
        .target = &(s)->box_policy_word                                                         \
    }

#define COURIER_AND_TRUST_OPTIONS(s)                                                              \
    {.name = "delivery-interval",                                                                 \
     .kind = MU_OPTION_REAL,                                                                      \
     .unit = "MS",                                                                                \
     .fallback = "0",                                                                             \
     .environment = "MUSTER_DELIVERY_INTERVAL",                                                   \
     .help = "hand a process mail at most this often; 0: at once",                                \
     .target = &(s)->delivery_interval_ms,                                                        \
     .max = DISPATCH_INTERVAL_MAX_MS},                                                            \
        {.name = "policy",                                                                        \
         .kind = MU_OPTION_STRING,                                                                \
         .unit = "FILE",                                                                          \
         .environment = "MUSTER_POLICY",                                                          \
         .help = "who may direct whom (default: observer and operator all)",                      \
         .target = &(s)->policy},                                                                 \
        {.name = "name-expiry",                                                                   \
         .kind = MU_OPTION_INTEGER,                                                               \
         .unit = "SECONDS",                                                                       \
         .fallback = "600",                                                                       \
         .environment = "MUSTER_NAME_EXPIRY",                                                     \
         .help = "a name that is absent for so long, and holds nothing, makes room when needed",  \
         .target = &(s)->name_expiry_s,                                                           \
         .min = 1,                                                                                \
         .max = NAME_EXPIRY_MAX_S},                                                               \
    {                                                                                             \
        .name = "audit", .kind = MU_OPTION_STRING, .unit = "FILE", .environment = "MUSTER_AUDIT", \
        .help = "append every directive to this file, a line of JSON each", .target = &(s)->audit \
    }

/* @return false, said so: there is no such policy */
static bool box_policy_read(const char *word, muster_BoxPolicy *policy)
{
    static const struct {
        const char *word;
        muster_BoxPolicy policy;
    } policies[] = {{"refuse", muster_BOX_REFUSE_NEW},
                    {"drop-oldest", muster_BOX_DROP_OLDEST},
                    {"drop-lowest", muster_BOX_DROP_LOWEST}};
    for (size_t i = 0; i < sizeof policies / sizeof policies[0]; i++) {
        if (strcmp(word, policies[i].word) == 0) {
            *policy = policies[i].policy;
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

int settings_read(struct settings *s, const char **name, int argc, char **argv)
{
    struct mu_option table[] = {
        MU_NETWORK_OPTIONS(s->network),
        COURIER_AND_TRUST_OPTIONS(s),
        BOX_OPTIONS(s),
        {.name = "store",
         .kind = MU_OPTION_STRING,
         .unit = "FILE",
         .environment = "MUSTER_STORE",
         .help = "where names and durable mail are kept, or none (default: "
                 "~/.local/state/muster/D-NAME.db)",
         .target = &s->store},
        {.name = "counters",
         .kind = MU_OPTION_FLAG,
         .help = "list what each part counts, as Markdown, and end",
         .target = &s->counters},
        MU_OPTION_VERBOSE(s->verbose),
    };
    static struct mu_options options;
    options = (struct mu_options){.program = "muster broker",
                                  .usage = "NAME [OPTION...]",
                                  .about = "Knows every agent by name and carries their mail.",
                                  .table = table,
                                  .count = sizeof table / sizeof table[0]};
    *name = NULL;
    s->box_mails = MU_BOX_MAX;
    s->box_bytes = MU_BOX_BYTES_MAX;
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
    *name = options.words[0];
    return MU_EXIT_DONE;
}
