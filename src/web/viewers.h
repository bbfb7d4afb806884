/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file viewers.h
 * The pages that are open: each is a stream of events, with a queue of its own.
 */
#ifndef MUSTER_WEB_VIEWERS_H
#define MUSTER_WEB_VIEWERS_H

#include "core/random.h"
#include "web/stream.h"

enum { VIEWERS_MAX = 32, VIEWERS_EVENT_MAX = 128 * 1024 };

struct server;

struct viewer {
    bool used;
    uint64_t id; /* that it names itself by when it acts; never given twice */
    struct stream stream;
    struct server *server;
    void *connection; /* the server's */
    bool sleeps;      /* the server is to wake it when there is something for it */
    uint64_t sent_ns; /* when it got something last */
};

struct viewers {
    struct viewer all[VIEWERS_MAX];
    struct mu_random random; /* of ids */
    struct mu_text event;    /* one that is written for one of them */
    struct mu_json json;
    uint64_t refused; /* that found no place */
};

/** Takes the memory, at start-up.  @param seed  of the ids: random */
void viewers_init(struct viewers *v, uint64_t seed);

/** @return a new viewer; NULL: VIEWERS_MAX are there */
struct viewer *viewers_take(struct viewers *v);

void viewers_release(struct viewer *viewer);

/** @return whether another one finds a place */
bool viewers_have_room(const struct viewers *v);

/** @return the viewer, or NULL: it has left */
struct viewer *viewers_find(struct viewers *v, uint64_t id);

/** Begins an event for single viewers.  @return where its JSON goes, one object */
struct mu_json *viewers_begin(struct viewers *v, const char *name);

/** Ends the event, once, before it goes to whom it is for. */
void viewers_end(struct viewers *v);

/** Puts the event into a viewer's stream; when that is full the viewer is told so later. */
void viewers_send(struct viewers *v, struct viewer *to);

#endif
