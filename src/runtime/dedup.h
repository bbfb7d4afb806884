/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file dedup.h
 * The deduplication window: the last mails that an agent got, by sender, start of the sender, and
 * number.
 *
 * Within one life of a broker the numbers of a box show which mails are duplicates.  A mail that
 * says it may have come before (Mail.again), through another broker or an earlier life of this one,
 * is looked up here.  A broker sends at most a window of mails ahead of the acknowledgements, and
 * begins each priority again with the first of them.  A mail to several agents is answered when the
 * last of them has it: all mails that the outbox of one sender holds may come again.  So a few more
 * than both are enough, for each priority, however many mails of a higher one come in between.
 *
 * An agent that goes back to a broker in the same life goes on in its box where it was: the mails
 * that it got elsewhere meanwhile may be more than are kept here.
 */
#ifndef MUSTER_RUNTIME_DEDUP_H
#define MUSTER_RUNTIME_DEDUP_H

#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

enum { DEDUP_MAX = MU_WINDOW_MAX + MU_OUTBOX_MAX + 32, DEDUP_QUEUES = 4, DEDUP_BROKERS = 4 };

struct dedup {
    struct {
        struct {
            uint32_t sender; /* hash of the name, */
            uint32_t life;   /* and of when it began; 0: that is not known */
            uint64_t seq;    /* 0: free */
        } mails[DEDUP_MAX];
        uint32_t next;
    } queues[DEDUP_QUEUES]; /* directives, and by priority */
    struct {
        uint64_t incarnation; /* 0: free */
        uint64_t last_number; /* the last of the box there */
    } brokers[DEDUP_BROKERS]; /* the agent was there last, the last one first */
};

/** Forgets all mails and brokers; memory that was never used stays untouched. */
void dedup_clear(struct dedup *t);

/** Notes a mail; the oldest of its priority is forgotten. */
void dedup_add(struct dedup *t, const muster_Mail *m);

/** @return whether the mail is among the last DEDUP_MAX of its priority.  A mail with the same
 * number, from another life of the sender, is another mail */
bool dedup_has(const struct dedup *t, const muster_Mail *m);

/** Notes the broker that the agent leaves; the oldest of them is forgotten. */
void dedup_leave(struct dedup *t, uint64_t incarnation, uint64_t last_number);

/** @return the last number that the agent got in this life of a broker; 0: none that is known */
uint64_t dedup_last_number(const struct dedup *t, uint64_t incarnation);

#endif
