/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file taken.h
 * The last mails that an agent took, by sender and number.
 *
 * A box's numbers tell what has been had within one life of a broker.  Where a mail says that it
 * may have come before (Mail.again), through another broker or an earlier life of this one, it is
 * looked up here.  A broker hands out at most a window of mails ahead of what has been
 * acknowledged, so that a few more than that are enough.
 */
#ifndef MUSTER_RUNTIME_TAKEN_H
#define MUSTER_RUNTIME_TAKEN_H

#include <stdbool.h>
#include <stdint.h>

enum { TAKEN_MAX = 256 };

struct taken {
    struct {
        uint64_t sender; /* hash of the name */
        uint64_t seq;    /* 0: free */
    } mails[TAKEN_MAX];
    uint32_t next;
};

/** Forgets all; what was never used stays untouched. */
void taken_clear(struct taken *t);

/** Notes a mail; the oldest is forgotten. */
void taken_add(struct taken *t, const char *src, uint64_t seq);

/** @return whether the mail is among the last TAKEN_MAX */
bool taken_has(const struct taken *t, const char *src, uint64_t seq);

#endif
