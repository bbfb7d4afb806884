/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file ack_delay.h
 * When acknowledgements go out without mail.
 *
 * Outside of lock step they wait a little: most go with an Up that is sent anyway, and the answers
 * to a broadcast do not delay the broadcast.  A process that gets mail all the time acknowledges
 * ten times a second, at no fixed interval: a hundred processes that got the same broadcast do not
 * all answer at once.  A process that gets a mail now and then acknowledges it soon.
 */
#ifndef MUSTER_RUNTIME_ACK_DELAY_H
#define MUSTER_RUNTIME_ACK_DELAY_H

#include "muster/limits.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    ACK_DELAY_NS = 5000000,              /* by the wall, */
    ACK_PAUSE_NS = 100000000,            /* and on average so long after the last ones */
    ACK_DELAY_ITEMS = MU_WINDOW_MAX / 4, /* so many wait no longer: the broker's window fills up */
};

struct ack_delay {
    uint32_t items;    /* handed over and not acknowledged */
    uint64_t since_ns; /* when the first of them came */
    uint64_t said_ns;  /* when acknowledgements last went out; 0: never */
};

void ack_delay_add(struct ack_delay *o, uint64_t now_ns);

/** All acknowledgements are out. */
void ack_delay_clear(struct ack_delay *o, uint64_t now_ns);

/** @return whether they may wait no longer */
bool ack_delay_due(const struct ack_delay *o, uint64_t now_ns);

/** @return when to look again; INT64_MAX: nothing waits.  Never 0: a network that
 *          refuses what is due is not asked in a loop. */
int64_t ack_delay_wait_ns(const struct ack_delay *o, uint64_t now_ns);

#endif
