/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file inbox.h
 * The Deliveries that have come and are not handled yet, in order.
 *
 * They are taken out of the reader as they come, so that who only looks is answered even while mail
 * waits for the next step.
 */
#ifndef MUSTER_RUNTIME_INBOX_H
#define MUSTER_RUNTIME_INBOX_H

#include "muster/agent.h"
#include "wire.h"

/* Deliveries that wait; more lie in the reader, and glances behind them wait with them. */
enum { INBOX_MAX = 64 };

struct inbox {
    void *at[INBOX_MAX]; /* a ring */
    uint32_t first, count;
};

/** Takes its memory, at start-up. */
void inbox_init(struct inbox *box);

/** Takes in what has come; glances of our broker pass what waits. */
void inbox_fill(mu_process *p);

/** p->mail is done with. */
void inbox_drop(mu_process *p);

/** Drops p->mail, if there is one; then p->mail is the next Delivery of our broker; NULL: there is
 * none. */
void inbox_next(mu_process *p);

#endif
