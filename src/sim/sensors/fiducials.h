/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fiducials.h
 * A finder that reads numbers off things that bear one.
 */
#ifndef MUSTER_SIM_FIDUCIALS_H
#define MUSTER_SIM_FIDUCIALS_H

#include "sim/geometry/frame.h"
#include "sim/geometry/grid.h"
#include "sim/sensors/gather.h"
#include "sim/sensors/sensors.h"

struct fiducials {
    struct frame place; /* in the robot's frame */
    double range_min_m, range_max_m, range_id_m;
    double half_fov_rad;
};

struct fiducials_scene {
    struct frame robot;
    int32_t self;
    const struct grid *grid;
    const struct gather *gather;
    const struct gather_solids *near; /* what is near the robot, without itself */
};

void fiducials_init(struct fiducials *finder, const struct world_fiducial_finder *from);

/** @return how far from the robot's middle it sees; 0: there is none */
double fiducials_reach(const struct fiducials *finder);

/**
 * Finds what bears a number, has its middle inside the field of view, and is not hidden: the ray
 * to its middle meets it first, or another part of the same owner.
 *
 * @param found  out: room for MU_FIDUCIALS_MAX; the nearest, nearest first
 * @return how many
 */
size_t fiducials_read(const struct fiducials *finder, const struct fiducials_scene *scene,
                      struct engine_fiducial found[]);

#endif
