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
    int64_t layer;
};

enum { ENVELOPE_ROWS = 10 };

/* Rows of an options table, ENVELOPE_ROWS of them. */
#define ENVELOPE_OPTIONS(e)                                                                        \
    MU_STRING("performative", "P", (e).performative, "the speech act, for example ask-one"),       \
        MU_STRING("level", "L", (e).level,                                                         \
                  "what it survives while it waits: ram (nothing), logged (the broker's "          \
                  "death), synced (the loss of power)"),                                           \
        MU_STRING("priority", "P", (e).priority, "low, normal or high: high overtakes"),           \
        MU_REAL("ttl", "S", (e).ttl_s, "it expires when it has waited so long", .max = 1e9),       \
        MU_STRING("language", "L", (e).language, "of the content; clips unless said"),             \
        MU_STRING("ontology", "O", (e).ontology, "what the words of the content mean"),            \
        MU_STRING("conversation", "C", (e).conversation, "that it belongs to"),                    \
        MU_STRING("reply-with", "R", (e).reply_with, "what an answer is to refer to"),             \
        MU_REAL("reply-by", "S", (e).reply_by_s, "no answer is wanted after this time of the run", \
                .max = 1e9),                                                                       \
        MU_INTEGER(                                                                                \
            "layer", "N", (e).layer,                                                               \
            "of the receiver's chain that takes it: 1 system, 2 queries, 3 speech acts, or "       \
            "one of its own",                                                                      \
            .fallback = "3", .min = 1, .max = UINT32_MAX)

/** Checks what was typed and puts it into a mail.  @return false: said on standard error */
bool envelope_fill(const struct envelope *e, struct mu_mail *mail, const char *verb);

#endif
