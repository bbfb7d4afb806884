/* SPDX-License-Identifier: Apache-2.0 */
/* The bodies of the engine: what they are made of, what pushes them, and what they touch. */
#include "muster/memory.h"
#include "sim/engine/engine_core.h"

#include <math.h>

/* What turns a thing on the floor lies this far from its middle: the mean of a disc's radius. */
#define ENGINE_RUB_AT (2.0 / 3.0)

/* Slower than this it comes to rest for good. */
#define ENGINE_REST_M_S   2e-4
#define ENGINE_REST_RAD_S 1e-3

/* No body may turn farther in a substep. */
#define ENGINE_TURN_MAX_RAD (M_PI / 4)

/* Wheels keep to the limit exactly, so rounding must not count as more. */
#define ENGINE_LIMIT_SLACK 1.01

/* --- what they are made of -------------------------------------------------------------------- */

static double engine_thinnest(const struct engine *e)
{
    double thinnest = INFINITY;
    for (size_t i = 0; i < e->world->shape_count; i++) {
        if (e->world->shapes[i].look.stops) {
            thinnest = fmin(thinnest, fmin(e->shapes[i].half_x, e->shapes[i].half_y));
        }
    }
    for (size_t k = 0; k < e->object_count; k++) {
        struct solid solid = solid_of_shape(&e->world->objects[k].shape);
        thinnest = fmin(thinnest, fmin(solid.half_x, solid.half_y));
    }
    return isfinite(thinnest) ? thinnest : 0;
}

/*
 * Half of the thinnest thing that a body could meet, and of itself, per substep: nothing is
 * jumped over.
 */
static double engine_speed_max(const struct engine *e, double half_m, double thinnest_m)
{
    return 0.5 * (half_m + thinnest_m) / e->dt_s;
}

size_t engine_object_part(const struct engine *e, size_t object)
{
    return e->robot_count + e->paddle_count + object;
}

struct gripper_frame engine_frame(const struct engine *e, size_t body)
{
    const struct ode_motion *m = &e->bodies[body].motion;
    return (struct gripper_frame){m->x, m->y, m->c, m->s};
}

static void engine_add_paddles(struct engine *e, size_t i)
{
    struct engine_robot *r = &e->robots[i];
    static const struct world_look look = {.stops = true};
    gripper_init(&r->gripper, &e->world->robots[i]);
    if (!r->gripper.make) {
        return;
    }
    r->paddles = e->robot_count + e->paddle_count;
    e->paddle_count += GRIPPER_PADDLES;
    for (size_t k = 0; k < GRIPPER_PADDLES; k++) {
        e->parts[r->paddles + k] = (struct engine_part){.body = (int32_t)i, .look = &look};
    }
}

static void engine_add_robot(struct engine *e, size_t i, double thinnest_m)
{
    const struct world_robot *robot = &e->world->robots[i];
    struct engine_robot *r = &e->robots[i];
    struct engine_body *b = &e->bodies[i];
    struct ode_body_size size = {.mass_kg = robot->mass_kg,
                                 .length_m = robot->length_m,
                                 .width_m = robot->width_m,
                                 .middle_x_m = robot->origin_x_m,
                                 .middle_y_m = robot->origin_y_m};
    *b = (struct engine_body){.name = robot->name,
                              .middle_x_m = robot->origin_x_m,
                              .middle_y_m = robot->origin_y_m,
                              .mass_kg = robot->mass_kg};
    b->inertia_kg_m2 = ode_world_add(&size, robot->pose);
    b->speed_max_m_s = engine_speed_max(e, fmin(robot->length_m, robot->width_m) / 2, thinnest_m);
    e->outlines[i] = solid_box(robot->pose, robot->length_m / 2, robot->width_m / 2);
    e->outlines[i].owner = (int32_t)i;
    solid_look(&e->outlines[i], &robot->look);
    e->parts[i] = (struct engine_part){.body = (int32_t)i, .is_case = true, .look = &robot->look};
    drive_init(&r->drive, robot, b->inertia_kg_m2, b->speed_max_m_s);
    engine_add_paddles(e, i);
}

