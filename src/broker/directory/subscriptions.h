/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file subscriptions.h
 * Standing queries on services: who asked what, and which lines he has been told of.
 *
 * What a subscriber is told is the difference between what he has been told and what he would find
 * now; so nothing is said twice, whatever it was that changed.
 */
#ifndef MUSTER_BROKER_SUBSCRIPTIONS_H
#define MUSTER_BROKER_SUBSCRIPTIONS_H

#include "core/attributes.h"

#include <stdint.h>

/** A bit for each line of the services. */
enum { SUBSCRIPTIONS_WORDS = (MU_SERVICES_MAX + 63) / 64 };

struct subscription {
    char agent[MU_NAME_MAX + 1];
    char text[MU_QUERY_MAX + 1];
    char in_reply_to[MU_FIELD_MAX + 1], conversation[MU_FIELD_MAX + 1]; /* of what he is sent */
    struct mu_query query;
    uint64_t told[SUBSCRIPTIONS_WORDS]; /* lines that he knows of */
    uint64_t owed[SUBSCRIPTIONS_WORDS]; /* gone from his sight without a word */
};

struct subscriptions {
    struct subscription *at; /* MU_SUBSCRIPTIONS_MAX of them */
    uint32_t *order;         /* [0, count) in use, the oldest first; then those given back */
    uint32_t count, used;
};

void subscriptions_init(struct subscriptions *s);

/** @return the index-th in order of age; index < count */
struct subscription *subscriptions_at(const struct subscriptions *s, uint32_t index);

/** @return the index of an agent's query with that text, or MU_NONE */
uint32_t subscriptions_find(const struct subscriptions *s, const char *agent, const char *text);

/** @return a new one, told of nothing, last in order; NULL: full */
struct subscription *subscriptions_add(struct subscriptions *s, const char *agent,
                                       const char *text);

void subscriptions_remove(struct subscriptions *s, uint32_t index);

/** Notes whether a line is found now.  @return whether that is news */
bool subscriptions_note(struct subscription *s, uint32_t line, bool found);

/** Notes whether he is owed a word about a line.  @return whether he was */
bool subscriptions_owe(struct subscription *s, uint32_t line, bool owed);

/** Notes the lines that somebody was told are found, and has not heard otherwise of since. */
void subscriptions_rest(const struct subscriptions *s, uint64_t lines[SUBSCRIPTIONS_WORDS]);

/** A line of the services is no more; another one will have its index. */
void subscriptions_forget(struct subscriptions *s, uint32_t line);

#endif
