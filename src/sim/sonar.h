/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sonar.h
 * A ring of sonars: one exact ray for each, down the middle of its cone.
 */
#ifndef MUSTER_SIM_SONAR_H
#define MUSTER_SIM_SONAR_H

#include "sim/grid.h"

struct sonar {
    double x, y;                     /* in the robot's frame */
    double along_x, along_y;         /* its direction, in the robot's frame */
    double range_min_m, range_max_m; /* readings are clipped to them */
};

struct sonar_ring {
    size_t count;
    struct sonar sonars[MU_SONARS_MAX];
};

struct sonar_frame {
    double x, y, c, s; /* the robot's place; cosine and sine of its heading */
};

void sonar_init(struct sonar_ring *ring, const struct world_robot *robot);

/** Reads all sonars of the moving solid self. */
void sonar_read(const struct sonar_ring *ring, const struct grid *grid, int self,
                const struct sonar_frame *frame, float range_m[MU_SONARS_MAX]);

#endif
