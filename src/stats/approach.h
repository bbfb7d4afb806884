/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file approach.h
 * How near robots have come to each other: the least distance of pairs, and when that was.
 */
#ifndef MUSTER_STATS_APPROACH_H
#define MUSTER_STATS_APPROACH_H

#include "muster/stats.h"

struct approach; /* start-up memory */

struct approach_place {
    double x_m, y_m;
};

struct approach *approach_reserve(void);

/** Begins anew.  @param robots  MU_ROBOTS_MAX at most */
void approach_begin(struct approach *a, size_t robots);

/**
 * Takes in where all robots are at a time.
 *
 * Of up to MU_STATS_ALL_PAIRS robots every pair is looked at.  More are entered into a grid, and
 * looked at are pairs in neighbouring cells of MU_STATS_NEAR_M.
 */
void approach_take(struct approach *a, const struct approach_place *places, double time_s);

/** @return a pair that is known, in no order; NULL: there are fewer */
const struct mu_stats_pair *approach_pair(const struct approach *a, size_t index);

/** @return the pair that came nearest of those that a robot is one of; NULL: there is none */
const struct mu_stats_pair *approach_of(const struct approach *a, size_t robot);

/** @return how often a pair was left out for want of room */
uint64_t approach_refused(const struct approach *a);

#endif
