/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fan.h
 * Batches of rays: nearby solids as arrays, and vector kernels that cast beams at them.
 */
#ifndef MUSTER_SIM_FAN_H
#define MUSTER_SIM_FAN_H

#include "sim/geometry/geometry.h"

/* --- nearby solids ---------------------------------------------------------------------------- */

/*
 * Collects the solids within the reach of a robot's sensors, once for all sensors.
 *
 * All solids are kept as arrays for vector units, sorted by tile: standing solids once, moving
 * solids before each reading.  A solid lies in the tile of its middle.  Small solids lie in small
 * tiles, large ones in larger tiles.  So the cost of a query depends on what is near, and not on
 * the size of the world.
 */

enum {
    GATHER_TIERS = 4,
    GATHER_TILES_MAX = 65536,
    GATHER_PAD = 8 /* entries behind the last one that a vector unit may read */
};

/* Solids as arrays of equal length. */
struct gather_solids {
    size_t count;
    double *x, *y, *c, *s, *half_x, *half_y, *reach; /* as in struct solid */
    int64_t *disc;                                   /* -1: disc; 0: box */
    int64_t *returns;
    int64_t *id; /* index of a standing solid; moving solids follow them */
    int32_t *owner;
};

/* The tiles of all solids whose reach is at most half a tile. */
struct gather_tier {
    double tile_m, per_m;
    int nx, ny;
    size_t first; /* first of its tiles, among those of all tiers */
    bool used;    /* it holds a solid */
};

struct gather_layer {
    const struct solid *from;
    size_t first_id;
    struct gather_solids solids; /* sorted by tile */
    uint32_t *tile;              /* of each solid, in the order of `from` */
    uint32_t *start;             /* of each tile's solids; one more than there are tiles */
};

struct gather {
    double x0, y0;
    struct gather_tier tiers[GATHER_TIERS]; /* the last tier is one tile for all larger solids */
    size_t tiles;
    uint32_t *cursor; /* next free entry of each tile, used while a layer is sorted */
    struct gather_layer still, moving;
};

/* The result of a query.  Each thread has its own. */
struct gather_list {
    struct gather_solids solids;
    uint32_t *found; /* scratch for one row of tiles */
};

struct gather_circle {
    double x, y, reach_m;
};

/* Rays in the world, with any start and direction. */
struct fan_rays {
    size_t count;
    double *from_x, *from_y, *along_x,
        *along_y;     /* unit vectors; room for count, rounded up to FAN_PAD, and */
    double *range_m;  /* every entry of that room must be a ray */
    uint32_t returns; /* of enum solid_returns */
};

/** Takes all memory.  The caller keeps the arrays; the sizes of moving solids must not change. */
void gather_init(struct gather *g, const struct solid *still, size_t still_count,
                 const struct solid *moving, size_t moving_count);

/** Takes memory for a list with room for all solids. */
void gather_list_init(struct gather_list *list, const struct gather *g);

/** Copies poses and owners of the moving solids. */
void gather_update(struct gather *g);

/**
 * Lists in a fixed order at least all solids that come within a circle.  Solids are tested as boxes
 * along their own axes.
 *
 * @param self  solids of this owner are left out
 */
void gather_near(const struct gather *g, const struct gather_circle *circle, int32_t self,
                 struct gather_list *list);

/**
 * Casts rays at all solids that come within a circle.
 *
 * @param self   solids of this owner are left out
 * @param found  scratch, with room for all solids and GATHER_PAD more
 * @return false: so much is near that casting ray by ray is faster; nothing was cast
 */
bool gather_cast(const struct gather *g, const struct gather_circle *circle, int32_t self,
                 const struct fan_rays *rays, uint32_t *found);

/** @return the solid with an id */
const struct solid *gather_solid(const struct gather *g, int64_t id);

/* --- beams ------------------------------------------------------------------------------------ */

/*
 * Casts many beams from one point, with a depth buffer over the beams of a scanner.
 *
 * Each solid is tested against the beams that can meet it, as many at a time as a vector holds.
 * The same source is compiled for each vector unit.  All kernels give the same bits, since each
 * beam sees the same operations in the same order.
 */

enum {
    FAN_PAD = 8,        /* a multiple of the length of every vector */
    FAN_NOTHING = -1,   /* the id of no solid */
    FAN_KERNELS_MAX = 4 /* in one program */
};

/* The directions of the beams in the scanner's frame: counter-clockwise, with equal steps. */
struct fan_table {
    double first_rad, step_rad;
    uint32_t count;
    double *along_x, *along_y; /* room for count, rounded up to FAN_PAD */
};

/*
 * A scanner: its position, cosine and sine of its heading, its range, and the solids that it sees.
 */
struct fan_eye {
    double x, y, c, s;
    double range_m;
    uint32_t returns; /* of enum solid_returns */
};

struct fan_kernel {
    const char *name;
    size_t crowd; /* among more solids, casting ray by ray through a grid is faster */
    /** Lists the solids from begin to end - 1 that come within the circle.  @return how many */
    size_t (*near)(const struct gather_solids *solids, size_t begin, size_t end,
                   const struct gather_circle *circle, uint32_t *found);
    /**
     * Casts the beams of a scanner.
     *
     * @param range_m  out: of each beam; eye->range_m if it meets nothing; room as in the table
     * @param hit      out: the id of the solid that each beam met, or FAN_NOTHING; may be NULL
     */
    void (*sweep)(const struct fan_table *table, const struct fan_eye *eye,
                  const struct gather_solids *solids, double *range_m, int64_t *hit);
    /**
     * Casts rays at some solids.  The results have the bits of solid_ray.
     *
     * @param some  the numbers of the solids
     */
    void (*cast)(const struct fan_rays *rays, const struct gather_solids *solids,
                 const uint32_t *some, size_t count);
};

/** Takes memory for that many rays. */
void fan_rays_init(struct fan_rays *rays, size_t count);

/**
 * Takes memory and computes the directions.
 *
 * @param first_rad  of the first beam, from -pi to 0; the last beam is less than a turn further
 */
void fan_table_init(struct fan_table *table, double first_rad, double step_rad, uint32_t count);

/**
 * @return the kernel in use: the widest that this processor has, or the one that MUSTER_FAN names
 */
const struct fan_kernel *fan_kernel(void);

/** Selects a kernel by its name.  @return false: this program or processor does not have it */
bool fan_choose(const char *name);

/**
 * @return the name of the kernel with this number, among those that this processor can run; NULL:
 *         there are no more
 */
const char *fan_name(size_t number);

#endif
