/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file geometry.h
 * Geometry in the plane: frames, solids, rays, contacts, a grid, and random numbers without state.
 */
#ifndef MUSTER_SIM_GEOMETRY_H
#define MUSTER_SIM_GEOMETRY_H

#include "world/model/world.h"

#include <math.h>
#include <stdint.h>

/* --- frames ----------------------------------------------------------------------------------- */

/*
 * A pose in the plane.  The heading is stored as cosine and sine, so that many turns lose nothing.
 */
struct frame {
    double x, y, c, s;
};

static inline struct frame frame_of(struct world_pose pose)
{
    struct frame frame = {.x = pose.x_m, .y = pose.y_m};
    sincos(pose.heading_rad, &frame.s, &frame.c);
    return frame;
}

/** @return the frame `inner`, which is given in `outer`, in the frame in which `outer` is given */
static inline struct frame frame_join(const struct frame *outer, const struct frame *inner)
{
    return (struct frame){outer->x + outer->c * inner->x - outer->s * inner->y,
                          outer->y + outer->s * inner->x + outer->c * inner->y,
                          outer->c * inner->c - outer->s * inner->s,
                          outer->s * inner->c + outer->c * inner->s};
}

/* --- solids ----------------------------------------------------------------------------------- */

/* The effects of a solid on bodies and sensors; also the effects that a ray looks for. */
enum solid_returns { SOLID_STOPS = 1, SOLID_ECHOES = 2, SOLID_SHOWS = 4, SOLID_ALL = 7 };

enum { SOLID_NOBODY = -1 };

/* A box or a disc, ready for rays and contacts.  The members that rays read come first. */
struct solid {
    double x, y;           /* middle */
    double c, s;           /* cosine and sine of the heading */
    double half_x, half_y; /* of a disc: the radius, twice */
    enum world_shape_kind kind;
    uint32_t returns; /* of enum solid_returns */
    int32_t owner; /* the body that it moves with, or SOLID_NOBODY. An object in a gripper has the
                      robot as its owner, so that the robot's sensors do not see it */
    double reach;  /* radius of the circle around it */
    struct world_look look; /* what sensors report of it */
    bool away;              /* lifted off the floor: no body meets it and no ray sees it */
};

/** @return a box that returns everything and has no owner */
struct solid solid_box(struct world_pose middle, double half_x_m, double half_y_m);

/** @return a disc that returns everything and has no owner */
struct solid solid_disc(double x_m, double y_m, double radius_m);

struct solid solid_of_shape(const struct world_shape *shape);

/** Sets the look, and what a ray may look for. */
void solid_look(struct solid *solid, const struct world_look *look);

/** Writes the half sizes of the upright box around a solid. */
void solid_extent(const struct solid *solid, double *x_m, double *y_m);

/** Writes the outward unit normal of the solid's surface at a point where a ray has hit it. */
void solid_normal(const struct solid *solid, const double at[2], double normal[2]);

/**
 * @return whether a circle about (x, y) may reach the solid; a circle that reaches it is never
 *         refused
 */
static inline bool solid_is_within(const struct solid *solid, double x, double y, double reach_m)
{
    double dx = x - solid->x;
    double dy = y - solid->y;
    double reach = solid->reach + reach_m;
    if (!(dx * dx + dy * dy <= reach * reach)) {
        return false;
    }
    double bx = fabs(solid->c * dx + solid->s * dy) - solid->half_x;
    double by = fabs(solid->c * dy - solid->s * dx) - solid->half_y;
    bx = bx > 0 ? bx : 0;
    by = by > 0 ? by : 0;
    return bx * bx + by * by <= reach_m * reach_m;
}

static inline double solid_ray_disc(const struct solid *solid, const double from[2],
                                    const double along[2], double best)
{
    double fx = from[0] - solid->x;
    double fy = from[1] - solid->y;
    double b = fx * along[0] + fy * along[1];
    double beside = fx * along[1] - fy * along[0]; /* distance of the ray's line from the middle */
    double c = fx * fx + fy * fy - solid->half_x * solid->half_x;
    double d = solid->half_x * solid->half_x - beside * beside; /* b b - c, without cancellation */
    if (((c > 0) & (b > 0)) | (d < 0)) {
        return best;
    }
    double t = -b - sqrt(d);
    t = t < 0 ? 0 : t;
    return t < best ? t : best;
}

/*
 * The slab method for a box.  A ray along a side divides by zero, and the infinities compare
 * correctly.  Exactly on a side's line the quotient is a NaN: such a ray may count as a miss or as
 * a hit of that side.
 */
static inline double solid_ray_box(const struct solid *solid, const double from[2],
                                   const double along[2], double best)
{
    double fx = from[0] - solid->x;
    double fy = from[1] - solid->y;
    double lx = solid->c * fx + solid->s * fy;
    double ly = solid->c * fy - solid->s * fx;
    double per_x = 1.0 / (solid->c * along[0] + solid->s * along[1]);
    double per_y = 1.0 / (solid->c * along[1] - solid->s * along[0]);
    double x0 = (-solid->half_x - lx) * per_x;
    double x1 = (solid->half_x - lx) * per_x;
    double y0 = (-solid->half_y - ly) * per_y;
    double y1 = (solid->half_y - ly) * per_y;
    double x_in = x0 < x1 ? x0 : x1;
    double x_out = x0 > x1 ? x0 : x1;
    double y_in = y0 < y1 ? y0 : y1;
    double y_out = y0 > y1 ? y0 : y1;
    double t_in = x_in > y_in ? x_in : y_in;
    double t_out = x_out < y_out ? x_out : y_out;
    t_in = t_in < 0 ? 0 : t_in;
    double limit = t_out < best ? t_out : best; /* one branch for all misses, seldom taken */
    return t_in <= limit ? t_in : best;
}

