/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fan.h
 * Many rays at once: what is near, as arrays, and kernels that cast beams at it.
 */
#ifndef MUSTER_SIM_FAN_H
#define MUSTER_SIM_FAN_H

#include "sim/geometry/geometry.h"

/* --- what is near ----------------------------------------------------------------------------- */

/*
 * What lies within the reach of a robot's sensors, collected once for all of them.
 *
 * All solids are kept sorted by tile, as arrays, so that vector units can look through them: what
 * stands once, what moves anew at each sensing.  A solid lies in the tile of its middle, small ones
 * in small tiles and large ones in larger: the cost of a collection is that of what is near,
 * however large the world.
 */

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

struct gather_circle {
    double x, y, reach_m;
};

/* Rays from anywhere to anywhere, in the world; unit vectors. */
struct fan_rays {
    size_t count;
    double *from_x, *from_y, *along_x, *along_y; /* room for count, rounded up to FAN_PAD; */
    double *range_m;                             /* what is beyond count is some ray too */
    uint32_t returns;                            /* of enum solid_returns */
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

/* --- beams ------------------------------------------------------------------------------------ */

/*
 * Many beams from one place: a z-buffer over the beams of a scanner.
 *
 * Each solid is tested against the beams that can meet it, so many at a time as the vector unit
 * takes.  The same source is compiled for each vector unit; all give the same bits, since each beam
 * sees the same operations in the same order, whoever sits beside it.
 */

enum {
    FAN_PAD = 8,        /* a multiple of every vector's length */
    FAN_NOTHING = -1,   /* the id of no solid */
    FAN_KERNELS_MAX = 4 /* that one program has */
};

/* The directions of the beams in the scanner's frame, counter-clockwise at equal steps. */
struct fan_table {
    double first_rad, step_rad;
    uint32_t count;
    double *along_x, *along_y; /* room for count, rounded up to FAN_PAD */
};

/* A scanner: where it is, cosine and sine of its heading, and what it sees. */
struct fan_eye {
    double x, y, c, s;
    double range_m;
    uint32_t returns; /* of enum solid_returns */
};

struct fan_kernel {
    const char *name;
    size_t crowd; /* among more solids, to cast rays one by one through a grid is faster */
    /** Lists which of the solids begin..end-1 come within the circle.  @return how many */
    size_t (*near)(const struct gather_solids *solids, size_t begin, size_t end,
                   const struct gather_circle *circle, uint32_t *found);
    /**
     * Casts the beams.
     *
     * @param range_m  out: of each beam, eye->range_m when it meets nothing; room as in the table
     * @param hit      out: the id of what each beam met, or FAN_NOTHING; NULL: nobody asks
     */
    void (*sweep)(const struct fan_table *table, const struct fan_eye *eye,
                  const struct gather_solids *solids, double *range_m, int64_t *hit);
    /**
     * Casts rays at some solids, as solid_ray does it, to the same bits.
     *
     * @param some  the numbers of so many solids
     */
    void (*cast)(const struct fan_rays *rays, const struct gather_solids *solids,
                 const uint32_t *some, size_t count);
};

/** Takes memory for so many rays. */
void fan_rays_init(struct fan_rays *rays, size_t count);

/**
 * Takes memory and computes a table.
 *
 * @param first_rad  of the first beam, from -pi to 0; the last is less than a turn further
 */
void fan_table_init(struct fan_table *table, double first_rad, double step_rad, uint32_t count);

/** @return the kernel in use: the widest that this processor has, or MUSTER_FAN names */
const struct fan_kernel *fan_kernel(void);

/** Uses another one.  @return false: this program or processor does not have it */
bool fan_choose(const char *name);

/** @return the name of the kernel with this number that this processor has; NULL: no more */
const char *fan_name(size_t number);

#endif
