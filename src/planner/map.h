/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file map.h
 * How far each place of a world is from what stands there: a grid, made once from the world's file.
 *
 * Only what never moves is in it: no robots, and nothing that can be pushed; what robots merely see
 * counts, too: they go round it.  Metres.  All memory
 * is taken when it is made.
 */
#ifndef MUSTER_AGENT_MAP_H
#define MUSTER_AGENT_MAP_H

#include "world/world.h"

enum { MAP_CELLS_MAX = 1 << 20 };

struct map {
    double x0_m, y0_m; /* the outer corner of the first cell */
    double cell_m;
    int nx, ny;
    float *room_m; /* of each cell's middle, row by row; MAP_FAR_M where nothing is that near */
};

/* Farther than this nobody asks. */
#define MAP_FAR_M 0.9

/** Makes the grid of a world; cells are 0.1 m, or larger where that would be too many. */
void map_make(struct map *map, const struct world *world);

/** @return the cell of a place; -1: it is outside */
int map_cell(const struct map *map, double x_m, double y_m);

/** The middle of a cell. */
void map_middle(const struct map *map, int cell, double out_m[2]);

/** @return the distance of a place from a shape's rim; 0 inside of it */
double map_distance(const struct world_shape *shape, double x_m, double y_m);

#endif
