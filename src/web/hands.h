/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file hands.h
 * Hands on the world, from all pages: place, push, reset, sensor and pace, as `muster world` says
 * them; and what became of them.
 */
#ifndef MUSTER_WEB_HANDS_H
#define MUSTER_WEB_HANDS_H

#include "bus/bus.h"
#include "web/viewers.h"
#include "web/watch.h"

enum { HANDS_ASKS_MAX = 64, HANDS_LINE_MAX = 255, HANDS_WORDS_MAX = 8, HANDS_SAID_MAX = 319 };

/* An order that the simulator has not answered yet, and who wants to know. */
struct hands_ask {
    uint64_t seq; /* 0: free */
    uint64_t viewer, number;
    uint64_t since_ns;
};

struct hands {
    struct bus_writer commands;
    struct bus_reader answers;
    struct viewers *viewers;
    const struct watch *watch; /* knows the run and its simulator */
    struct hands_ask asks[HANDS_ASKS_MAX];
    char said[HANDS_SAID_MAX + 1]; /* why an order did not go out, as a line */
};

/** Opens reader and writer. */
MU_MUST_USE mu_result hands_open(struct hands *h, struct bus *bus, struct viewers *viewers,
                                 const struct watch *watch);

/**
 * Sends the order that a line says.  What becomes of it comes to the viewer as an event "ordered"
 * with its number.
 *
 * @return MU_OK; else said has why: MU_FAULT_USAGE: it is no order; MU_ABSENT: no run
 *         lives; MU_FULL: too many wait for their answers; MU_BUSY: the network does not keep up
 */
MU_MUST_USE mu_result hands_do(struct hands *h, const char *line, uint64_t viewer, uint64_t number);

/** Takes the answers that are there, and gives up those that do not come. */
void hands_round(struct hands *h, uint64_t now_ns);

#endif
