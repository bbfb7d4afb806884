/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file hands.h
 * Hands on the world, from all pages: place, push, reset, sensor and pace, as `muster world` says
 * them, at once or for later; and what became of them.
 */
#ifndef MUSTER_WEB_HANDS_H
#define MUSTER_WEB_HANDS_H

#include "bus/bus.h"
#include "web/viewers.h"
#include "web/watch.h"

enum {
    HANDS_LATER_MAX = 32, /* orders for later: as many answers in one step as the bus keeps */
    HANDS_ASKS_MAX = HANDS_LATER_MAX + 64,
    HANDS_LINE_MAX = 255,                                    /* bytes of an order */
    HANDS_TEXT_MAX = HANDS_LINE_MAX + MU_CONDITION_MAX + 64, /* with its time */
    HANDS_WORDS_MAX = 8,
    HANDS_SAID_MAX = 319
};

/* An order that the simulator has not answered yet, and who wants to know. */
struct hands_ask {
    uint64_t seq; /* 0: free */
    uint64_t viewer, number;
    uint64_t until_ns; /* when it is given up */
    uint64_t due_ns;   /* not before this time of the run */
    char simulator[MU_PROCESS_MAX + 1];
    char line[HANDS_LINE_MAX + 1];
    char when[MU_CONDITION_MAX + 1]; /* nor before this has come true; "": whenever */
};

struct hands {
    struct bus_writer commands;
    struct bus_reader answers;
    struct viewers *viewers;
    const struct watch *watch; /* knows the run, its simulator and the board */
    struct hands_ask asks[HANDS_ASKS_MAX];
    bool changed;                  /* what waits, since it was put on the board */
    char said[HANDS_SAID_MAX + 1]; /* why an order did not go out, as a line */
};

/** Opens reader and writer. */
MU_MUST_USE mu_result hands_open(struct hands *h, struct bus *bus, struct viewers *viewers,
                                 const struct watch *watch);

/**
 * Sends the order that a text says: a line of `muster world`, and behind it, where it is for later,
 * a line "at S", a line "when CONDITION", or both.  What becomes of it comes to all viewers as an
 * event "ordered"; to the one that has asked, with its number, to the others with 0.
 *
 * @return MU_OK; else said has why: MU_FAULT_USAGE: it is no order; MU_ABSENT: no run
 *         lives; MU_FULL: too many wait for their answers; MU_BUSY: the network does not keep up
 */
MU_MUST_USE mu_result hands_do(struct hands *h, const char *text, uint64_t viewer, uint64_t number);

/** Takes the answers that are there, gives up those that do not come, and puts the orders for later
 * that wait on the board. */
void hands_round(struct hands *h, uint64_t now_ns);

#endif
