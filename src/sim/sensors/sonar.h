/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sonar.h
 * A ring of sonars: each hears the nearest echo of the exact rays over its cone.
 */
#ifndef MUSTER_SIM_SONAR_H
#define MUSTER_SIM_SONAR_H

#include "sim/geometry/frame.h"
#include "sim/geometry/grid.h"
#include "sim/sensors/fan.h"
#include "sim/sensors/noise.h"

struct sonar_ray {
    double x, y; /* its direction, in the robot's frame */
};

struct sonar {
    double x, y; /* in the robot's frame */
    struct noise_limits range;
    struct world_noise noise;
    double least_cos; /* of the angle of incidence, for an echo to come back; 0: any */
    uint32_t first_ray, ray_count;
};

struct sonar_ring {
    size_t count;
    struct sonar *sonars;
    struct sonar_ray *rays; /* of all of them */
    uint32_t ray_count;
    double reach_m; /* from the robot's middle */
    bool mirrors;   /* what one hears depends on the surface that it meets */
};

/* Whose ring it is, now. */
struct sonar_place {
    struct frame robot;
    int32_t self; /* the owner of what it does not hear */
    uint64_t key; /* of its noise: draw_key(..., DRAW_SONAR, ...) */
};

/** Takes memory. */
void sonar_init(struct sonar_ring *ring, const struct world_robot *robot);

/** Reads all sonars, ray by ray. */
void sonar_read(const struct sonar_ring *ring, const struct grid *grid,
                const struct sonar_place *place, float range_m[]);

/**
 * Reads all sonars of a ring without mirrors, all rays at once: to the same bits.
 *
 * @param rays, found  scratch: room for the ring's rays, and as gather_cast has it
 * @return false: too much is near, and nothing was read
 */
bool sonar_read_near(const struct sonar_ring *ring, const struct gather *gather,
                     const struct sonar_place *place, struct fan_rays *rays, uint32_t *found,
                     float range_m[]);

#endif
