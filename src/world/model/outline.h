/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file outline.h
 * What a shape looks like from above, in the numbers that observers are told.
 */
#ifndef MUSTER_WORLD_OUTLINE_H
#define MUSTER_WORLD_OUTLINE_H

#include "world/world.h"

/* Numbers of the longest outline: x and y of a box's corners. */
enum { OUTLINE_NUMBERS_MAX = 8 };

/**
 * Writes x and y of the corners of a shape that stands at a pose, counter-clockwise from the front
 * left one; of a disc those of its centre.
 *
 * @return how many numbers that are
 */
size_t outline_write(const struct world_shape *shape, const struct world_pose *pose,
                     float corners_m[OUTLINE_NUMBERS_MAX]);

/** @return whether nothing stops at it and nothing echoes: a mark on the floor */
bool outline_is_flat(const struct world_shape *shape);

#endif
