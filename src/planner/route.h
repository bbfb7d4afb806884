/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file route.h
 * Ways over a map: A* between two places, straightened into few way points.
 *
 * The same map and places give the same way.  What it works with is taken once, and is used by one
 * search at a time.
 */
#ifndef MUSTER_AGENT_ROUTE_H
#define MUSTER_AGENT_ROUTE_H

#include "muster/result.h"
#include "planner/map.h"

enum { ROUTE_POINTS_MAX = 64 };

struct router;

struct route {
    double points_m[ROUTE_POINTS_MAX][2]; /* without the start; the last one is where it ends */
    size_t count;                         /* of a way that was found 1 or more */
    size_t looked; /* cells that the search has looked at: what it has cost */
};

/** Takes the memory of searches over a map, which must outlive it. */
struct router *router_make(const struct map *map);

/**
 * Searches the way that is short and keeps off walls.
 *
 * A start or an end that is too near to something is moved to the nearest free place: the start by
 * 0.6 m at most, the end by 0.25 m.
 *
 * @param half_m  half the width of who goes: with less room than this there is no way
 * @return MU_OK; MU_ABSENT: there is none, or an end of it is outside or in something
 */
MU_MUST_USE mu_result route_search(struct router *r, const double from_m[2], const double to_m[2],
                                   double half_m, struct route *out);

#endif
