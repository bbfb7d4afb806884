/* SPDX-License-Identifier: Apache-2.0 */
#include "planner/planner.h"

#include "muster/memory.h"

#include <math.h>

static const double distance_map_cell_m = 0.1;

double distance_to_shape(const struct world_shape *shape, double x_m, double y_m)
{
    double dx = x_m - shape->pose.x_m;
    double dy = y_m - shape->pose.y_m;
    if (shape->kind == WORLD_DISC) {
        return fmax(0, hypot(dx, dy) - shape->radius_m);
    }
    double s, c;
    sincos(shape->pose.heading_rad, &s, &c);
    double along = fmax(0, fabs(c * dx + s * dy) - shape->half_x_m);
    double across = fmax(0, fabs(c * dy - s * dx) - shape->half_y_m);
    return hypot(along, across);
}

int distance_map_cell(const struct distance_map *map, double x_m, double y_m)
{
    double column = floor((x_m - map->x0_m) / map->cell_m);
    double row = floor((y_m - map->y0_m) / map->cell_m);
    bool inside = column >= 0 && row >= 0 && column < map->nx && row < map->ny;
    return inside ? (int)row * map->nx + (int)column : -1;
}

void distance_map_middle(const struct distance_map *map, int cell, double out_m[2])
{
    out_m[0] = map->x0_m + (cell % map->nx + 0.5) * map->cell_m;
    out_m[1] = map->y0_m + (cell / map->nx + 0.5) * map->cell_m;
}

static int distance_map_clamp(double value, int most)
{
    return value < 0 ? 0 : value > most ? most : (int)value;
}

/* Lowers the distances of the cells around a shape to their distance from it. */
static void distance_map_add(struct distance_map *map, const struct world_shape *shape)
{
    double reach_m =
        DISTANCE_FAR_M +
        (shape->kind == WORLD_DISC ? shape->radius_m : hypot(shape->half_x_m, shape->half_y_m));
    double left_m = shape->pose.x_m - reach_m - map->x0_m;
    double low_m = shape->pose.y_m - reach_m - map->y0_m;
    int x1 = distance_map_clamp((left_m + 2 * reach_m) / map->cell_m, map->nx - 1);
    int y1 = distance_map_clamp((low_m + 2 * reach_m) / map->cell_m, map->ny - 1);
    for (int y = distance_map_clamp(low_m / map->cell_m, map->ny - 1); y <= y1; y++) {
        for (int x = distance_map_clamp(left_m / map->cell_m, map->nx - 1); x <= x1; x++) {
            double middle_m[2];
            int cell = y * map->nx + x;
            distance_map_middle(map, cell, middle_m);
            float far_m = (float)distance_to_shape(shape, middle_m[0], middle_m[1]);
            map->room_m[cell] = fminf(map->room_m[cell], far_m);
        }
    }
}

void distance_map_make(struct distance_map *map, const struct world *world)
{
    double wide_m = fmax(1, world->max_x_m - world->min_x_m);
    double high_m = fmax(1, world->max_y_m - world->min_y_m);
    map->cell_m = fmax(distance_map_cell_m, 1.01 * sqrt(wide_m * high_m / DISTANCE_CELLS_MAX));
    map->cell_m = fmax(map->cell_m, fmax(wide_m, high_m) / 32768);
    map->nx = (int)ceil(wide_m / map->cell_m);
    map->ny = (int)ceil(high_m / map->cell_m);
    map->x0_m = world->min_x_m;
    map->y0_m = world->min_y_m;
    size_t cells = (size_t)map->nx * (size_t)map->ny;
    map->room_m = mu_startup_array(cells, sizeof *map->room_m);
    for (size_t i = 0; i < cells; i++) {
        map->room_m[i] = (float)DISTANCE_FAR_M;
    }
    for (size_t i = 0; i < world->shape_count; i++) {
        if (world->shapes[i].look.stops || world->shapes[i].look.echoes) {
            distance_map_add(map, &world->shapes[i]);
        }
    }
}
