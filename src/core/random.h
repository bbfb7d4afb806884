/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file random.h
 * Seeded random numbers: one stream for each thing that needs one, the same on every machine.
 *
 * splitmix64 (Steele, Lea, Flood: "Fast splittable pseudorandom number generators", 2014).
 */
#ifndef MUSTER_CORE_RANDOM_H
#define MUSTER_CORE_RANDOM_H

#include <stdint.h>

struct mu_random {
    uint64_t state;
};

/** Starts the stream that belongs to a seed and a name. */
void mu_random_seed(struct mu_random *r, uint64_t seed, const char *name);

/** @return 64 random bits */
uint64_t mu_random_next(struct mu_random *r);

/** @return a number in [0, 1) */
double mu_random_unit(struct mu_random *r);

/** @return a whole number in [lo, hi], both included; lo when hi < lo */
int64_t mu_random_between(struct mu_random *r, int64_t lo, int64_t hi);

#endif
