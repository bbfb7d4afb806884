/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file server.h
 * The HTTP side: libmicrohttpd on 127.0.0.1, in our loop and thread.
 *
 *     GET  / and the other assets
 *     GET  /events       the stream of events of one viewer; HEAD: whether there is room for one
 *     GET  /scene        the world
 *     GET  /recording    what recording is shown; null: a run is
 *     GET  /tracks       where robots were in it
 *     GET  /moments/STEP[/NAME]    a moment of it, and what was in that robot's mind
 *     GET  /why/STEP/NAME          why that robot drove as it did
 *     POST /lines/NAME   a text of CLIPS to an agent
 *     POST /words/NAME   how this line goes on: its last word is to be completed
 *     POST /watch/NAME   show me what its rules print and what is watched
 *     POST /leave/NAME   no longer
 *     POST /world        an order to the world: place red 1 2; in lines behind it: at S, when
 * CONDITION
 *
 * A POST needs X-Muster-Token, and says by X-Muster-Viewer and X-Muster-Ask who asks and what he
 * calls the question.  The library parses, limits and answers; it allocates on its own.
 */
#ifndef MUSTER_WEB_SERVER_H
#define MUSTER_WEB_SERVER_H

#include "web/board.h"
#include "web/consoles.h"
#include "web/guard.h"
#include "web/hands.h"
#include "web/past.h"
#include "web/viewers.h"

struct server;

struct server_parts {
    struct guard *guard;
    struct board *board;
    struct viewers *viewers;
    struct consoles *consoles; /* NULL: nobody acts here */
    struct hands *hands;       /* likewise */
    struct past *past;         /* NULL: no recording */
    int domain;
};

/**
 * Listens.
 *
 * @param port  0: any free one
 * @return MU_OK; MU_BUSY: the port is taken; MU_FAULT_OS
 */
MU_MUST_USE mu_result server_open(struct server **out, const struct server_parts *parts,
                                  uint16_t port);

/** @return the port that it listens on */
uint16_t server_port(const struct server *s);

/** @return a descriptor that is readable when server_run has something to do */
int server_fd(const struct server *s);

/** @return so long at most until server_run is due, ms; < 0: no limit */
int server_timeout_ms(const struct server *s);

/** Handles what is there: requests, and what viewers have not got yet.  Never blocks. */
void server_run(struct server *s, uint64_t now_ns);

void server_close(struct server *s);

#endif
