/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/geometry/geometry.h"

struct solid solid_box(struct world_pose middle, double half_x_m, double half_y_m)
{
    struct solid box = {.kind = WORLD_BOX,
                        .returns = SOLID_ALL,
                        .owner = SOLID_NOBODY,
                        .x = middle.x_m,
                        .y = middle.y_m,
                        .half_x = half_x_m,
                        .half_y = half_y_m,
                        .reach = sqrt(half_x_m * half_x_m + half_y_m * half_y_m)};
    sincos(middle.heading_rad, &box.s, &box.c);
    return box;
}

struct solid solid_disc(double x_m, double y_m, double radius_m)
{
    return (struct solid){.kind = WORLD_DISC,
                          .returns = SOLID_ALL,
                          .owner = SOLID_NOBODY,
                          .x = x_m,
                          .y = y_m,
                          .c = 1,
                          .half_x = radius_m,
                          .half_y = radius_m,
                          .reach = radius_m};
}

struct solid solid_of_shape(const struct world_shape *shape)
{
    struct solid solid = shape->kind == WORLD_DISC
                             ? solid_disc(shape->pose.x_m, shape->pose.y_m, shape->radius_m)
                             : solid_box(shape->pose, shape->half_x_m, shape->half_y_m);
    /* A disc may bear a number, which has a heading. */
    sincos(shape->pose.heading_rad, &solid.s, &solid.c);
    solid_look(&solid, &shape->look);
    return solid;
}

void solid_look(struct solid *solid, const struct world_look *look)
{
    solid->returns = (look->stops ? SOLID_STOPS : 0u) | (look->echoes ? SOLID_ECHOES : 0u) |
                     (look->shows ? SOLID_SHOWS : 0u);
    solid->look = *look;
}

void solid_extent(const struct solid *solid, double *x_m, double *y_m)
{
    bool disc = solid->kind == WORLD_DISC;
    double c = fabs(solid->c);
    double s = fabs(solid->s);
    *x_m = disc ? solid->half_x : c * solid->half_x + s * solid->half_y;
    *y_m = disc ? solid->half_x : s * solid->half_x + c * solid->half_y;
}

void solid_normal(const struct solid *solid, const double at[2], double normal[2])
{
    double fx = at[0] - solid->x;
    double fy = at[1] - solid->y;
    if (solid->kind == WORLD_DISC) {
        double far = sqrt(fx * fx + fy * fy);
        normal[0] = far > 0 ? fx / far : 1;
        normal[1] = far > 0 ? fy / far : 0;
        return;
    }
    double lx = solid->c * fx + solid->s * fy;
    double ly = solid->c * fy - solid->s * fx;
    bool end =
        fabs(lx) - solid->half_x > fabs(ly) - solid->half_y; /* the point lies on the nearer side */
    double nx = !end ? 0 : lx < 0 ? -1 : 1;
    double ny = end ? 0 : ly < 0 ? -1 : 1;
    normal[0] = solid->c * nx - solid->s * ny;
    normal[1] = solid->s * nx + solid->c * ny;
}
