/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fan.h
 * Many beams from one place: a z-buffer over the beams of a scanner.
 *
 * Each solid is tested against the beams that can meet it, so many at a time as the vector unit
 * takes.  The same source is compiled for each vector unit; all give the same bits, since each beam
 * sees the same operations in the same order, whoever sits beside it.
 */
#ifndef MUSTER_SIM_FAN_H
#define MUSTER_SIM_FAN_H

#include "sim/sensors/gather.h"

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

/* Rays from anywhere to anywhere, in the world; unit vectors. */
struct fan_rays {
    size_t count;
    double *from_x, *from_y, *along_x, *along_y; /* room for count, rounded up to FAN_PAD; */
    double *range_m;                             /* what is beyond count is some ray too */
    uint32_t returns;                            /* of enum solid_returns */
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
