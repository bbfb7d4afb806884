/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file solid.h
 * A piece of solid matter in the plane, ready for rays and contacts.
 */
#ifndef MUSTER_SIM_SOLID_H
#define MUSTER_SIM_SOLID_H

#include "world/world.h"

/* A box (half_x, half_y) or a disc (radius). */
struct solid {
    enum world_shape_kind kind;
    double x, y;           /* its middle */
    double c, s;           /* cosine and sine of its heading */
    double half_x, half_y; /* of a disc: its radius, both */
    double reach;          /* of the circle around it */
    bool away;             /* lifted off the floor: nothing meets it, no ray sees it */
};

struct solid solid_box(struct world_pose middle, double half_x_m, double half_y_m);

struct solid solid_disc(double x_m, double y_m, double radius_m);

struct solid solid_of_shape(const struct world_shape *shape);

/** The half sizes of the upright box around it. */
void solid_extent(const struct solid *solid, double *x_m, double *y_m);

/**
 * Casts a ray from (x, y) along the unit vector (dx, dy).
 *
 * @return the distance to the solid, 0 from inside it, or best where that is smaller
 */
double solid_ray(const struct solid *solid, const double from[2], const double along[2],
                 double best);

#endif
