/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pacer.h
 * Slows down who presses: a sender whose mail does not get through is told so at once, and then at
 * most every PACER_PAUSE_NS.
 *
 * A sender has a bounded number of mails without an answer, so that the pause bounds its rate.
 * Nobody else waits for anything.
 */
#ifndef MUSTER_BROKER_PACER_H
#define MUSTER_BROKER_PACER_H

#include "core/table.h"

#include <stdbool.h>
#include <stdint.h>

enum { PACER_PAUSE_NS = 100000000 };

struct paced {
    uint64_t until_ns; /* not told anything but good news before this */
    bool queued;       /* there is something to tell then */
};

struct pacer {
    struct paced *agents; /* one for each agent of the registry */
    uint32_t *ring;       /* those in the queue, each once */
    uint32_t size;        /* of both */
    uint32_t head, count;
};

void pacer_init(struct pacer *p, uint32_t agents);

/**
 * Says whether to tell an agent bad news later: then pacer_next gives it when it is time.  From now
 * on it is told such at most every PACER_PAUSE_NS.
 */
bool pacer_holds(struct pacer *p, uint32_t agent, uint64_t now_ns);

/** @return the next agent that may be told now, or MU_NONE */
uint32_t pacer_next(struct pacer *p, uint64_t now_ns);

/** @return when pacer_next gives one, or UINT64_MAX */
uint64_t pacer_deadline_ns(const struct pacer *p);

#endif
