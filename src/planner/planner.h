/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file planner.h
 * Paths through a world: a map of distances to obstacles, and a search over it.
 *
 * The map is a grid, made once from the world's file.  It has only things that never move.  A thing
 * that robots only see counts, too: they go round it.  The same map and places give the same path.
 * All memory is taken when a map or planner is made.  Metres.
 */
#ifndef MUSTER_PLANNER_H
#define MUSTER_PLANNER_H

#include "world/model/world.h"

enum { DISTANCE_CELLS_MAX = 1 << 20 };

struct distance_map {
    double x0_m, y0_m; /* the outer corner of the first cell */
    double cell_m;
    int nx, ny;
    float
        *room_m; /* of each cell's middle, row by row; DISTANCE_FAR_M where nothing is that near */
};

/* Distances above this are not told apart. */
#define DISTANCE_FAR_M 0.9

/** Makes the grid of a world; cells are 0.1 m, or larger where that would be too many. */
void distance_map_make(struct distance_map *map, const struct world *world);

/** @return the cell of a place; -1: it is outside */
int distance_map_cell(const struct distance_map *map, double x_m, double y_m);

/** The middle of a cell. */
void distance_map_middle(const struct distance_map *map, int cell, double out_m[2]);

/** @return the distance of a place from a shape's rim; 0 inside of it */
double distance_to_shape(const struct world_shape *shape, double x_m, double y_m);

/* --- paths over it: A* between two places, straightened into few way points --- */

enum { PATH_POINTS_MAX = 64 };

struct planner;

struct path {
    double points_m[PATH_POINTS_MAX][2]; /* without the start; the last one is where it ends */
    size_t count;                        /* of a way that was found 1 or more */
    size_t looked;                       /* visited cells: the cost of the search */
};

/** Takes the memory of searches over a map, which must outlive it. */
struct planner *planner_make(const struct distance_map *map);

/**
 * Searches the short path that keeps off walls.
 *
 * A start or an end too near to an obstacle is moved to the nearest free place: the start by at
 * most 0.6 m, the end by at most 0.25 m.
 *
 * @param half_m  half the width of the robot: no path leads through less room
 * @return MU_OK; MU_ABSENT: there is no path, or an end of it is outside or in an obstacle
 */
MU_MUST_USE mu_result planner_search(struct planner *r, const double from_m[2],
                                     const double to_m[2], double half_m, struct path *out);

#endif
