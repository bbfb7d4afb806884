/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file models.h
 * Each sensor of a robot: what it is, and how it reads what is there.
 */
#ifndef MUSTER_SIM_MODELS_H
#define MUSTER_SIM_MODELS_H

#include "sim/sensors/fan.h"
#include "sim/sensors/sensors.h"

/*
 * What one thread reads sensors with: where, whose and when, and memory for what is on its way.
 */
struct sensing {
    const struct grid *grid;
    const struct gather *gather;
    uint64_t seed, step; /* of all noise */
    struct frame robot;
    int32_t self;            /* the robot's number: the owner of what it does not see */
    struct gather_list near; /* what lies within the reach of all but the sonars */
    struct fan_rays rays;    /* those of a ring of sonars */
    uint64_t key;            /* of what the ring draws */
    double *range_m;         /* of each beam of a laser or camera */
    int64_t *hit;            /* what each met, as in struct fan_kernel */
};

/** @return the key of what a sensor draws now */
static inline uint64_t sensing_key(const struct sensing *at, enum draw_use use)
{
    return draw_key(at->seed, (uint64_t)at->self, use, at->step);
}

/* --- noise ------------------------------------------------------------------------------------ */

/*
 * How readings of a range are falsified.
 */

/* What a reading may be. */
struct noise_limits {
    double min_m, max_m;
};

static inline bool noise_is_exact(const struct world_noise *noise)
{
    return noise->constant_m <= 0 && noise->per_m <= 0;
}

/** Brings a range inside the limits; a zero loses its sign. */
static inline double noise_clip(const struct noise_limits *limits, double range_m)
{
    range_m = range_m > limits->max_m ? limits->max_m : range_m;
    return range_m > limits->min_m ? range_m : limits->min_m;
}

/**
 * @return an echo's range with a normal error of constant_m + per_m * range_m, inside the limits;
 *         max_m, which says that no echo came, stays as it is
 */
double noise_range(const struct world_noise *noise, const struct noise_limits *limits,
                   double range_m, uint64_t bits);

/** Turns a direction by a normal error of angle_rad. */
void noise_turn(const struct world_noise *noise, double along[2], uint64_t bits);

/* --- sonar ------------------------------------------------------------------------------------ */

/*
 * A ring of sonars: each hears the nearest echo of the exact rays over its cone.
 */

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

/** Takes memory. */
void sonar_init(struct sonar_ring *ring, const struct world_robot *robot);

/**
 * Reads all sonars: all rays at once, or, where much is near or surfaces mirror, ray by ray; to the
 * same bits.
 */
void sonar_read(const struct sonar_ring *ring, struct sensing *at, float range_m[]);

/* --- laser ------------------------------------------------------------------------------------ */

/*
 * A scanner of one exact beam per sample.
 */

struct laser {
    struct frame place; /* in the robot's frame */
    struct noise_limits range;
    struct world_noise noise;
    struct fan_table table; /* count 0: there is none */
};

/** Takes memory. */
void laser_init(struct laser *laser, const struct world_laser *from);

/** @return how far from the robot's middle it sees */
double laser_reach(const struct laser *laser);

/** Reads all samples, from right to left. */
void laser_read(const struct laser *laser, const struct sensing *at, float range_m[]);

/* --- camera ----------------------------------------------------------------------------------- */

/*
 * A camera that finds blobs of colour, column by column.
 */

struct camera {
    struct frame place; /* in the robot's frame */
    double range_m;
    uint32_t colors[MU_COLORS_MAX];
    size_t color_count;     /* 0: all */
    struct fan_table table; /* one beam for each column's middle; count 0: there is none */
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
size_t camera_read(const struct camera *camera, const struct sensing *at,
                   struct engine_blob blobs[]);

/* --- fiducials -------------------------------------------------------------------------------- */

/*
 * A finder that reads numbers off things that bear one.
 */

struct fiducials {
    struct frame place; /* in the robot's frame */
    double range_min_m, range_max_m, range_id_m;
    double half_fov_rad;
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
size_t fiducials_read(const struct fiducials *finder, const struct sensing *at,
                      struct engine_fiducial found[]);

#endif
