/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file gps.h
 * The absolute place and the compass: exact, or with noise and with a drift that walks.
 */
#ifndef MUSTER_SIM_GPS_H
#define MUSTER_SIM_GPS_H

#include "world/world.h"

struct gps {
    double noise_m, compass_noise_rad;
    double drift_m;          /* of one control step, in each direction */
    double off_x_m, off_y_m; /* how far it has drifted */
};

/* Whose it is, and the control step. */
struct gps_when {
    uint64_t seed, robot, tick;
};

/* A place as it is read. */
struct gps_fix {
    double x_m, y_m, compass_rad; /* in (-pi, pi] */
};

void gps_init(struct gps *gps, const struct world_robot *robot, double step_s);

/** Lets it drift for a control step. */
void gps_walk(struct gps *gps, const struct gps_when *when);

/** Reads it; the same time gives the same reading. */
struct gps_fix gps_read(const struct gps *gps, struct world_pose pose, const struct gps_when *when);

#endif