static void engine_add_object(struct engine *e, size_t k, double thinnest_m)
{
    const struct world_object *object = &e->world->objects[k];
    size_t body = e->robot_count + k;
    size_t part = engine_object_part(e, k);
    struct engine_body *b = &e->bodies[body];
    struct solid solid = solid_of_shape(&object->shape);
    struct ode_body_size size = {.mass_kg = object->mass_kg,
                                 .length_m = 2 * solid.half_x,
                                 .width_m = 2 * solid.half_y,
                                 .disc = solid.kind == WORLD_DISC};
    *b = (struct engine_body){.name = object->name, .mass_kg = object->mass_kg};
    b->inertia_kg_m2 = ode_world_add(&size, object->shape.pose);
    b->speed_max_m_s = engine_speed_max(e, fmin(solid.half_x, solid.half_y), thinnest_m);
    ode_world_lay(body);
    double area = size.disc ? M_PI * solid.half_x * solid.half_x : 4 * solid.half_x * solid.half_y;
    double friction = object->friction * object->mass_kg * DRIVE_GRAVITY_M_S2;
    e->objects[k] =
        (struct engine_object){.friction_n = friction,
                               .friction_nm = friction * ENGINE_RUB_AT * sqrt(area / M_PI),
                               .bearer = ENGINE_NO_BEARER};
    solid.owner = (int32_t)body;
    e->outlines[part] = solid;
    e->parts[part] = (struct engine_part){.body = (int32_t)body, .look = &object->shape.look};
}

void engine_add_bodies(struct engine *e)
{
    double thinnest_m = engine_thinnest(e);
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_add_robot(e, i, thinnest_m);
    }
    for (size_t k = 0; k < e->object_count; k++) {
        engine_add_object(e, k, thinnest_m);
    }
    for (size_t b = 0; b < e->body_count; b++) {
        engine_follow(e, b);
        e->bodies[b].last_good = e->bodies[b].motion;
    }
}

/* --- where they are --------------------------------------------------------------------------- */

void engine_follow(struct engine *e, size_t body)
{
    struct engine_body *b = &e->bodies[body];
    ode_world_motion(body, &b->motion);
    const struct ode_motion *m = &b->motion;
    bool is_robot = body < e->robot_count;
    struct solid *outline =
        &e->outlines[is_robot ? body : engine_object_part(e, body - e->robot_count)];
    outline->x = m->x + m->c * b->middle_x_m - m->s * b->middle_y_m;
    outline->y = m->y + m->s * b->middle_x_m + m->c * b->middle_y_m;
    outline->c = m->c;
    outline->s = m->s;
    if (is_robot) {
        engine_carry(e, body);
    }
}

void engine_put(struct engine *e, size_t body, struct world_pose pose)
{
    struct engine_body *b = &e->bodies[body];
    ode_world_put(body, pose.x_m, pose.y_m, pose.heading_rad);
    b->push_substeps = 0;
    b->placed = true;
    if (body < e->robot_count) {
        drive_halt(&e->robots[body].drive);
    } else { /* it may hang over the edge of something now */
        ode_world_sleep(body, false);
        b->asleep = false;
    }
    engine_follow(e, body);
}

/* A push from outside can make a body faster than anything drives. */
static void engine_limit(struct engine *e, size_t body)
{
    const struct engine_body *b = &e->bodies[body];
    const struct ode_motion *m = &b->motion;
    double most = b->speed_max_m_s * ENGINE_LIMIT_SLACK;
    double turn_most = ENGINE_TURN_MAX_RAD / e->dt_s;
    double speed_2 = m->vx * m->vx + m->vy * m->vy;
    if (speed_2 <= most * most && fabs(m->turn) <= turn_most) {
        return;
    }
    double share = speed_2 > most * most ? most / sqrt(speed_2) : 1;
    double turn = fmax(-turn_most, fmin(m->turn, turn_most));
    ode_world_set_velocity(body, share * m->vx, share * m->vy, turn);
    engine_follow(e, body);
}

