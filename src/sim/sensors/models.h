/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file models.h
 * Each sensor of a robot: what it is, and how it reads what is there.
 */
#ifndef MUSTER_SIM_MODELS_H
#define MUSTER_SIM_MODELS_H

#include "sim/sensors/fan.h"
#include "sim/sensors/sensors.h"

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

/* --- fiducials -------------------------------------------------------------------------------- */

/*
 * A finder that reads numbers off things that bear one.
 */

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
