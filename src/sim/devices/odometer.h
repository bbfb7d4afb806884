/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file odometer.h
 * Where a robot takes itself to be from the turning of its wheels.
 *
 * It counts what the wheels do, not the body: a robot that slips or is pushed does not notice.
 */
#ifndef MUSTER_SIM_ODOMETER_H
#define MUSTER_SIM_ODOMETER_H

#include "world/world.h"

struct odometer {
    struct world_pose pose;         /* heading in (-pi, pi] */
    double forward_gain, turn_gain; /* read for what is: 1 without an error */
    double c, s;                    /* of the heading of the last piece of the way */
    bool turned;                    /* the heading has changed since */
};

/** Starts at the file's pose, or at the robot's own; its gains belong to the seed and the robot. */
void odometer_init(struct odometer *odometer, const struct world_robot *robot, uint64_t seed,
                   uint32_t index);

/** Counts the wheels' speeds for dt_s. */
void odometer_run(struct odometer *odometer, double forward_m_s, double turn_rad_s, double dt_s);

#endif