static bool engine_is_at_rest(const struct engine_body *b)
{
    const struct ode_motion *m = &b->motion;
    return !b->touched && b->push_substeps == 0 && fabs(m->vx) < ENGINE_REST_M_S &&
           fabs(m->vy) < ENGINE_REST_M_S && fabs(m->turn) < ENGINE_REST_RAD_S;
}

static void engine_settle_object(struct engine *e, size_t object)
{
    size_t body = e->robot_count + object;
    struct engine_body *b = &e->bodies[body];
    if (b->asleep || engine_is_held(e, body)) {
        return;
    }
    engine_follow(e, body);
    engine_limit(e, body);
    if (engine_is_at_rest(b)) {
        ode_world_set_velocity(body, 0, 0, 0);
        ode_world_sleep(body, true);
        b->asleep = true;
        engine_follow(e, body);
    }
}

void engine_settle(struct engine *e)
{
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_follow(e, i);
        engine_limit(e, i);
    }
    for (size_t k = 0; k < e->object_count; k++) {
        engine_settle_object(e, k);
    }
}

/* --- what pushes them ------------------------------------------------------------------------- */

static void engine_shove(struct engine *e, size_t body)
{
    struct engine_body *b = &e->bodies[body];
    if (b->push_substeps > 0) {
        b->push_substeps--;
        ode_world_push(body, b->push.x_n, b->push.y_n, b->push.turn_nm);
    }
}

/*
 * Coulomb's friction.  What slides is braked against its motion, and nothing holds it across;
 * what would stand within a substep is held in all directions, up to the same force.
 */
static void engine_rub(struct engine *e, size_t object)
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
    ode_world_rub(body, &f);
}

void engine_load_forces(struct engine *e)
{
    for (size_t b = 0; b < e->body_count; b++) {
        engine_shove(e, b);
    }
    for (size_t k = 0; k < e->object_count; k++) {
        if (!e->bodies[e->robot_count + k].asleep) {
            engine_rub(e, k);
        }
    }
}

/* --- what they touch -------------------------------------------------------------------------- */

/* What moves wakes what it touches, and keeps it awake. */
static void engine_wake(struct engine *e, int32_t body, int32_t by)
{
    if (body == ODE_WORLD_STANDS || by == ODE_WORLD_STANDS) {
        return;
    }
    struct engine_body *b = &e->bodies[body];
    b->touched = true;
    if (b->asleep) {
        ode_world_sleep((size_t)body, false);
        b->asleep = false;
        engine_rub(e, (size_t)body - e->robot_count); /* only objects sleep */
    }
}

/* The bumper's eighths, counted from ahead to the left. */
static void engine_bump_at(struct engine *e, int32_t robot, double x, double y)
{
    const struct ode_motion *m = &e->bodies[robot].motion;
    double dx = x - m->x;
    double dy = y - m->y;
    double bearing = atan2(m->c * dy - m->s * dx, m->c * dx + m->s * dy);
    int sector = (int)floor(bearing * ENGINE_BUMPERS / (2 * M_PI) + 0.5);
    e->robots[robot].bumpers |= 1u << ((sector + ENGINE_BUMPERS) % ENGINE_BUMPERS);
}

/* Two points are the ends of a side that is touched all along. */
static void engine_bump(struct engine *e, const struct engine_part *part,
                        const struct narrow_contact *c)
{
    if (!part->is_case) {
        return;
    }
    for (size_t i = 0; i < c->count; i++) {
        engine_bump_at(e, part->body, c->points[i].x, c->points[i].y);
    }
    if (c->count == 2) {
        engine_bump_at(e, part->body, (c->points[0].x + c->points[1].x) / 2,
                       (c->points[0].y + c->points[1].y) / 2);
    }
}

static void engine_plug(struct engine *e, const struct engine_part *part, double give_w)
{
    if (part->is_case) {
        struct engine_robot *r = &e->robots[part->body];
        r->charge_w = fmax(r->charge_w, give_w);
    }
}

