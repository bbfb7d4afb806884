/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file explored.h
 * Which part of the floor robots have crossed: each of them, and all together.
 *
 * The world is divided into 0.5 m cells, each of them into finer ones that are solid where an
 * outline touches them.  A flood from wherever a robot has been finds the floor that robots can
 * reach, so that what lies outside the walls does not count; a cell is floor when at least half of
 * it is reached, or when a robot was there.
 */
#ifndef MUSTER_STATS_EXPLORED_H
#define MUSTER_STATS_EXPLORED_H

#include "muster/monitor.h"

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

#endif
