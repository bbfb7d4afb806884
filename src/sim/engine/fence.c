/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/engine/fence.h"

#include <math.h>

/* Farther out than any world reaches: what is there has been flung, not driven. */
#define FENCE_OPEN_M 1e7

/* What ends so near the side of a world stands at that side. */
#define FENCE_AT_SIDE_M 1e-3

static const struct fence fence_open = {-FENCE_OPEN_M, -FENCE_OPEN_M, FENCE_OPEN_M, FENCE_OPEN_M,
                                        false};

struct fence_span {
    double lo, hi;
};

static struct fence_span fence_span(const struct solid *solid, bool of_y)
{
    double extent[2];
    solid_extent(solid, &extent[0], &extent[1]);
    double middle = of_y ? solid->y : solid->x;
    return (struct fence_span){middle - extent[of_y], middle + extent[of_y]};
}

static bool fence_stops(const struct solid *solid)
{
    return (solid->returns & SOLID_STOPS) != 0;
}

static bool fence_stands_at(const struct solid *solid, const struct fence *box, int side)
{
    struct fence_span across = fence_span(solid, side >= 2);
    switch (side) {
    case 0: return across.lo - box->min_x <= FENCE_AT_SIDE_M;
    case 1: return box->max_x - across.hi <= FENCE_AT_SIDE_M;
    case 2: return across.lo - box->min_y <= FENCE_AT_SIDE_M;
    default: return box->max_y - across.hi <= FENCE_AT_SIDE_M;
    }
}

/* Whether what stands at a side of the box around everything covers it from end to end: up to
 * where is it closed, and who closes it farthest from there on? */
static bool fence_covers(const struct solid *still, size_t count, const struct fence *box, int side,
                         double gap_m)
{
    double end = side < 2 ? box->min_y : box->min_x;
    double goal = (side < 2 ? box->max_y : box->max_x) - gap_m;
    for (bool on = true; on && end < goal;) {
        double far = end;
        for (size_t k = 0; k < count; k++) {
            struct fence_span along = fence_span(&still[k], side < 2);
            if (fence_stops(&still[k]) && along.lo <= end + gap_m && along.hi > far &&
                fence_stands_at(&still[k], box, side)) {
                far = along.hi;
            }
        }
        on = far > end;
        end = far;
    }
    return end >= goal;
}

void fence_measure(struct fence *fence, const struct solid *still, size_t count, double gap_m)
{
    struct fence box = {INFINITY, INFINITY, -INFINITY, -INFINITY, false};
    for (size_t k = 0; k < count; k++) {
        if (!fence_stops(&still[k])) {
            continue;
        }
        box.closed = true;
        struct fence_span x = fence_span(&still[k], false);
        struct fence_span y = fence_span(&still[k], true);
        box.min_x = fmin(box.min_x, x.lo);
        box.max_x = fmax(box.max_x, x.hi);
        box.min_y = fmin(box.min_y, y.lo);
        box.max_y = fmax(box.max_y, y.hi);
    }
    for (int side = 0; side < 4; side++) {
        box.closed = box.closed && fence_covers(still, count, &box, side, gap_m);
    }
    *fence = box.closed ? box : fence_open;
}

void fence_include(struct fence *fence, double x, double y)
{
    if (!fence_holds(fence, x, y)) {
        *fence = fence_open;
    }
}

bool fence_holds(const struct fence *fence, double x, double y)
{
    return x >= fence->min_x && x <= fence->max_x && y >= fence->min_y && y <= fence->max_y;
}
