/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file taken.h
 * The last mails that an agent took, by sender and number.
 *
 * A box's numbers tell what has been had within one life of a broker.  Where a mail says that it
 * may have come before (Mail.again), through another broker or an earlier life of this one, it is
 * looked up here.  A broker hands out at most a window of mails ahead of what has been
 * acknowledged, and begins each priority again with the first of them: so a few more than a window
 * are enough, of each priority, however many of a higher one come in between.
 */
#ifndef MUSTER_RUNTIME_TAKEN_H
#define MUSTER_RUNTIME_TAKEN_H

#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

enum { TAKEN_MAX = 256, TAKEN_QUEUES = 4 };

struct taken {
    struct {
        struct {
            uint64_t sender; /* hash of the name */
            uint64_t seq;    /* 0: free */
        } mails[TAKEN_MAX];
        uint32_t next;
    } queues[TAKEN_QUEUES]; /* directives, and by priority */
};

/** Forgets all; what was never used stays untouched. */
void taken_clear(struct taken *t);

/** Notes a mail; the oldest of its priority is forgotten. */
void taken_add(struct taken *t, const muster_Mail *m);

/** @return whether the mail is among the last TAKEN_MAX of its priority */
bool taken_has(const struct taken *t, const muster_Mail *m);

#endif
