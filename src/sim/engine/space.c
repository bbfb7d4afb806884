/* SPDX-License-Identifier: Apache-2.0 */
/* Space: the grid over all parts, and tests for room. */
#include "sim/engine/engine_core.h"

void space_refresh(struct engine *e)
{
    if (e->grid_is_old) {
        grid_update(&e->grid);
        e->grid_is_old = false;
    }
}

static bool space_is_in(const struct solid *a, const struct solid *b, double tolerance_m)
{
    struct narrow_contact contact;
    narrow_collide(a, b, &contact);
    return narrow_depth(&contact) > tolerance_m;
}

const char *space_obstacle(struct engine *e, const struct solid *solid, size_t body,
                           double tolerance_m)
{
    space_refresh(e);
    grid_around(&e->grid, solid, &e->near);
    for (size_t k = 0; k < e->near.still_count; k++) {
        uint32_t still = e->near.still[k];
        if (e->stands[still].look->stops && space_is_in(solid, &e->shapes[still], tolerance_m)) {
            return "what stands there";
        }
    }
    for (size_t k = 0; k < e->near.moving_count; k++) {
        uint32_t moving = e->near.moving[k];
        const struct engine_part *part = &e->parts[moving];
        if (part->body != (int32_t)body && part->look->stops &&
            space_is_in(solid, &e->outlines[moving], tolerance_m)) {
            return e->bodies[part->body].name;
        }
    }
    return NULL;
}