static void engine_touch(struct engine *e, const struct engine_pair *pair)
{
    const struct engine_part *a = &e->parts[pair->part];
    const struct engine_part *b = pair->stands ? &e->stands[pair->other] : &e->parts[pair->other];
    const struct solid *other = pair->stands ? &e->shapes[pair->other] : &e->outlines[pair->other];
    if (!engine_is_near(e, pair->part, other)) {
        return;
    }
    bool stop = a->look->stops && b->look->stops;
    struct narrow_contact contact;
    if (stop) {
        engine_note_near(e, pair);
    }
    narrow_collide(&e->outlines[pair->part], other, &contact);
    if (contact.count == 0) {
        return;
    }
    engine_plug(e, a, b->look->give_w);
    engine_plug(e, b, a->look->give_w);
    if (!stop) {
        return;
    }
    ode_world_touch((size_t)a->body, b->body, &contact);
    engine_bump(e, a, &contact);
    engine_bump(e, b, &contact);
    engine_wake(e, a->body, b->body);
    engine_wake(e, b->body, a->body);
}

static bool engine_may_meet(const struct engine *e, const struct engine_pair *pair)
{
    int32_t own = e->parts[pair->part].body;
    if (pair->stands) {
        return !e->bodies[own].asleep;
    }
    int32_t other = e->parts[pair->other].body;
    return other != own && !e->outlines[pair->other].away &&
           !(e->bodies[own].asleep && e->bodies[other].asleep);
}

/* The order of the contacts is part of the result: by part, then as the neighbours are listed. */
static void engine_collide_part(struct engine *e, uint32_t i)
{
    bool sleeps = e->bodies[e->parts[i].body].asleep;
    if (e->outlines[i].away || (sleeps && i >= e->awake_end)) {
        return;
    }
    size_t count;
    const struct engine_pair *pairs = engine_neighbours_of(e, i, &count);
    for (size_t k = 0; k < count; k++) {
        if (engine_may_meet(e, &pairs[k])) {
            engine_touch(e, &pairs[k]);
        }
    }
}

void engine_collide(struct engine *e)
{
    e->awake_end = 0;
    e->pair_count = 0;
    for (size_t k = 0; k < e->object_count; k++) {
        struct engine_body *b = &e->bodies[e->robot_count + k];
        b->touched = false;
        e->awake_end = b->asleep ? e->awake_end : engine_object_part(e, k) + 1;
    }
    for (size_t i = 0; i < e->robot_count; i++) {
        e->robots[i].charge_w = 0;
    }
    engine_watch_neighbours(e);
    for (uint32_t i = 0; i < e->part_count; i++) {
        engine_collide_part(e, i);
    }
}

static bool engine_is_in(const struct solid *a, const struct solid *b, double tolerance_m)
{
    struct narrow_contact contact;
    double deepest = 0;
    narrow_collide(a, b, &contact);
    for (size_t i = 0; i < contact.count; i++) {
        deepest = fmax(deepest, contact.points[i].depth);
    }
    return contact.count > 0 && deepest > tolerance_m;
}

const char *engine_obstacle(struct engine *e, const struct solid *solid, size_t body,
                            double tolerance_m)
{
    engine_fresh_grid(e);
    grid_around(&e->grid, solid, &e->near);
    for (size_t k = 0; k < e->near.still_count; k++) {
        uint32_t still = e->near.still[k];
        if (e->stands[still].look->stops && engine_is_in(solid, &e->shapes[still], tolerance_m)) {
            return "what stands there";
        }
    }
    for (size_t k = 0; k < e->near.moving_count; k++) {
        uint32_t moving = e->near.moving[k];
        const struct engine_part *part = &e->parts[moving];
        if (part->body != (int32_t)body && part->look->stops &&
            engine_is_in(solid, &e->outlines[moving], tolerance_m)) {
            return e->bodies[part->body].name;
        }
    }
    return NULL;
}
