/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file stalls.h
 * When a recorded robot was stalled, where, beside what, and told what.
 */
#ifndef MUSTER_STORY_STALLS_H
#define MUSTER_STORY_STALLS_H

#include "muster/limits.h"
#include "story/recording.h"

/* From the first step that found it stalled to the last. */
struct stall {
    int64_t from, to;
    double x_m, y_m;                          /* where it began */
    double forward_m_s, turn_rad_s;           /* what its motors had been told */
    muster_State state;                       /* that it was in then */
    char near[MU_NAME_MAX + sizeof "a wall"]; /* what was nearest: a robot, or "a wall" */
    double near_m;                            /* from its middle to that robot's, or to the wall */
};

/**
 * Finds the stalls of a robot.
 *
 * @param robot  in every Frame; MU_NONE: somebody without a body, who has none
 * @param most  room for so many
 * @return how many there are, more than most if there was no room; the first are filled
 */
size_t stalls_find(struct recording *r, uint32_t robot, struct stall *stalls, size_t most);

/** @return the stall that a step is in, or the next one to it; NULL: there is none */
const struct stall *stalls_at(const struct stall *stalls, size_t count, int64_t step);

/** @return a robot's index in every Frame, or MU_NONE */
uint32_t stalls_robot(struct recording *r, const char *name);

#endif
