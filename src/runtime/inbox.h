/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file inbox.h
 * The Deliveries that have come and are not handled yet.
 *
 * They leave the reader as they come: probes are answered even while mail waits for the next step.
 *
 * Multicasts have a reader of their own.  The broker numbers all Deliveries to a process in one
 * count, and the process handles them in this order: one that comes too early waits for those
 * before it, INBOX_PATIENCE_NS at most.  Each reader has its own room here, so that no Delivery
 * lies behind one that waits for it.
 *
 * A broker waits for acknowledgements of a process's own Deliveries, but not of multicasts to
 * others.  A process that does not look for long keeps the last INBOX_DEPTH of them; its own mail
 * in those that are lost goes out again.
 */
#ifndef MUSTER_RUNTIME_INBOX_H
#define MUSTER_RUNTIME_INBOX_H

#include "bus/bus.h"
#include "muster/agent.h"
#include "wire.h"

enum {
    INBOX_EACH = 64, /* of each reader; more stay in the reader, and probes behind them */
    INBOX_MAX = 2 * INBOX_EACH,
    INBOX_DEPTH = 1024, /* multicasts that stay in the reader */
    INBOX_PATIENCE_NS = 100000000,
};

struct inbox {
    void *at[INBOX_MAX]; /* in the order in which they came */
    uint32_t count;
    uint32_t multicasts;  /* of them */
    uint64_t incarnation; /* of the broker whose count it is, */
    uint32_t seat;        /* and of this process there; 0: none yet */
    uint64_t serial;      /* of the Delivery that was handled last */
    uint64_t lacks_ns;    /* since when something is missing; 0: nothing is */
    muster_Delivery open; /* the multicast in hand, as a Delivery to this process alone */
    muster_Parcel items[BUS_CIRCULAR_LETTERS * BUS_CIRCULAR_BOXES]; /* in it */
};

/** Takes its memory, at start-up. */
void inbox_init(struct inbox *box);

/** Takes in what has come; probes of our broker overtake mail that waits. */
void inbox_fill(mu_process *p);

/** p->mail is done with. */
void inbox_drop(mu_process *p);

/** Drops p->mail, if there is one, and sets it to the next Delivery of our broker; NULL: there is
 * none, or one before it is missing. */
void inbox_next(mu_process *p);

/** @return whether mail of another step waits behind p->mail, or there is no room to see it */
bool inbox_has_step_behind(const mu_process *p);

/** @return whether something has come too early */
bool inbox_lacks(const mu_process *p);

#endif
