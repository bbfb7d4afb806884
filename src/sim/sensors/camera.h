/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file camera.h
 * A camera that finds blobs of colour, column by column.
 */
#ifndef MUSTER_SIM_CAMERA_H
#define MUSTER_SIM_CAMERA_H

#include "sim/geometry/frame.h"
#include "sim/sensors/fan.h"
#include "sim/sensors/sensors.h"

struct camera {
    struct frame place; /* in the robot's frame */
    double range_m;
    uint32_t colors[MU_COLORS_MAX];
    size_t color_count;     /* 0: all */
    struct fan_table table; /* one beam for each column's middle; count 0: there is none */
};

struct camera_scene {
    struct frame robot;
    const struct gather *gather;
    const struct gather_solids *near; /* what is near the robot, without itself */
    double *range_m;                  /* scratch, room as in the table */
    int64_t *hit;                     /* likewise */
};

/** Takes memory. */
void camera_init(struct camera *camera, const struct world_camera *from);

/** @return how far from the robot's middle it sees */
double camera_reach(const struct camera *camera);

/**
 * Finds the blobs: neighbouring columns that see one colour of one owner.  What stands in front
 * hides what is behind, whether or not its colour is looked for.
 *
 * @param blobs  out: room for MU_BLOBS_MAX; the nearest, nearest first
 * @return how many
 */
size_t camera_read(const struct camera *camera, const struct camera_scene *scene,
                   struct engine_blob blobs[]);

#endif
