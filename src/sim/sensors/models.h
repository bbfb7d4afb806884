/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file models.h
 * The models of all sensors that cast rays: sonar, laser, camera, fiducial finder.
 */
#ifndef MUSTER_SIM_MODELS_H
#define MUSTER_SIM_MODELS_H

#include "sim/sensors/fan.h"
#include "sim/sensors/sensors.h"

/* The lists of the table: those of one robot, or those of all robots in one piece. */
#define SENSORS_LIST(id, senses, type, list, count, ...) \
    type *list;                                          \
    size_t count;
struct sensors_lists {
    MU_CHANNELS(SENSORS_LIST)
};

/* What one thread reads the sensors of a robot with: the scene, the robot, and scratch memory. */
struct sensing {
    const struct grid *grid;
    const struct gather *gather;
    uint64_t seed, step; /* of all random numbers */
    struct frame robot;
    uint32_t due;                /* what is read now: bits of enum mu_sense */
    struct sensors_lists *lists; /* of the robot: where readings go */
    int32_t self;                /* the robot's number: sensors do not see solids of this owner */
    struct gather_list near;     /* solids within the reach of laser, camera and finder */
    struct fan_rays rays;        /* of a ring of sonars */
    uint64_t key;                /* of the random numbers of a ring of sonars */
    double *range_m;             /* of each beam of a laser or camera */
    int64_t *hit;                /* the solid that each beam hit, as in struct fan_kernel */
};

/** @return the key of the random numbers of a sensor in this step */
static inline uint64_t sensing_key(const struct sensing *at, enum draw_use use)
{
    return draw_key(at->seed, (uint64_t)at->self, use, at->step);
}

/* --- noise ------------------------------------------------------------------------------------ */

/* The limits of a reading. */
struct noise_limits {
    double min_m, max_m;
};

static inline bool noise_is_exact(const struct world_noise *noise)
{
    return noise->constant_m <= 0 && noise->per_m <= 0;
}

/** Limits a range; -0 becomes 0. */
static inline double noise_clip(const struct noise_limits *limits, double range_m)
{
    range_m = range_m > limits->max_m ? limits->max_m : range_m;
    return range_m > limits->min_m ? range_m : limits->min_m;
}

/**
 * @return the range with a normal error of deviation constant_m + per_m * range_m, limited; max_m
 *         means that no echo came, and stays
 */
double noise_range(const struct world_noise *noise, const struct noise_limits *limits,
                   double range_m, uint64_t bits);

/** Turns a direction by a normal error of deviation angle_rad. */
void noise_turn(const struct world_noise *noise, double along[2], uint64_t bits);

/* --- sonar ------------------------------------------------------------------------------------ */

/* A ring of sonars.  Each sonar reports the nearest echo of the rays in its cone. */

struct sonar_ray {
    double x, y; /* direction in the robot's frame */
};

struct sonar {
    double x, y; /* position in the robot's frame */
    struct noise_limits range;
    struct world_noise noise;
    double least_cos; /* of the largest angle of incidence at which an echo returns; 0: any angle */
    uint32_t first_ray, ray_count;
};

struct sonar_ring {
    size_t count;
    struct sonar *sonars;
    struct sonar_ray *rays; /* of all sonars */
    uint32_t ray_count;
    double reach_m; /* from the robot's middle */
    bool mirrors;   /* an echo may depend on the surface that a ray hits */
};

/** Takes memory. */
void sonar_init(struct sonar_ring *ring, const struct world_robot *robot);

/**
 * Reads all sonars.  Rays are cast in batches; if much is near, or a sonar depends on surfaces,
 * they are cast one by one, with the same bits.
 */
void sonar_read(const struct sonar_ring *ring, struct sensing *at, float range_m[]);

/* --- laser ------------------------------------------------------------------------------------ */

/* A scanner with one exact beam per sample. */

struct laser {
    struct frame place; /* in the robot's frame */
    struct noise_limits range;
    struct world_noise noise;
    struct fan_table table; /* count 0: there is no laser */
};

/** Takes memory. */
void laser_init(struct laser *laser, const struct world_laser *from);

/** @return the distance that it sees, from the robot's middle */
double laser_reach(const struct laser *laser);

/** Reads what is due of all samples, from right to left, into the lists of the robot. */
void laser_read(const struct laser *laser, const struct sensing *at);

/* --- camera ----------------------------------------------------------------------------------- */

/* A camera that finds blobs of colour, column by column. */

struct camera {
    struct frame place; /* in the robot's frame */
    double range_m;
    uint32_t colors[MU_COLORS_MAX];
    size_t color_count; /* 0: it finds all colours */
    struct fan_table
        table; /* one beam through the middle of each column; count 0: there is no camera */
};

/** Takes memory. */
void camera_init(struct camera *camera, const struct world_camera *from);

/** @return the distance that it sees, from the robot's middle */
double camera_reach(const struct camera *camera);

/**
 * Finds blobs: runs of columns that see one colour of one owner.  A solid hides those behind it,
 * whether or not its colour is wanted.
 *
 * @param blobs  out: the nearest ones, nearest first; room for MU_BLOBS_MAX
 * @return how many
 */
size_t camera_read(const struct camera *camera, const struct sensing *at, struct mu_blob blobs[]);

/* --- fiducials -------------------------------------------------------------------------------- */

/* A finder that reads the numbers of solids. */

struct fiducials {
    struct frame place; /* in the robot's frame */
    double range_min_m, range_max_m, range_id_m;
    double half_fov_rad;
};

void fiducials_init(struct fiducials *finder, const struct world_fiducial_finder *from);

/** @return the distance that it sees, from the robot's middle; 0: there is no finder */
double fiducials_reach(const struct fiducials *finder);

/**
 * Finds the solids that bear a number, have their middle in the field of view, and are not hidden.
 * A solid is visible if the ray to its middle first meets it, or another part of its owner.
 *
 * @param found  out: the nearest ones, nearest first; room for MU_FIDUCIALS_MAX
 * @return how many
 */
size_t fiducials_read(const struct fiducials *finder, const struct sensing *at,
                      struct mu_fiducial found[]);

#endif
