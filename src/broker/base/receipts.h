/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file receipts.h
 * What senders are still to be told of their mails.
 */
#ifndef MUSTER_BROKER_RECEIPTS_H
#define MUSTER_BROKER_RECEIPTS_H

#include "core/table.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

/* Receipts that wait for one sender; a sender is bound to have fewer mails unanswered. */
enum { RECEIPTS_EACH_MAX = 2 * MU_OUTBOX_MAX };

struct receipt {
    uint64_t first_seq, last_seq;
    muster_Outcome result;
    uint32_t next;
};

struct receipt_queue {
    bool begun;
    uint32_t head, tail, count;
};

struct receipts {
    struct receipt *pool; /* MU_MAILS_MAX of them */
    uint32_t used;        /* high-water mark */
    uint32_t free;
    struct receipt_queue *queues; /* one for each agent of the registry */
    uint64_t lost;                /* receipts that were not told, for want of room */
};

void receipts_init(struct receipts *r, uint32_t agents);

/**
 * Adds an outcome; it joins the sender's last one if that is its neighbour and the same.
 *
 * Where there is no room a receipt is lost, and counted: the sender's oldest, or this one.  Who
 * waits for it sends its mail again, and is told then.
 */
void receipts_add(struct receipts *r, uint32_t agent, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result);

/** @return the agent's queue */
const struct receipt_queue *receipts_of(struct receipts *r, uint32_t agent);

/** Removes the oldest count receipts of an agent. */
void receipts_drop(struct receipts *r, uint32_t agent, uint32_t count);

#endif
