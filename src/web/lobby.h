/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file lobby.h
 * The connections that hold no stream: half a request, or none.
 *
 * All that come from this machine have one address.  So no limit for an address keeps a place free
 * for others: who waits longest makes room, and nobody waits longer than ten seconds.
 */
#ifndef MUSTER_WEB_LOBBY_H
#define MUSTER_WEB_LOBBY_H

#include <stddef.h>
#include <stdint.h>

enum { LOBBY_MAX = 48 };

struct lobby_place {
    int fd; /* of the connection, which the library closes */
    uint64_t since_ns;
};

struct lobby {
    struct lobby_place places[LOBBY_MAX];
    size_t count;
};

/** Notes a connection, or that it has ended a request; when all places are taken, the connection
 * that waits longest is shut down. */
void lobby_enter(struct lobby *l, int fd, uint64_t now_ns);

/** It is closed, or has a stream. */
void lobby_leave(struct lobby *l, int fd);

/** Shuts down who has waited too long. */
void lobby_round(struct lobby *l, uint64_t now_ns);

#endif
