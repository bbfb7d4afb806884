/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file inbox.h
 * The Deliveries that have come and are not handled yet.
 *
 * They are taken out of the reader as they come, so that who only looks is answered even while mail
 * waits for the next step.
 *
 * Circulars come by a way of their own.  The broker counts what it sends a process by either way,
 * and so it is handled: what comes too early waits for what is missing, INBOX_PATIENCE_NS at most.
 * Each way has its own room, so that nothing is missing because it lies behind what waits for it.
 *
 * A broker waits for acknowledgements of what is for a process, but not of the circulars for
 * others.  Who does not look for long keeps the last INBOX_DEPTH of them; what was for him in those
 * that he has lost goes out again.
 */
#ifndef MUSTER_RUNTIME_INBOX_H
#define MUSTER_RUNTIME_INBOX_H

#include "bus/bus.h"
#include "muster/agent.h"
#include "wire.h"

enum {
    INBOX_EACH = 64, /* that wait of each way; more lie in the reader, glances behind them, too */
    INBOX_MAX = 2 * INBOX_EACH,
    INBOX_DEPTH = 1024, /* circulars that lie in the reader */
    INBOX_PATIENCE_NS = 100000000,
};

struct inbox {
    void *at[INBOX_MAX]; /* in the order in which they came */
    uint32_t count;
    uint32_t circulars;   /* of them */
    uint64_t incarnation; /* whose count it is: the broker's life, */
    uint32_t seat;        /* and this process there; 0: it has none yet */
    uint64_t serial;      /* of what was handled last */
    uint64_t lacks_ns;    /* since when something is missing; 0: nothing is */
    muster_Delivery open; /* the circular in hand, as if it were for this process alone */
    muster_Parcel parcels[BUS_CIRCULAR_LETTERS * BUS_CIRCULAR_BOXES]; /* in it */
};

/** Takes its memory, at start-up. */
void inbox_init(struct inbox *box);

/** Takes in what has come; glances of our broker pass what waits. */
void inbox_fill(mu_process *p);

/** p->mail is done with. */
void inbox_drop(mu_process *p);

/** Drops p->mail, if there is one; then p->mail is the next Delivery of our broker; NULL: there is
 * none, or one before it is missing. */
void inbox_next(mu_process *p);

/** @return whether mail of another step waits behind p->mail, or there is no room to see it */
bool inbox_has_step_behind(const mu_process *p);

/** @return whether something has come too early */
bool inbox_lacks(const mu_process *p);

#endif
