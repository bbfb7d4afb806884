/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file frame.h
 * Places with a heading, in the plane: a robot in its world, a sensor on its robot.
 */
#ifndef MUSTER_SIM_FRAME_H
#define MUSTER_SIM_FRAME_H

#include "world/world.h"

#include <math.h>

/* The heading as its cosine and sine: nothing is lost by turning often. */
struct frame {
    double x, y, c, s;
};

static inline struct frame frame_of(struct world_pose pose)
{
    return (struct frame){pose.x_m, pose.y_m, cos(pose.heading_rad), sin(pose.heading_rad)};
}

/** @return where a frame lies in the world that lies at inner in the frame outer */
static inline struct frame frame_join(const struct frame *outer, const struct frame *inner)
{
    return (struct frame){outer->x + outer->c * inner->x - outer->s * inner->y,
                          outer->y + outer->s * inner->x + outer->c * inner->y,
                          outer->c * inner->c - outer->s * inner->s,
                          outer->s * inner->c + outer->c * inner->s};
}

#endif
