/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/solid.h"

#include <math.h>

struct solid solid_box(struct world_pose middle, double half_x_m, double half_y_m)
{
    return (struct solid){.kind = WORLD_BOX,
                          .x = middle.x_m,
                          .y = middle.y_m,
                          .c = cos(middle.heading_rad),
                          .s = sin(middle.heading_rad),
                          .half_x = half_x_m,
                          .half_y = half_y_m,
                          .reach = sqrt(half_x_m * half_x_m + half_y_m * half_y_m)};
}

struct solid solid_disc(double x_m, double y_m, double radius_m)
{
    return (struct solid){.kind = WORLD_DISC,
                          .x = x_m,
                          .y = y_m,
                          .c = 1,
                          .half_x = radius_m,
                          .half_y = radius_m,
                          .reach = radius_m};
}

struct solid solid_of_shape(const struct world_shape *shape)
{
    return shape->kind == WORLD_DISC ? solid_disc(shape->pose.x_m, shape->pose.y_m, shape->radius_m)
                                     : solid_box(shape->pose, shape->half_x_m, shape->half_y_m);
}

void solid_extent(const struct solid *solid, double *x_m, double *y_m)
{
    bool disc = solid->kind == WORLD_DISC;
    double c = fabs(solid->c);
    double s = fabs(solid->s);
    *x_m = disc ? solid->half_x : c * solid->half_x + s * solid->half_y;
    *y_m = disc ? solid->half_x : s * solid->half_x + c * solid->half_y;
}

static double solid_ray_disc(const struct solid *solid, const double from[2], const double along[2],
                             double best)
{
    double fx = from[0] - solid->x;
    double fy = from[1] - solid->y;
    double b = fx * along[0] + fy * along[1];
    double beside = fx * along[1] - fy * along[0]; /* of the ray's line to the middle */
    double c = fx * fx + fy * fy - solid->half_x * solid->half_x;
    double d = solid->half_x * solid->half_x - beside * beside; /* b b - c, without cancellation */
    if ((c > 0 && b > 0) || d < 0) {
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
static double solid_ray_box(const struct solid *solid, const double from[2], const double along[2],
                            double best)
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
    double x_out = x0 < x1 ? x1 : x0;
    double y_in = y0 < y1 ? y0 : y1;
    double y_out = y0 < y1 ? y1 : y0;
    double t_in = x_in > y_in ? x_in : y_in;
    double t_out = x_out < y_out ? x_out : y_out;
    if (t_in > t_out || t_out < 0) {
        return best;
    }
    t_in = t_in < 0 ? 0 : t_in;
    return t_in < best ? t_in : best;
}

double solid_ray(const struct solid *solid, const double from[2], const double along[2],
                 double best)
{
    return solid->kind == WORLD_BOX ? solid_ray_box(solid, from, along, best)
                                    : solid_ray_disc(solid, from, along, best);
}
