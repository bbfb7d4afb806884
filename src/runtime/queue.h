/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file queue.h
 * Agents that have something to do, so that a process need not look at all of them.
 */
#ifndef MUSTER_RUNTIME_QUEUE_H
#define MUSTER_RUNTIME_QUEUE_H

#include <stdbool.h>
#include <stdint.h>

struct mu_agent;

enum queue_kind {
    QUEUE_SEND, /* mail that has not gone out */
    QUEUE_ACK,  /* mail that it got, and the broker does not know */
    QUEUE_WAIT, /* mail that went out and is not answered for, the longest wait first */
    QUEUES,     /* how many */
};

struct queue {
    struct mu_agent *first, *last;
};

/* An agent's place in one queue. */
struct queue_link {
    struct mu_agent *next, *prev;
    bool in;
};

/** Puts an agent at the end, if it is not in the queue. */
void queue_add(struct mu_agent *a, enum queue_kind kind);

/** Takes an agent out, if it is in. */
void queue_remove(struct mu_agent *a, enum queue_kind kind);

#endif
