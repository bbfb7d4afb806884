/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file scene.h
 * What stands in a world, for observers: what every Frame is drawn on.
 */
#ifndef MUSTER_SIM_SCENE_H
#define MUSTER_SIM_SCENE_H

#include "wire.h"
#include "world/world.h"

/**
 * Makes the Scene of a world; takes memory at start-up.
 *
 * Poses are those at which the world lets everything start.  The caller sets simulator, seed and
 * step_ns, and which robots are controlled.
 *
 * @return the sample, which points into the world
 */
muster_Scene *scene_make(const struct world *world);

#endif
