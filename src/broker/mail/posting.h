/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file posting.h
 * A mail whose receivers are known goes into their boxes, as far as there is room for it.
 */
#ifndef MUSTER_BROKER_POSTING_H
#define MUSTER_BROKER_POSTING_H

#include "broker/mail/audience.h"

/**
 * Books a mail on its sender's account with the store.  Where there is no room for those outside
 * the lock step that the sender is in, they are taken out of the audience.
 *
 * @return false: refused, counted, told, and freed
 */
bool posting_book(struct broker *b, struct mail *m, struct audience *to);

/* How a mail got into its boxes. */
struct posted {
    bool held;   /* until a time of the run */
    bool fits;   /* into each box that its sender may know of */
    bool stored; /* some of its receivers do not take mail now */
};

/** Puts a booked mail into every box; keeps one use of it for posting_conclude. */
struct posted posting_put(struct broker *b, struct mail *m, const struct audience *to);

/** Tells the sender what became of it at once, and gives back the use that posting_put kept. */
void posting_conclude(struct broker *b, struct mail *m, const struct audience *to,
                      const struct posted *done);

/** @return whether a mail is to wait for a time of the run that is still to come */
bool posting_is_held(const struct broker *b, const struct mail *m);

/**
 * Notes when a mail that is in boxes is due, and when it expires.
 *
 * @param left_ns  of its time to live, if it has one
 */
void posting_schedule(struct broker *b, struct mail *m, bool held, uint64_t left_ns);

#endif
