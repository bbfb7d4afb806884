/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file noise.h
 * How readings of a range are falsified.
 */
#ifndef MUSTER_SIM_NOISE_H
#define MUSTER_SIM_NOISE_H

#include "sim/geometry/draw.h"
#include "world/world.h"

/* What a reading may be. */
struct noise_limits {
    double min_m, max_m;
};

static inline bool noise_is_exact(const struct world_noise *noise)
{
    return noise->constant_m <= 0 && noise->per_m <= 0;
}

/** Brings a range inside the limits; a zero loses its sign. */
static inline double noise_clip(const struct noise_limits *limits, double range_m)
{
    range_m = range_m > limits->max_m ? limits->max_m : range_m;
    return range_m > limits->min_m ? range_m : limits->min_m;
}

/**
 * @return an echo's range with a normal error of constant_m + per_m * range_m, inside the limits;
 *         max_m, which says that no echo came, stays as it is
 */
double noise_range(const struct world_noise *noise, const struct noise_limits *limits,
                   double range_m, uint64_t bits);

/** Turns a direction by a normal error of angle_rad. */
void noise_turn(const struct world_noise *noise, double along[2], uint64_t bits);

#endif
