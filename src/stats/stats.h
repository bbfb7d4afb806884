/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file stats.h
 * The parts of the statistics of a run (muster/stats.h).
 */
#ifndef MUSTER_STATS_STATS_H
#define MUSTER_STATS_STATS_H

#include "muster/monitor.h"
#include "muster/stats.h"

#include <stdbool.h>

/* --- approach.c ------------------------------------------------------------------------------- */

/* How near robots have come to each other: the least distance of pairs, and when that was. */

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

/* --- explored.c ------------------------------------------------------------------------------- */

/*
 * Which part of the floor robots have crossed: each of them, and all together.
 *
 * The world is divided into 0.5 m cells, each of them into finer ones that are solid where an
 * outline touches them.  A flood from wherever a robot has been finds the floor that robots can
 * reach, so that what lies outside the walls does not count; a cell is floor when at least half of
 * it is reached, or when a robot was there.
 */

struct explored; /* start-up memory */

/** Takes memory for so many robots, and worlds up to the limits. */
struct explored *explored_reserve(size_t robots);

/**
 * Begins with an empty floor.
 *
 * @param scene  its borders and walls are looked at, and not kept
 * @return false: the world is empty or too large to be divided into cells; then nothing is counted
 */
bool explored_begin(struct explored *e, const struct mu_scene *scene);

/** Notes that a robot's centre moved along a line. */
void explored_cross(struct explored *e, size_t robot, double x0_m, double y0_m, double x1_m,
                    double y1_m);

/** @return the share of the floor that all robots have crossed together, 0 to 1; -1: see above */
double explored_share(const struct explored *e);

/** @return likewise, what one of them has crossed */
double explored_share_of(const struct explored *e, size_t robot);

/* --- goal.c ----------------------------------------------------------------------------------- */

/* Goals that rules set, out of their minds' diaries (docs/reference/frame.md). */

/**
 * Finds the last fact (goal WORD X Y) that came in a step: a place in mm.
 *
 * @param x_m, y_m  out: in metres
 * @return whether there is one
 */
bool goal_in_diary(const char *diary, double *x_m, double *y_m);

#endif
