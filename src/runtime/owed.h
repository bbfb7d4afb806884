/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file owed.h
 * When acknowledgements go out that have no mail to go with.
 *
 * They wait a little, outside of lock step: most find company in an Up that goes out anyway, and
 * the answers to a broadcast do not get in the way of the broadcast.  Who takes one mail after the
 * other says so ten times a second, at no fixed interval, so that the hundred whom a broadcast has
 * reached do not all speak at once; who takes one now and then says so soon.
 */
#ifndef MUSTER_RUNTIME_OWED_H
#define MUSTER_RUNTIME_OWED_H

#include "muster/limits.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    OWED_DELAY_NS = 5000000,          /* by the wall, */
    OWED_PAUSE_NS = 100000000,        /* and on average so long after the last ones */
    OWED_PARCELS = MU_WINDOW_MAX / 4, /* so many wait no longer: the broker's window fills up */
};

struct owed {
    uint32_t parcels;  /* taken and not acknowledged */
    uint64_t since_ns; /* when the first of them was taken */
    uint64_t said_ns;  /* when acknowledgements last went out; 0: never */
};

void owed_add(struct owed *o, uint64_t now_ns);

/** All acknowledgements are out. */
void owed_clear(struct owed *o, uint64_t now_ns);

/** @return whether they may wait no longer */
bool owed_due(const struct owed *o, uint64_t now_ns);

/** @return when to look again; INT64_MAX: nothing is owed.  Never 0: a network that does not take
 *          what is due is not asked in a loop. */
int64_t owed_wait_ns(const struct owed *o, uint64_t now_ns);

#endif
