/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file narrow.h
 * Where two solids touch, and how deep.
 */
#ifndef MUSTER_SIM_NARROW_H
#define MUSTER_SIM_NARROW_H

#include "sim/geometry/solid.h"

enum { NARROW_POINTS_MAX = 2 };

struct narrow_contact {
    double normal_x, normal_y; /* from the second solid to the first, length 1 */
    size_t count;              /* 0: they do not touch */
    struct {
        double x, y, depth;
    } points[NARROW_POINTS_MAX];
};

/** Finds the contact of any two solids. */
void narrow_collide(const struct solid *a, const struct solid *b, struct narrow_contact *contact);

#endif
