/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file envelope.h
 * The options of a mail from the command line: its performative, its level, how long it lives.
 */
#ifndef MUSTER_CTL_ENVELOPE_H
#define MUSTER_CTL_ENVELOPE_H

#include "core/options.h"
#include "muster/agent.h"

/* As typed; NULL: not said. */
struct envelope {
    const char *performative, *language, *ontology, *conversation, *reply_with;
    const char *level, *priority;
    double ttl_s, reply_by_s; /* 0: not said */
    long long layer;
};

enum { ENVELOPE_ROWS = 10 };

/* Rows of an options table, ENVELOPE_ROWS of them. */
#define ENVELOPE_TEXT(option, what, member, text)                                   \
    {                                                                               \
        .name = (option), .kind = MU_OPTION_STRING, .unit = (what), .help = (text), \
        .target = &(member)                                                         \
    }
#define ENVELOPE_SECONDS(option, member, text)                                             \
    {                                                                                      \
        .name = (option), .kind = MU_OPTION_REAL, .unit = "S", .max = 1e9, .help = (text), \
        .target = &(member)                                                                \
    }
#define ENVELOPE_OPTIONS(e)                                                                      \
    ENVELOPE_TEXT("performative", "P", (e).performative, "the speech act, for example ask-one"), \
        ENVELOPE_TEXT("level", "L", (e).level,                                                   \
                      "what it survives while it waits: ram (nothing), logged (the broker's "    \
                      "death), synced (the loss of power)"),                                     \
        ENVELOPE_TEXT("priority", "P", (e).priority, "low, normal or high: high overtakes"),     \
        ENVELOPE_SECONDS("ttl", (e).ttl_s, "it expires when it has waited so long"),             \
        ENVELOPE_TEXT("language", "L", (e).language, "of the content; clips unless said"),       \
        ENVELOPE_TEXT("ontology", "O", (e).ontology, "what the words of the content mean"),      \
        ENVELOPE_TEXT("conversation", "C", (e).conversation, "that it belongs to"),              \
        ENVELOPE_TEXT("reply-with", "R", (e).reply_with, "what an answer is to refer to"),       \
        ENVELOPE_SECONDS("reply-by", (e).reply_by_s,                                             \
                         "no answer is wanted after this time of the run"),                      \
    {                                                                                            \
        .name = "layer", .kind = MU_OPTION_INTEGER, .unit = "N", .min = 1, .max = UINT32_MAX,    \
        .fallback = "3",                                                                         \
        .help = "of the receiver's chain that takes it: 1 system, 2 queries, 3 speech acts, or " \
                "one of its own",                                                                \
        .target = &(e).layer                                                                     \
    }

/** Checks what was typed and puts it into a mail.  @return false: said on standard error */
bool envelope_fill(const struct envelope *e, struct mu_mail *mail, const char *verb);

#endif
