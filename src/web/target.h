/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file target.h
 * What the path of a request asks for.  Pure.
 */
#ifndef MUSTER_WEB_TARGET_H
#define MUSTER_WEB_TARGET_H

#include "web/assets.h"
#include "web/guard.h"

enum route {
    ROUTE_NONE, /* there is no such page */
    ROUTE_ASSET,
    ROUTE_EVENTS,
    ROUTE_SCENE,
    ROUTE_RECORDING,
    ROUTE_TRACKS,
    ROUTE_MOMENTS,
    ROUTE_WHY,
    ROUTE_LINES,
    ROUTE_WATCH,
    ROUTE_LEAVE,
    ROUTE_WORDS,
    ROUTE_WORLD
};

struct target {
    enum route route;
    enum guard_use use;
    const struct asset *asset; /* of ROUTE_ASSET; else NULL */
    int64_t step;              /* of ROUTE_MOMENTS and ROUTE_WHY */
    const char *name; /* of the agent that the path names, in the path; "": it names none */
};

/** Reads a path; one that is nothing here has ROUTE_NONE. */
struct target target_find(const char *path);

#endif
