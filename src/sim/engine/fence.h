/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fence.h
 * How far a body of a world can get.
 */
#ifndef MUSTER_SIM_FENCE_H
#define MUSTER_SIM_FENCE_H

#include "sim/geometry/solid.h"

struct fence {
    double min_x, min_y, max_x, max_y;
    bool closed; /* what stands leaves no way out */
};

/**
 * Measures it: the box around what stands and stops bodies, if that closes each side but for gaps
 * of gap_m, else so far out that only what was flung gets there.
 */
void fence_measure(struct fence *fence, const struct solid *still, size_t count, double gap_m);

/** Opens it if a place where something starts lies outside. */
void fence_include(struct fence *fence, double x, double y);

/** @return whether a place is finite and inside */
bool fence_holds(const struct fence *fence, double x, double y);

#endif
