/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file laser.h
 * A scanner of one exact beam per sample.
 */
#ifndef MUSTER_SIM_LASER_H
#define MUSTER_SIM_LASER_H

#include "sim/geometry/frame.h"
#include "sim/geometry/grid.h"
#include "sim/sensors/fan.h"
#include "sim/sensors/noise.h"

struct laser {
    struct frame place; /* in the robot's frame */
    struct noise_limits range;
    struct world_noise noise;
    struct fan_table table; /* count 0: there is none */
};

/* What a robot's eyes work on. */
struct laser_scene {
    struct frame robot;
    int32_t self;
    const struct grid *grid;
    const struct gather_solids *near; /* what is near the robot, without itself */
    double *range_m;                  /* scratch, room as in the table */
    uint64_t key, angle_key;          /* of its noise: DRAW_LASER and DRAW_LASER_ANGLE */
};

/** Takes memory. */
void laser_init(struct laser *laser, const struct world_laser *from);

/** @return how far from the robot's middle it sees */
double laser_reach(const struct laser *laser);

/** Reads all samples, from right to left. */
void laser_read(const struct laser *laser, const struct laser_scene *scene, float range_m[]);

#endif
