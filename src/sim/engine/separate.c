/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Separates bodies that overlap deeply.
 *
 * The solver works on velocities, with a limited number of rounds.  In a heap of hundreds of bodies
 * these rounds do not carry a push from one end to the other, and overlaps grow in each substep.
 * So this file moves bodies themselves where overlaps exceed those of the solver's contacts: a few
 * sweeps over all pairs, forward and back.  Positions persist between substeps, so that few sweeps
 * suffice.
 */
#include "sim/engine/engine_core.h"

/* Less depth is left to the solver. */
#define SEPARATE_DEEP_M 0.005

/* The depth after separation: the bodies still touch. */
#define SEPARATE_LEFT_M 0.004

enum { SEPARATE_SWEEPS = 32 };

static double separate_lightness(const struct engine *e, int32_t body)
{
    return body == ODE_WORLD_STANDS ? 0 : 1 / e->bodies[body].mass_kg;
}

static void separate_shift_part(struct engine *e, size_t part, double x, double y)
{
    e->outlines[part].x += x;
    e->outlines[part].y += y;
}

/* Moves a body with all its parts.  ODE gets the new position at the end. */
static void separate_shift(struct engine *e, int32_t body, double x, double y)
{
    if (body == ODE_WORLD_STANDS) {
        return;
    }
    size_t b = (size_t)body;
    e->bodies[b].shifted = true;
    e->bodies[b].motion.x += x;
    e->bodies[b].motion.y += y;
    if (b >= e->robot_count) {
        separate_shift_part(e, bodies_object_part(e, b - e->robot_count), x, y);
        return;
    }
    const struct engine_robot *r = &e->robots[b];
    separate_shift_part(e, b, x, y);
    for (size_t k = 0; r->gripper.make && k < GRIPPER_PADDLES; k++) {
        separate_shift_part(e, r->paddles + k, x, y);
    }
    if (r->gripper.holds != GRIPPER_NOTHING) {
        separate_shift_part(e, bodies_object_part(e, (size_t)r->gripper.holds), x, y);
    }
}

/* @return whether the pair overlapped deeply */
static bool separate_pair(struct engine *e, const struct engine_pair *pair)
{
    const struct solid *other = pair->stands ? &e->shapes[pair->other] : &e->outlines[pair->other];
    int32_t a = e->parts[pair->part].body;
    int32_t b = pair->stands ? ODE_WORLD_STANDS : e->parts[pair->other].body;
    struct narrow_contact contact;
    narrow_collide(&e->outlines[pair->part], other, &contact);
    double depth = narrow_depth(&contact);
    if (depth <= SEPARATE_DEEP_M) {
        return false;
    }
    double light_a = separate_lightness(e, a);
    double light_b = separate_lightness(e, b);
    double per = (depth - SEPARATE_LEFT_M) / (light_a + light_b);
    double way_a = per * light_a;
    double way_b = per * light_b;
    separate_shift(e, a, way_a * contact.normal_x, way_a * contact.normal_y);
    separate_shift(e, b, -way_b * contact.normal_x, -way_b * contact.normal_y);
    return true;
}

void separate_all(struct engine *e)
{
    bool deep = true;
    for (int sweep = 0; deep && sweep < SEPARATE_SWEEPS; sweep++) {
        deep = false;
        for (size_t k = 0; k < e->pair_count; k++) {
            size_t turn = sweep % 2 ? e->pair_count - 1 - k : k;
            deep = separate_pair(e, &e->pairs[turn]) || deep;
        }
    }
    for (size_t b = 0; b < e->body_count; b++) {
        struct engine_body *body = &e->bodies[b];
        if (body->shifted) {
            ode_world_shift(b, body->motion.x, body->motion.y);
            body->shifted = false;
            motion_follow(e, b);
        }
    }
}
