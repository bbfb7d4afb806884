/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file solid.h
 * A piece of solid matter in the plane, ready for rays and contacts.
 */
#ifndef MUSTER_SIM_SOLID_H
#define MUSTER_SIM_SOLID_H

#include "world/world.h"

#include <math.h>

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

#endif
