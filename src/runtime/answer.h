/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file answer.h
 * An agent's part of the answer to a step, as text: an agent that is killed before it has gone out
 * says it again in its next life.
 */
#ifndef MUSTER_RUNTIME_ANSWER_H
#define MUSTER_RUNTIME_ANSWER_H

#include "core/text.h"
#include "muster/agent.h"

/* As it was written down; the text behind its first line is on loan. */
struct answer {
    bool drives;
    double forward_m_s, turn_rad_s;
    int paddles, lift;
    unsigned firings, mails;
    const char *text; /* names of the rules fired, and the mails */
    size_t len;
};

/** Adds what the agent is about to say in the answer to a step; between steps: that it is nothing.
 */
void answer_add(struct mu_text *out, const mu_agent *a);

/** Adds one as it was read: of an agent that has come back, and has said nothing since. */
void answer_keep(struct mu_text *out, const struct answer *kept);

/**
 * Reads that and moves behind it.
 *
 * @param out  text is NULL: it was nothing
 * @return false: it is none
 */
bool answer_read(const char **text, struct answer *out);

/**
 * Lets the agent do and send all that in the step at hand, before it has sent anything else.  Mail
 * of earlier steps that the broker has not answered for is in its outbox then, too.
 *
 * @param broker_had  the broker has had this answer: its mails bear the same numbers as then
 * @return false: the text is damaged, or there is no room; some of it may be said
 */
bool answer_repeat(mu_agent *a, const struct answer *kept, bool broker_had);

/**
 * Simulator and broker have had the answer: its mail waits for the broker's answers, and does not
 * go out again.
 *
 * @return as answer_repeat
 */
bool answer_recall(mu_agent *a, const struct answer *kept);

#endif
