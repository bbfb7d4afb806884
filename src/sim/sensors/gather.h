/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file gather.h
 * What lies within the reach of a robot's sensors, collected once for all of them.
 *
 * All solids are kept sorted by tile, as arrays, so that vector units can look through them: what
 * stands once, what moves anew at each sensing.  A solid lies in the tile of its middle, small ones
 * in small tiles and large ones in larger: the cost of a collection is that of what is near,
 * however large the world.
 */
#ifndef MUSTER_SIM_GATHER_H
#define MUSTER_SIM_GATHER_H

#include "sim/geometry/solid.h"

#include <stddef.h>
#include <stdint.h>

enum {
    GATHER_TIERS = 4,
    GATHER_TILES_MAX = 65536,
    GATHER_PAD = 8 /* entries beyond the last that a vector unit may read */
};

/* Solids as arrays, all of the same length. */
struct gather_solids {
    size_t count;
    double *x, *y, *c, *s, *half_x, *half_y, *reach; /* as in struct solid */
    int64_t *disc;                                   /* -1: a disc; 0: a box */
    int64_t *returns;
    int64_t *id; /* what stands by its index, then what moves */
    int32_t *owner;
};

/* The tiles of the solids whose reach is at most half a tile. */
struct gather_tier {
    double tile_m, per_m;
    int nx, ny;
    size_t first; /* of its tiles, among those of all tiers */
    bool used;    /* a solid is of its size */
};

struct gather_layer {
    const struct solid *from;
    size_t first_id;
    struct gather_solids solids; /* by tile */
    uint32_t *tile;              /* of each solid, in the order of from */
    uint32_t *start;             /* of each tile's solids; one more than there are tiles */
};

struct gather {
    double x0, y0;
    struct gather_tier tiers[GATHER_TIERS]; /* the last is one tile for all that is larger */
    size_t tiles;
    uint32_t *cursor; /* a tile's next free entry, while a layer is sorted */
    struct gather_layer still, moving;
};

/* What one thread has collected. */
struct gather_list {
    struct gather_solids solids;
    uint32_t *found; /* of one row of tiles */
};

struct fan_rays; /* fan.h */

struct gather_circle {
    double x, y, reach_m;
};

/** Takes all memory.  The arrays stay the caller's; those that move keep their sizes. */
void gather_init(struct gather *g, const struct solid *still, size_t still_count,
                 const struct solid *moving, size_t moving_count);

/** Takes memory for a list that has room for every solid. */
void gather_list_init(struct gather_list *list, const struct gather *g);

/** Takes over where the moving solids are now, and whose. */
void gather_update(struct gather *g);

/**
 * Lists, in a fixed order, at least every solid that comes within the circle, and only such whose
 * upright distance from their own axes says so.
 *
 * @param self  what has this owner is left out
 */
void gather_near(const struct gather *g, const struct gather_circle *circle, int32_t self,
                 struct gather_list *list);

/**
 * Casts rays at every solid that comes within the circle.
 *
 * @param self   what has this owner is left out
 * @param found  scratch, with room for all that stands or moves and GATHER_PAD more
 * @return false: so much is near that to cast each ray by itself is faster; nothing was cast
 */
bool gather_cast(const struct gather *g, const struct gather_circle *circle, int32_t self,
                 const struct fan_rays *rays, uint32_t *found);

/** @return the solid of an id in a list */
const struct solid *gather_solid(const struct gather *g, int64_t id);

#endif
