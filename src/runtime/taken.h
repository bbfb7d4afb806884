/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file taken.h
 * The last mails that an agent took, by sender, when that began, and number.
 *
 * A box's numbers tell what has been had within one life of a broker.  Where a mail says that it
 * may have come before (Mail.again), through another broker or an earlier life of this one, it is
 * looked up here.  A broker hands out at most a window of mails ahead of what has been
 * acknowledged, and begins each priority again with the first of them.  And a mail to several is
 * answered when the last of them has it: of one sender, an agent may have taken as many as its
 * outbox holds, which come again.  So a few more than both are enough, of each priority, however
 * many of a higher one come in between.
 *
 * Who goes back to a broker in the same life of it goes on in the box where it was: what it took
 * elsewhere meanwhile may be more than is remembered here.
 */
#ifndef MUSTER_RUNTIME_TAKEN_H
#define MUSTER_RUNTIME_TAKEN_H

#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

enum { TAKEN_MAX = MU_WINDOW_MAX + MU_OUTBOX_MAX + 32, TAKEN_QUEUES = 4, TAKEN_BROKERS = 4 };

struct taken {
    struct {
        struct {
            uint32_t sender; /* hash of the name, */
            uint32_t life;   /* and of when it began; 0: that is not known */
            uint64_t seq;    /* 0: free */
        } mails[TAKEN_MAX];
        uint32_t next;
    } queues[TAKEN_QUEUES]; /* directives, and by priority */
    struct {
        uint64_t incarnation; /* 0: free */
        uint64_t last_number; /* taken from the box there */
    } brokers[TAKEN_BROKERS]; /* the agent was there last, the last one first */
};

/** Forgets all; what was never used stays untouched. */
void taken_clear(struct taken *t);

/** Notes a mail; the oldest of its priority is forgotten. */
void taken_add(struct taken *t, const muster_Mail *m);

/** @return whether the mail is among the last TAKEN_MAX of its priority.  The same number of
 * another life of its sender's name is another mail */
bool taken_has(const struct taken *t, const muster_Mail *m);

/** The agent leaves this life of a broker; the one that it left first is forgotten. */
void taken_leave(struct taken *t, uint64_t incarnation, uint64_t last_number);

/** @return the last number that was taken in this life of a broker; 0: none that is known */
uint64_t taken_last_number(const struct taken *t, uint64_t incarnation);

#endif
