/* SPDX-License-Identifier: Apache-2.0 */
/* The motion of bodies: poses, forces, speed limits, and sleep. */
#include "sim/engine/engine_core.h"

/* A slower body is put to sleep. */
#define MOTION_REST_M_S   2e-4
#define MOTION_REST_RAD_S 1e-3

/* The largest turn of a body in a substep. */
#define MOTION_TURN_MAX_RAD (M_PI / 4)

/* Wheels drive at exactly the limit: rounding must not count as an excess. */
#define MOTION_LIMIT_SLACK 1.01

/* --- poses ------------------------------------------------------------------------------------ */

void motion_follow(struct engine *e, size_t body)
{
    bodies_follow(e, body);
    if (body < e->robot_count) {
        grip_carry(e, body);
    }
}

void motion_put(struct engine *e, size_t body, struct world_pose pose)
{
    struct engine_body *b = &e->bodies[body];
    ode_world_put(body, pose.x_m, pose.y_m, pose.heading_rad);
    b->push_substeps = 0;
    b->placed = true;
    if (body < e->robot_count) {
        drive_halt(&e->robots[body].drive);
    } else { /* the object may hang over an edge of its support now */
        ode_world_sleep(body, false);
        b->asleep = false;
    }
    motion_follow(e, body);
}

/* Limits the speed of a body: a push from outside can exceed that of any drive. */
static void motion_limit(struct engine *e, size_t body)
{
    const struct engine_body *b = &e->bodies[body];
    const struct ode_motion *m = &b->motion;
    double most = b->speed_max_m_s * MOTION_LIMIT_SLACK;
    double turn_most = MOTION_TURN_MAX_RAD / e->dt_s;
    double speed_2 = m->vx * m->vx + m->vy * m->vy;
    if (speed_2 <= most * most && fabs(m->turn) <= turn_most) {
        return;
    }
    double share = speed_2 > most * most ? most / sqrt(speed_2) : 1;
    double turn = fmax(-turn_most, fmin(m->turn, turn_most));
    ode_world_set_velocity(body, share * m->vx, share * m->vy, turn);
    motion_follow(e, body);
}

static bool motion_is_at_rest(const struct engine_body *b)
{
    const struct ode_motion *m = &b->motion;
    return !b->touched && b->push_substeps == 0 && fabs(m->vx) < MOTION_REST_M_S &&
           fabs(m->vy) < MOTION_REST_M_S && fabs(m->turn) < MOTION_REST_RAD_S;
}

static void motion_settle_object(struct engine *e, size_t object)
{
    size_t body = e->robot_count + object;
    struct engine_body *b = &e->bodies[body];
    if (b->asleep || bodies_is_held(e, body)) {
        return;
    }
    motion_follow(e, body);
    motion_limit(e, body);
    if (motion_is_at_rest(b)) {
        ode_world_set_velocity(body, 0, 0, 0);
        ode_world_sleep(body, true);
        b->asleep = true;
        motion_follow(e, body);
    }
}

void motion_settle(struct engine *e)
{
    for (size_t i = 0; i < e->robot_count; i++) {
        motion_follow(e, i);
        motion_limit(e, i);
    }
    for (size_t k = 0; k < e->object_count; k++) {
        motion_settle_object(e, k);
    }
}

/* --- forces ----------------------------------------------------------------------------------- */

static void motion_push(struct engine *e, size_t body)
{
    struct engine_body *b = &e->bodies[body];
    if (b->push_substeps > 0) {
        b->push_substeps--;
        ode_world_push(body, b->push.x_n, b->push.y_n, b->push.turn_nm);
    }
}

/*
 * Coulomb friction.  A sliding object is braked against its motion, with no force across it.  An
 * object that would stop within a substep is held in all directions, by at most the same force.
 */
void motion_set_friction(struct engine *e, size_t object)
{
    const struct engine_object *o = &e->objects[object];
    size_t body = e->robot_count + object;
    const struct ode_motion *m = &e->bodies[body].motion;
    double speed = sqrt(m->vx * m->vx + m->vy * m->vy);
    bool slides = speed * e->bodies[body].mass_kg > o->friction_n * e->dt_s;
    struct ode_friction f = {.along_x = speed > 0 ? m->vx / speed : 1,
                             .along_y = speed > 0 ? m->vy / speed : 0,
                             .along_n = o->friction_n,
                             .across_n = slides ? 0 : o->friction_n,
                             .turn_nm = o->friction_nm};
    ode_world_set_friction(body, &f);
}

void motion_load_forces(struct engine *e)
{
    for (size_t b = 0; b < e->body_count; b++) {
        motion_push(e, b);
    }
    for (size_t k = 0; k < e->object_count; k++) {
        if (!e->bodies[e->robot_count + k].asleep) {
            motion_set_friction(e, k);
        }
    }
}
