/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file bounds.h
 * How far a body of a world can get.
 */
#ifndef MUSTER_SIM_BOUNDS_H
#define MUSTER_SIM_BOUNDS_H

#include "sim/geometry/solid.h"

struct bounds {
    double min_x, min_y, max_x, max_y;
    bool closed; /* what stands leaves no way out */
};

/**
 * Measures it: the box around what stands and stops bodies, if that closes each side but for gaps
 * of gap_m, else so far out that only what was flung gets there.
 */
void bounds_measure(struct bounds *bounds, const struct solid *still, size_t count, double gap_m);

/** Opens it if a place where something starts lies outside. */
void bounds_include(struct bounds *bounds, double x, double y);

/** @return whether a place is finite and inside */
bool bounds_holds(const struct bounds *bounds, double x, double y);

#endif
