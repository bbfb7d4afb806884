/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/engine/engine_core.h"

/* Farther out than any world reaches: a body gets there only by a fault of the physics. */
#define BOUNDS_OPEN_M 1e7

/* A solid that ends so near to a side of the box stands at that side. */
#define BOUNDS_AT_SIDE_M 1e-3

static const struct bounds bounds_open = {-BOUNDS_OPEN_M, -BOUNDS_OPEN_M, BOUNDS_OPEN_M,
                                          BOUNDS_OPEN_M, false};

struct bounds_span {
    double lo, hi;
};

static struct bounds_span bounds_span(const struct solid *solid, bool of_y)
{
    double extent[2];
    solid_extent(solid, &extent[0], &extent[1]);
    double middle = of_y ? solid->y : solid->x;
    return (struct bounds_span){middle - extent[of_y], middle + extent[of_y]};
}

static bool bounds_stops(const struct solid *solid)
{
    return (solid->returns & SOLID_STOPS) != 0;
}

static bool bounds_stands_at(const struct solid *solid, const struct bounds *box, int side)
{
    struct bounds_span across = bounds_span(solid, side >= 2);
    switch (side) {
    case 0: return across.lo - box->min_x <= BOUNDS_AT_SIDE_M;
    case 1: return box->max_x - across.hi <= BOUNDS_AT_SIDE_M;
    case 2: return across.lo - box->min_y <= BOUNDS_AT_SIDE_M;
    default: return box->max_y - across.hi <= BOUNDS_AT_SIDE_M;
    }
}

/*
 * @return whether the standing solids cover a side of the box from end to end, but for gaps of
 *         gap_m.  Each round extends the covered stretch as far as one solid reaches.
 */
static bool bounds_covers(const struct solid *still, size_t count, const struct bounds *box,
                          int side, double gap_m)
{
    double end = side < 2 ? box->min_y : box->min_x;
    double goal = (side < 2 ? box->max_y : box->max_x) - gap_m;
    for (bool on = true; on && end < goal;) {
        double far = end;
        for (size_t k = 0; k < count; k++) {
            struct bounds_span along = bounds_span(&still[k], side < 2);
            if (bounds_stops(&still[k]) && along.lo <= end + gap_m && along.hi > far &&
                bounds_stands_at(&still[k], box, side)) {
                far = along.hi;
            }
        }
        on = far > end;
        end = far;
    }
    return end >= goal;
}

void bounds_measure(struct bounds *bounds, const struct solid *still, size_t count, double gap_m)
{
    struct bounds box = {INFINITY, INFINITY, -INFINITY, -INFINITY, false};
    for (size_t k = 0; k < count; k++) {
        if (!bounds_stops(&still[k])) {
            continue;
        }
        box.closed = true;
        struct bounds_span x = bounds_span(&still[k], false);
        struct bounds_span y = bounds_span(&still[k], true);
        box.min_x = fmin(box.min_x, x.lo);
        box.max_x = fmax(box.max_x, x.hi);
        box.min_y = fmin(box.min_y, y.lo);
        box.max_y = fmax(box.max_y, y.hi);
    }
    for (int side = 0; side < 4; side++) {
        box.closed = box.closed && bounds_covers(still, count, &box, side, gap_m);
    }
    *bounds = box.closed ? box : bounds_open;
}

void bounds_include(struct bounds *bounds, double x, double y)
{
    if (!bounds_holds(bounds, x, y)) {
        *bounds = bounds_open;
    }
}

bool bounds_holds(const struct bounds *bounds, double x, double y)
{
    return x >= bounds->min_x && x <= bounds->max_x && y >= bounds->min_y && y <= bounds->max_y;
}
