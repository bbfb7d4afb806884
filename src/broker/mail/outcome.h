/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file outcome.h
 * What becomes of a mail, and that its sender is told.
 */
#ifndef MUSTER_BROKER_OUTCOME_H
#define MUSTER_BROKER_OUTCOME_H

#include "broker/base/store.h"

struct broker;

/** Tells an agent what became of its mails, by way of another broker if it lives beyond one. */
void outcome_tell(struct broker *b, uint32_t sender, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result);

/** The last word on a mail; what its other receivers do is not told any more. */
void outcome_end(struct broker *b, struct mail *m, muster_Outcome result);

/**
 * The last word on a mail that is in no box, and ends with it.
 *
 * @param unknown  names among its receivers that nobody ever had: that is the worse news
 */
void outcome_refuse(struct broker *b, struct mail *m, uint32_t unknown, muster_Outcome result);

/** A mail waits for somebody, and is safe: its sender is told once. */
void outcome_stored(struct broker *b, struct mail *m);

/** One receiver is through with a mail; the last one ends it. */
void outcome_settle(struct broker *b, struct mail *m);

/**
 * How it stands with a mail that somebody still waits for, for the store.
 *
 * @return what its sender was told for good, or what he will be told; "" for nothing yet
 */
const char *outcome_so_far(const struct mail *m);

/** The same of a mail that comes back from the store.  @return false: there is no such word */
bool outcome_go_on(struct mail *m, const char *word);

/** Tells senders that pressed what became of their mail, when it is time. */
void outcome_tick(struct broker *b);

#endif
