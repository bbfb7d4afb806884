/* SPDX-License-Identifier: Apache-2.0 */
/* The bodies of the engine: their shapes and masses, and their present poses. */
#include "sim/engine/engine_core.h"

/* Friction against a turn acts at this share of the radius: the mean over a disc. */
#define BODIES_FRICTION_AT (2.0 / 3.0)

/* --- shapes and masses ------------------------------------------------------------------------ */

static double bodies_thinnest(const struct engine *e)
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
 * @return the speed limit of a body.  In a substep it moves at most half of its own half width plus
 *         half of the thinnest thing, so that it jumps over nothing
 */
static double bodies_speed_max(const struct engine *e, double half_m, double thinnest_m)
{
    return 0.5 * (half_m + thinnest_m) / e->dt_s;
}

size_t bodies_object_part(const struct engine *e, size_t object)
{
    return e->robot_count + e->paddle_count + object;
}

struct frame bodies_frame(const struct engine *e, size_t body)
{
    const struct ode_motion *m = &e->bodies[body].motion;
    return (struct frame){m->x, m->y, m->c, m->s};
}

static void bodies_add_paddles(struct engine *e, size_t i)
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

static void bodies_add_robot(struct engine *e, size_t i, double thinnest_m)
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
    b->speed_max_m_s = bodies_speed_max(e, fmin(robot->length_m, robot->width_m) / 2, thinnest_m);
    e->outlines[i] = solid_box(robot->pose, robot->length_m / 2, robot->width_m / 2);
    e->outlines[i].owner = (int32_t)i;
    solid_look(&e->outlines[i], &robot->look);
    e->parts[i] = (struct engine_part){.body = (int32_t)i, .is_case = true, .look = &robot->look};
    drive_init(&r->drive, robot, b->inertia_kg_m2, b->speed_max_m_s);
    bodies_add_paddles(e, i);
}

static void bodies_add_object(struct engine *e, size_t k, double thinnest_m)
{
    const struct world_object *object = &e->world->objects[k];
    size_t body = e->robot_count + k;
    size_t part = bodies_object_part(e, k);
    struct engine_body *b = &e->bodies[body];
    struct solid solid = solid_of_shape(&object->shape);
    struct ode_body_size size = {.mass_kg = object->mass_kg,
                                 .length_m = 2 * solid.half_x,
                                 .width_m = 2 * solid.half_y,
                                 .disc = solid.kind == WORLD_DISC};
    *b = (struct engine_body){.name = object->name, .mass_kg = object->mass_kg};
    b->inertia_kg_m2 = ode_world_add(&size, object->shape.pose);
    b->speed_max_m_s = bodies_speed_max(e, fmin(solid.half_x, solid.half_y), thinnest_m);
    ode_world_add_friction(body);
    double area = size.disc ? M_PI * solid.half_x * solid.half_x : 4 * solid.half_x * solid.half_y;
    double friction = object->friction * object->mass_kg * DRIVE_GRAVITY_M_S2;
    e->objects[k] =
        (struct engine_object){.friction_n = friction,
                               .friction_nm = friction * BODIES_FRICTION_AT * sqrt(area / M_PI),
                               .bearer = ENGINE_NO_BEARER};
    solid.owner = (int32_t)body;
    e->outlines[part] = solid;
    e->parts[part] = (struct engine_part){.body = (int32_t)body, .look = &object->shape.look};
}

void bodies_add(struct engine *e)
{
    double thinnest_m = bodies_thinnest(e);
    for (size_t i = 0; i < e->robot_count; i++) {
        bodies_add_robot(e, i, thinnest_m);
    }
    for (size_t k = 0; k < e->object_count; k++) {
        bodies_add_object(e, k, thinnest_m);
    }
}

void bodies_start_devices(struct engine *e, size_t robot)
{
    const struct world_robot *make = &e->world->robots[robot];
    struct engine_robot *r = &e->robots[robot];
    double none = 0;
    double step_s = e->dt_s * e->substeps_per_step;
    drive_halt(&r->drive);
    drive_aim(&r->drive, &none, &none);
    odometer_init(&r->odometer, make, e->seed, (uint32_t)robot);
    gps_init(&r->gps, make, step_s);
    battery_init(&r->battery, make);
    gripper_init(&r->gripper, make);
    r->bumpers = 0;
}

/* --- poses ------------------------------------------------------------------------------------ */

void bodies_follow(struct engine *e, size_t body)
{
    struct engine_body *b = &e->bodies[body];
    ode_world_motion(body, &b->motion);
    const struct ode_motion *m = &b->motion;
    bool is_robot = body < e->robot_count;
    struct solid *outline =
        &e->outlines[is_robot ? body : bodies_object_part(e, body - e->robot_count)];
    outline->x = m->x + m->c * b->middle_x_m - m->s * b->middle_y_m;
    outline->y = m->y + m->s * b->middle_x_m + m->c * b->middle_y_m;
    outline->c = m->c;
    outline->s = m->s;
}

bool bodies_is_held(const struct engine *e, size_t body)
{
    return body >= e->robot_count && e->objects[body - e->robot_count].bearer != ENGINE_NO_BEARER;
}
