/* SPDX-License-Identifier: Apache-2.0 */
/* Detects and resets bodies with a broken state, so that they do not break the run. */
#include "core/log.h"
#include "sim/engine/engine_core.h"

static bool sanity_is_sound(const struct engine *e, const struct ode_motion *m)
{
    double sum = m->x + m->y + m->c + m->s + m->vx + m->vy + m->turn;
    return isfinite(sum) && bounds_holds(&e->bounds, m->x, m->y);
}

static void sanity_put_back(struct engine *e, size_t body)
{
    struct engine_body *b = &e->bodies[body];
    const struct ode_motion *good = &b->last_good;
    struct world_pose pose = {good->x, good->y, atan2(good->s, good->c)};
    b->fault = true;
    b->faults++;
    if ((b->faults & (b->faults - 1)) == 0) { /* the first, second, fourth, ... time */
        mu_log(MU_LOG_WARNING, "flung-out", "name=%s times=%llu put-back-to=%.3f,%.3f", b->name,
               (unsigned long long)b->faults, pose.x_m, pose.y_m);
    }
    motion_put(e, body, pose);
    e->grid_is_old = true;
}

void sanity_check(struct engine *e)
{
    for (size_t b = 0; b < e->body_count; b++) {
        struct engine_body *body = &e->bodies[b];
        body->fault = false;
        if (bodies_is_held(e, b) || sanity_is_sound(e, &body->motion)) {
            body->last_good = body->motion; /* a held body moves with the robot that holds it */
        } else {
            sanity_put_back(e, b);
        }
    }
}
