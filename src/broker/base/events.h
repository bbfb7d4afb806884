/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file events.h
 * What goes wrong with mail, for whoever looks: told soon, and not more often than is useful.
 *
 * Events of one kind at one agent are counted together until they are told, and all that there
 * are are told at most every EVENTS_PAUSE_NS.
 */
#ifndef MUSTER_BROKER_EVENTS_H
#define MUSTER_BROKER_EVENTS_H

#include "core/table.h"

#include <stdbool.h>
#include <stdint.h>

enum { EVENTS_PAUSE_NS = 100000000 };

enum event_kind { EVENT_BOX_FULL, EVENT_DROPPED, EVENT_OVER_SHARE, EVENT_REFUSED, EVENT_KINDS };

struct event {
    uint32_t agent;  /* whose box; the broker itself: its store, or its trust policy */
    uint32_t sender; /* of the last one */
    uint64_t count;  /* since it was told last; 0: nothing to tell */
    uint64_t at_ns;  /* of the last one, by the broker's clock */
    enum event_kind kind;
};

struct events {
    struct event *all; /* EVENT_KINDS for each agent of the registry */
    uint32_t *ring;    /* of those to be told, each once */
    uint32_t size;     /* of both */
    uint32_t head, count;
    uint32_t ready; /* of those in the ring, they may be told now */
    uint64_t pause_until_ns;
};

void events_init(struct events *e, uint32_t agents);

/** One more of a kind. */
void events_note(struct events *e, const struct event *event);

/** Gives what may be told now.  @return false when there is nothing */
bool events_next(struct events *e, uint64_t now_ns, struct event *out);

/** @return the word for a kind, as tools see it */
const char *events_kind_word(enum event_kind kind);

#endif
