/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file queue.h
 * Agents that have something to do, so that a process need not look at all of them.
 */
#ifndef MUSTER_RUNTIME_QUEUE_H
#define MUSTER_RUNTIME_QUEUE_H

#include "core/list.h"

#include <stdbool.h>

struct mu_agent;
struct mu_process;

enum queue_kind {
    QUEUE_SEND, /* mail that has not gone out */
    QUEUE_ACK,  /* mail that it got, and the broker does not know */
    QUEUE_WAIT, /* mail that went out and is not answered for, the longest wait first */
    QUEUES,     /* how many */
};

/** Puts an agent at the end, if it is not in the queue. */
void queue_add(struct mu_agent *a, enum queue_kind kind);

/** Takes an agent out, if it is in. */
void queue_remove(struct mu_agent *a, enum queue_kind kind);

/** @return whether an agent is in the queue */
bool queue_has(const struct mu_agent *a, enum queue_kind kind);

/** @return the first agent, or that behind another one; NULL: there is none */
struct mu_agent *queue_first(const struct mu_process *p, enum queue_kind kind);
struct mu_agent *queue_next(const struct mu_agent *a, enum queue_kind kind);

#endif