/**
 * Casts a ray along a unit vector.
 *
 * @return the distance to the solid, 0 from inside it, or `best` if that is smaller
 */
static inline double solid_ray(const struct solid *solid, const double from[2],
                               const double along[2], double best)
{
    return solid->kind == WORLD_BOX ? solid_ray_box(solid, from, along, best)
                                    : solid_ray_disc(solid, from, along, best);
}

/* --- contacts --------------------------------------------------------------------------------- */

enum { NARROW_POINTS_MAX = 2 };

struct narrow_contact {
    double normal_x, normal_y; /* of length 1, from the second solid to the first */
    size_t count;              /* 0: they do not touch */
    struct {
        double x, y, depth;
    } points[NARROW_POINTS_MAX];
};

/** Finds the contact of two solids: up to two points, each with its depth in metres. */
void narrow_collide(const struct solid *a, const struct solid *b, struct narrow_contact *contact);

/** @return the depth of the deepest point, in metres; 0: they do not touch */
static inline double narrow_depth(const struct narrow_contact *contact)
{
    double depth = 0;
    for (size_t i = 0; i < contact->count; i++) {
        depth = fmax(depth, contact->points[i].depth);
    }
    return depth;
}

/* --- the grid --------------------------------------------------------------------------------- */

/*
 * A uniform grid over all solids.  Standing solids and moving solids have a layer each, with the
 * same cells.  The standing layer is built once; the moving layer is built again after each move.
 * Answers are exact: the grid only saves work.  No other file knows of cells.
 */

enum { GRID_CELLS_MAX = 65536, GRID_NOBODY = -2 }; /* GRID_NOBODY is the owner of no solid */

/* A solid in a cell. */
struct grid_part {
    uint32_t cell, solid;
};

struct grid_layer {
    const struct solid *solids;
    uint32_t count;
    uint32_t *start;   /* first entry of each cell; one more than there are cells */
    uint32_t *entries; /* indices of solids */
    uint32_t entries_max;
    struct grid_part *parts; /* one for each entry, used while the layer is built */
    uint32_t *outside;       /* solids that are not wholly on the grid */
    uint32_t outside_count;
    uint64_t *seen; /* for each solid, the number of the last query that met it */
};

struct grid {
    double x0, y0, cell_m, per_m;
    int nx, ny;
    uint32_t *cursor; /* next free entry of each cell, used while a layer is built */
    uint64_t query;
    struct grid_layer still, moving;
};

/** @return the cell of a coordinate, which is counted in cells; outside, the nearest of `count` */
static inline int grid_clamp(double cell, int count)
{
    return !(cell >= 0) ? 0 : cell >= count ? count - 1 : (int)cell; /* a NaN also finds a cell */
}

/**
 * Lays a grid over the standing solids with a margin around them, and takes all memory.
 *
 * @param moving  the moving solids, at their present poses; their sizes must not change, and they
 *                may leave the grid
 */
void grid_init(struct grid *grid, const struct solid *still, size_t still_count,
               const struct solid *moving, size_t moving_count);

/** Builds the moving layer for the present poses. */
void grid_update(struct grid *grid);

/* The owner of a ray, and the effects that it looks for. */
struct grid_eye {
    int self;         /* solids of this owner are invisible; GRID_NOBODY: none is */
    uint32_t returns; /* solids with none of these bits are invisible */
};

/**
 * Casts a ray.
 *
 * @param along  a unit vector
 * @param hit    out: the nearest solid; NULL if there is none within range_m
 * @return the distance to it, 0 from inside one, range_m if there is none nearer
 */
double grid_find(const struct grid *grid, struct grid_eye eye, const double from[2],
                 const double along[2], double range_m, const struct solid **hit);

/** Casts a ray that looks for echoes and does not ask which solid it hits. */
double grid_ray(const struct grid *grid, int self, const double from[2], const double along[2],
                double range_m);

/* The solids near a place.  Both lists have room for all solids. */
struct grid_near {
    uint32_t *still, *moving;
    size_t still_count, moving_count;
};

/**
 * Lists all solids that come within reach_m of the middle of a moving solid, and maybe more.  Each
 * is listed once, in a fixed order.  Moving solids are listed only if their number is higher.
 */
void grid_near(struct grid *grid, uint32_t index, double reach_m, struct grid_near *near);

/**
 * Lists all solids that may touch a solid, which need not be on the grid.  All moving solids count.
 */
void grid_around(struct grid *grid, const struct solid *solid, struct grid_near *near);

/* --- random numbers --------------------------------------------------------------------------- */

/*
 * Random numbers without state: each depends on seed, robot, sensor, step and beam alone.  Hence
 * reading one sensor never changes another, in any thread, and a run that resumes from a snapshot
 * draws the same numbers.  No function of the mathematics library is called: their last bits differ
 * between machines.
 */

/* The purpose of a number.  New purposes go to the end: another order changes old runs. */
enum draw_use {
    DRAW_SONAR,
    DRAW_LASER,
    DRAW_LASER_ANGLE,
    DRAW_CAMERA,
    DRAW_FIDUCIALS,
    DRAW_GPS,
    DRAW_GPS_DRIFT,
    DRAW_COMPASS,
    DRAW_ODOMETER
};

/** @return the key of all numbers that one sensor draws in one step, for draw_bits */
uint64_t draw_key(uint64_t seed, uint64_t robot, enum draw_use use, uint64_t tick);

/** @return 64 bits, independent of those of any other key or index */
uint64_t draw_bits(uint64_t key, uint64_t index);

/** @return a number evenly distributed in (0, 1), without both ends */
double draw_unit(uint64_t bits);

/** @return a normal deviate with mean 0 and standard deviation 1 */
double draw_normal(uint64_t bits);

#endif
