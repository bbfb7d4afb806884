/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file goal.h
 * Goals that rules set, out of their minds' diaries (docs/observing.md).
 */
#ifndef MUSTER_STATS_GOAL_H
#define MUSTER_STATS_GOAL_H

#include <stdbool.h>

/**
 * Finds the last fact (goal WORD X Y) that came in a step: a place in mm.
 *
 * @param x_m, y_m  out: in metres
 * @return whether there is one
 */
bool goal_in_diary(const char *diary, double *x_m, double *y_m);

#endif
