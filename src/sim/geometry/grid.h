/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file grid.h
 * Which solids are near: a uniform grid, and rays through it.
 *
 * Two grids lie over one another cell by cell: one for what stands, built once, and one for what
 * moves, built anew after each move.  The answers are exact; the grid only saves work.  Whoever
 * wants another structure replaces this file: nothing else knows of cells.
 */
#ifndef MUSTER_SIM_GRID_H
#define MUSTER_SIM_GRID_H

#include "sim/geometry/solid.h"

#include <stdint.h>

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

#endif
