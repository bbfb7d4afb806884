/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file posting.h
 * A mail whose receivers are known goes into their boxes, as far as there is room for it.
 */
#ifndef MUSTER_BROKER_POSTING_H
#define MUSTER_BROKER_POSTING_H

#include "broker/audience.h"

/**
 * Books a mail on its sender's account with the store.  Where there is no room for those outside
 * the lock step that the sender is in, they are taken out of the audience.
 *
 * @return false: refused, counted, told, and freed
 */
bool posting_book(struct broker *b, struct mail *m, struct audience *to);

/** Puts a booked mail into every box, or on the broker's own desk; its sender is told of it. */
void posting_to_all(struct broker *b, struct mail *m, const struct audience *to);

/** @return whether a mail is to wait for a time of the run that is still to come */
bool posting_is_held(const struct broker *b, const struct mail *m);

/**
 * Notes when a mail that is in boxes is due, and when it expires.
 *
 * @param left_ns  of its time to live, if it has one
 */
void posting_schedule(struct broker *b, struct mail *m, bool held, uint64_t left_ns);

#endif
