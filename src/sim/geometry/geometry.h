/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file geometry.h
 * The plane: frames, solid matter, rays, contacts, and random numbers that belong to a place.
 */
#ifndef MUSTER_SIM_GEOMETRY_H
#define MUSTER_SIM_GEOMETRY_H

#include "world/model/world.h"

#include <math.h>
#include <stdint.h>

/* --- frames ----------------------------------------------------------------------------------- */

/*
 * Places with a heading, in the plane: a robot in its world, a sensor on its robot.
 */

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

/* --- solids ----------------------------------------------------------------------------------- */

/*
 * A piece of solid matter in the plane, ready for rays and contacts.
 */

/* What a solid does to others; also what an eye looks for. */
enum solid_returns { SOLID_STOPS = 1, SOLID_ECHOES = 2, SOLID_SHOWS = 4, SOLID_ALL = 7 };

enum { SOLID_NOBODY = -1 };

/* A box (half_x, half_y) or a disc (radius).  What rays ask for comes first. */
struct solid {
    double x, y;           /* its middle */
    double c, s;           /* cosine and sine of its heading */
    double half_x, half_y; /* of a disc: its radius, both */
    enum world_shape_kind kind;
    uint32_t returns; /* of enum solid_returns */
    int32_t owner;    /* the number of what it moves with; SOLID_NOBODY: it stands.  A thing in a
                         gripper belongs to the robot, whose sensors then do not see it */
    int32_t fiducial; /* 0: none */
    double reach;     /* of the circle around it */
    uint32_t rgb;     /* 0xRRGGBB */
    bool away;        /* lifted off the floor: nothing meets it, no ray sees it */
};

/** A box that returns everything and belongs to nobody. */
struct solid solid_box(struct world_pose middle, double half_x_m, double half_y_m);

/** Likewise a disc. */
struct solid solid_disc(double x_m, double y_m, double radius_m);

struct solid solid_of_shape(const struct world_shape *shape);

/** Takes over how a thing looks. */
void solid_look(struct solid *solid, const struct world_look *look);

/** The half sizes of the upright box around it. */
void solid_extent(const struct solid *solid, double *x_m, double *y_m);

/** Writes the unit vector that stands on the solid's surface where a ray has hit it, outwards. */
void solid_normal(const struct solid *solid, const double at[2], double normal[2]);

/** @return whether a circle about (x, y) may reach the solid; never no when it does */
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
    double beside = fx * along[1] - fy * along[0]; /* of the ray's line to the middle */
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
 * The two slabs of the box.  Along a side the division gives infinities, which compare as they
 * should; exactly on a side's line it gives a NaN, and a ray that grazes a side counts as a miss
 * or a hit of that side alike.
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
    double limit = t_out < best ? t_out : best; /* one branch, seldom taken, for all that misses */
    return t_in <= limit ? t_in : best;
}

/**
 * Casts a ray along a unit vector.
 *
 * @return the distance to the solid, 0 from inside it, or best where that is smaller
 */
static inline double solid_ray(const struct solid *solid, const double from[2],
                               const double along[2], double best)
{
    return solid->kind == WORLD_BOX ? solid_ray_box(solid, from, along, best)
                                    : solid_ray_disc(solid, from, along, best);
}

/* --- contacts --------------------------------------------------------------------------------- */

/*
 * Where two solids touch, and how deep.
 */

enum { NARROW_POINTS_MAX = 2 };

struct narrow_contact {
    double normal_x, normal_y; /* from the second solid to the first, length 1 */
    size_t count;              /* 0: they do not touch */
    struct {
        double x, y, depth;
    } points[NARROW_POINTS_MAX];
};

/** Finds the contact of any two solids. */
void narrow_collide(const struct solid *a, const struct solid *b, struct narrow_contact *contact);

/* --- the grid --------------------------------------------------------------------------------- */

/*
 * Which solids are near: a uniform grid, and rays through it.
 *
 * Two grids lie over one another cell by cell: one for what stands, built once, and one for what
 * moves, built anew after each move.  The answers are exact; the grid only saves work.  Whoever
 * wants another structure replaces this file: nothing else knows of cells.
 */

enum { GRID_CELLS_MAX = 65536, GRID_NOBODY = -2 }; /* no solid has this owner */

/* A solid in a cell. */
struct grid_part {
    uint32_t cell, solid;
};

struct grid_layer {
    const struct solid *solids;
    uint32_t count;
    uint32_t *start;   /* of each cell's entries; one more than there are cells */
    uint32_t *entries; /* indices of solids */
    uint32_t entries_max;
    struct grid_part *parts; /* while it is built: one for each entry */
    uint32_t *outside;       /* solids that do not lie wholly on the grid */
    uint32_t outside_count;
    uint64_t *seen; /* for each solid, the number of the query that met it last */
};

struct grid {
    double x0, y0, cell_m, per_m;
    int nx, ny;
    uint32_t *cursor; /* a cell's next free entry, while a layer is built */
    uint64_t query;
    struct grid_layer still, moving;
};

/**
 * Lays a grid over what stands, and a margin around it, and takes all memory.
 *
 * @param moving  what moves, where it is now: its sizes must not change; it may leave the grid
 */
void grid_init(struct grid *grid, const struct solid *still, size_t still_count,
               const struct solid *moving, size_t moving_count);

/** Takes over where the moving solids are now. */
void grid_update(struct grid *grid);

/* Whose ray it is, and what it looks for. */
struct grid_eye {
    int self;         /* what has this owner it does not see; GRID_NOBODY: it sees all */
    uint32_t returns; /* what has none of these it does not see either */
};

/**
 * Casts a ray.
 *
 * @param along  a unit vector
 * @param hit    out: the nearest solid; NULL when there is none within range_m
 * @return the distance to it, 0 from inside one, range_m when there is none nearer
 */
double grid_find(const struct grid *grid, struct grid_eye eye, const double from[2],
                 const double along[2], double range_m, const struct solid **hit);

/** grid_find for what echoes, without asking what it is. */
double grid_ray(const struct grid *grid, int self, const double from[2], const double along[2],
                double range_m);

/* What is near something: what stands, and what moves.  Both have room for all. */
struct grid_near {
    uint32_t *still, *moving;
    size_t still_count, moving_count;
};

/**
 * Lists at least what comes within reach_m of the middle of a moving solid, each once, in a fixed
 * order; of the moving ones those with a higher number.
 */
void grid_near(struct grid *grid, uint32_t index, double reach_m, struct grid_near *near);

/** Likewise what may touch any solid: it need not be on the grid, and all moving ones count. */
void grid_around(struct grid *grid, const struct solid *solid, struct grid_near *near);

/* --- random numbers --------------------------------------------------------------------------- */

/*
 * Noise that is drawn from its place: who, which sensor, when, which beam.
 *
 * There is no state, so that reading one sensor never changes another, whichever thread reads it,
 * and a run that goes on from a snapshot draws what it would have drawn.  Nothing here asks the
 * mathematics library, whose last bits differ between machines.
 */

/* What is drawn for; a new one goes to the end, or old runs change. */
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

/** @return the key of all that one sensor draws at one time, for draw_bits */
uint64_t draw_key(uint64_t seed, uint64_t robot, enum draw_use use, uint64_t tick);

/** @return 64 bits that have nothing in common with those of another key or index */
uint64_t draw_bits(uint64_t key, uint64_t index);

/** @return evenly spread in (0, 1), both ends excluded */
double draw_unit(uint64_t bits);

/** @return a normal deviate, mean 0 and standard deviation 1 */
double draw_normal(uint64_t bits);

#endif
