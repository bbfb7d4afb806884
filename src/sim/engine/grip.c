/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Grippers: taking, carrying and releasing objects.
 *
 * A held object moves with the robot as one body.  It is a part of the robot and adds to the
 * robot's mass, and the floor no longer carries it.
 */
#include "sim/engine/engine_core.h"

/* Contacts are this deep at rest; only deeper overlap is in the way. */
#define GRIP_TOUCH_M 0.002

static struct engine_object *grip_held(const struct engine *e, size_t robot)
{
    int32_t held = e->robots[robot].gripper.holds;
    return held == GRIPPER_NOTHING ? NULL : &e->objects[held];
}

/* Sets the mass of a robot and of its load, whose middle is beside the robot's own. */
static void grip_weigh(struct engine *e, size_t robot)
{
    const struct engine_body *b = &e->bodies[robot];
    const struct engine_object *held = grip_held(e, robot);
    double mass = b->mass_kg;
    double inertia = b->inertia_kg_m2;
    if (held) {
        const struct engine_body *load = &e->bodies[e->robot_count + (size_t)(held - e->objects)];
        mass += load->mass_kg;
        inertia += load->inertia_kg_m2 + load->mass_kg * (held->x * held->x + held->y * held->y);
    }
    ode_world_weigh(robot, mass, inertia);
    drive_load(&e->robots[robot].drive, mass, inertia);
}

/* --- carrying --------------------------------------------------------------------------------- */

/*
 * Assigns an object to a body: its own body, or the robot that holds it.  A robot's sensors do not
 * see the parts of the robot.
 */
static void grip_assign(struct engine *e, size_t object, size_t body)
{
    e->parts[bodies_object_part(e, object)].body = (int32_t)body;
    e->outlines[bodies_object_part(e, object)].owner = (int32_t)body;
}

static void grip_carry_object(struct engine *e, size_t robot, size_t object)
{
    const struct engine_object *o = &e->objects[object];
    const struct ode_motion *m = &e->bodies[robot].motion;
    size_t body = e->robot_count + object;
    double x = m->c * o->x - m->s * o->y;
    double y = m->s * o->x + m->c * o->y;
    double heading = atan2(m->s * o->c + m->c * o->s, m->c * o->c - m->s * o->s);
    ode_world_put(body, m->x + x, m->y + y, heading);
    ode_world_set_velocity(body, m->vx - m->turn * y, m->vy + m->turn * x, m->turn);
    bodies_follow(e, body);
    e->outlines[bodies_object_part(e, object)].away = gripper_is_up(&e->robots[robot].gripper);
}

void grip_carry(struct engine *e, size_t robot)
{
    const struct engine_robot *r = &e->robots[robot];
    if (!r->gripper.make) {
        return;
    }
    struct frame frame = bodies_frame(e, robot);
    for (int k = 0; k < GRIPPER_PADDLES; k++) {
        e->outlines[r->paddles + (size_t)k] =
            gripper_paddle(&r->gripper, &frame, k, r->gripper.closed);
    }
    if (r->gripper.holds != GRIPPER_NOTHING) {
        grip_carry_object(e, robot, (size_t)r->gripper.holds);
    }
}

/* --- taking and releasing --------------------------------------------------------------------- */

/* Makes an object a part of a robot. */
static void grip_bind(struct engine *e, size_t robot, size_t object)
{
    size_t body = e->robot_count + object;
    e->objects[object].bearer = (int32_t)robot;
    grip_assign(e, object, robot);
    e->bodies[body].asleep = true;
    e->bodies[body].push_substeps = 0;
    ode_world_sleep(body, true);
    e->robots[robot].gripper.holds = (int32_t)object;
    grip_weigh(e, robot);
}

static void grip_take(struct engine *e, size_t robot, size_t object)
{
    struct engine_object *o = &e->objects[object];
    const struct ode_motion *m = &e->bodies[robot].motion;
    const struct ode_motion *own = &e->bodies[e->robot_count + object].motion;
    double x = own->x - m->x;
    double y = own->y - m->y;
    o->x = m->c * x + m->s * y;
    o->y = m->c * y - m->s * x;
    o->c = m->c * own->c + m->s * own->s;
    o->s = m->c * own->s - m->s * own->c;
    grip_bind(e, robot, object);
}

void grip_resume(struct engine *e, size_t robot)
{
    int32_t holds = e->robots[robot].gripper.holds;
    if (holds == GRIPPER_NOTHING) {
        grip_weigh(e, robot);
    } else {
        grip_bind(e, robot, (size_t)holds);
    }
}

void grip_let_go(struct engine *e, size_t robot)
{
    struct engine_object *o = grip_held(e, robot);
    if (!o) {
        return;
    }
    size_t object = (size_t)(o - e->objects);
    size_t body = e->robot_count + object;
    o->bearer = ENGINE_NO_BEARER;
    grip_assign(e, object, body);
    e->outlines[bodies_object_part(e, object)].away = false;
    e->bodies[body].asleep = false;
    ode_world_sleep(body, false);
    e->robots[robot].gripper.holds = GRIPPER_NOTHING;
    grip_weigh(e, robot);
}

void grip_take_back(struct engine *e, size_t robot, size_t object)
{
    grip_bind(e, robot, object);
    grip_carry(e, robot);
}

/* @return whether a lifted object has room to be let down here */
static bool grip_has_room(struct engine *e, size_t robot)
{
    const struct engine_object *held = grip_held(e, robot);
    if (!held || !gripper_is_up(&e->robots[robot].gripper)) {
        return true; /* an object that is down has room already */
    }
    size_t part = bodies_object_part(e, (size_t)(held - e->objects));
    return !e->parts[part].look->stops ||
           !space_obstacle(e, &e->outlines[part], robot, GRIP_TOUCH_M);
}

/* @return whether the paddles have room at the pose that belongs to `closed` */
static bool grip_paddles_fit(struct engine *e, size_t robot, double closed)
{
    struct frame frame = bodies_frame(e, robot);
    bool fit = true;
    for (int k = 0; fit && k < GRIPPER_PADDLES; k++) {
        struct solid paddle = gripper_paddle(&e->robots[robot].gripper, &frame, k, closed);
        fit = !space_obstacle(e, &paddle, robot, GRIP_TOUCH_M);
    }
    return fit;
}

static bool grip_is_takeable(const struct engine *e, size_t robot, uint32_t part, double closed)
{
    const struct gripper *g = &e->robots[robot].gripper;
    const struct solid *solid = &e->outlines[part];
    struct frame frame = bodies_frame(e, robot);
    bool touches = false;
    for (int k = 0; k < GRIPPER_PADDLES; k++) {
        struct solid paddle = gripper_paddle(g, &frame, k, closed);
        struct narrow_contact contact;
        narrow_collide(&paddle, solid, &contact);
        touches = touches || contact.count > 0;
    }
    return touches && gripper_spans(g, &frame, (double[]){solid->x, solid->y}, closed);
}

/*
 * Finds a free object between the paddles that is graspable and that a paddle touches.  @return
 * false: there is none
 */
static bool grip_find_object(struct engine *e, size_t robot, double closed, size_t *object)
{
    size_t first = bodies_object_part(e, 0);
    space_refresh(e);
    grid_around(&e->grid, &e->outlines[e->robots[robot].paddles], &e->near);
    for (size_t k = 0; k < e->near.moving_count; k++) {
        uint32_t part = e->near.moving[k];
        if (part >= first && e->parts[part].look->graspable &&
            e->objects[part - first].bearer == ENGINE_NO_BEARER &&
            grip_is_takeable(e, robot, part, closed)) {
            *object = part - first;
            return true;
        }
    }
    return false;
}

/* --- movement --------------------------------------------------------------------------------- */

static void grip_move_lift(struct engine *e, size_t robot)
{
    struct gripper *g = &e->robots[robot].gripper;
    bool leaves_the_top =
        gripper_is_up(g) && !g->lifts; /* from here on the paddles can touch others */
    if (leaves_the_top && !(grip_has_room(e, robot) && grip_paddles_fit(e, robot, g->closed))) {
        return;
    }
    g->lifted = gripper_next_lifted(g, e->dt_s);
}

static void grip_move_paddles(struct engine *e, size_t robot)
{
    struct gripper *g = &e->robots[robot].gripper;
    double next = gripper_next_closed(g, e->dt_s);
    size_t object;
    if (!g->closes && g->holds != GRIPPER_NOTHING) {
        if (!grip_has_room(e, robot)) {
            return;
        }
        grip_let_go(e, robot);
    }
    if (g->closes && !gripper_is_up(g) && grip_find_object(e, robot, next, &object)) {
        g->closed = next;
        grip_take(e, robot, object);
    } else if (gripper_is_up(g) || grip_paddles_fit(e, robot, next)) {
        g->closed = next;
    }
}

/* The paddles close before the lift goes up, and open after it has come down. */
bool grip_run(struct engine *e, size_t robot)
{
    struct gripper *g = &e->robots[robot].gripper;
    if (!g->make || battery_is_empty(&e->robots[robot].battery)) {
        return false;
    }
    bool paddles = g->closes ? g->closed < 1 && g->holds == GRIPPER_NOTHING : g->closed > 0;
    bool lift = g->lifts ? g->lifted < 1 : g->lifted > 0;
    if (!paddles && !lift) {
        return false;
    }
    if (lift && !(paddles && g->closes)) {
        grip_move_lift(e, robot);
    } else {
        grip_move_paddles(e, robot);
    }
    grip_carry(e, robot);
    return true;
}

mu_result engine_grip(struct engine *e, size_t robot, int32_t paddles, int32_t lift)
{
    MU_ASSERT(robot < e->robot_count);
    struct gripper *g = &e->robots[robot].gripper;
    if (paddles == 0 && lift == 0) {
        return MU_OK;
    }
    if (!g->make) {
        return MU_ABSENT;
    }
    if ((paddles < 0 || lift < 0) && !grip_has_room(e, robot)) {
        return MU_REFUSED;
    }
    g->closes = paddles == 0 ? g->closes : paddles > 0;
    g->lifts = lift == 0 ? g->lifts : lift > 0;
    return MU_OK;
}

/* --- readings --------------------------------------------------------------------------------- */

static bool grip_beam_is_broken(struct engine *e, size_t robot, bool outer)
{
    const struct gripper *g = &e->robots[robot].gripper;
    const struct engine_object *held = grip_held(e, robot);
    struct frame frame = bodies_frame(e, robot);
    struct solid beam;
    if (!gripper_beam(g, &frame, outer, &beam)) {
        return false;
    }
    if (held) {
        struct narrow_contact contact;
        size_t part = bodies_object_part(e, (size_t)(held - e->objects));
        narrow_collide(&beam, &e->outlines[part], &contact);
        return contact.count > 0;
    }
    return !gripper_is_up(g) && space_obstacle(e, &beam, robot, 0);
}

static uint32_t grip_feel(struct engine *e, size_t robot)
{
    const struct gripper *g = &e->robots[robot].gripper;
    bool holds = g->holds != GRIPPER_NOTHING;
    const struct {
        bool is;
        uint32_t bit;
    } bits[] = {{true, MU_GRIPPER_THERE},
                {holds || g->closed >= 1, MU_GRIPPER_CLOSED},
                {gripper_is_up(g), MU_GRIPPER_LIFTED},
                {grip_beam_is_broken(e, robot, true), MU_GRIPPER_OUTER_BEAM},
                {grip_beam_is_broken(e, robot, false), MU_GRIPPER_INNER_BEAM},
                {holds, MU_GRIPPER_HOLDS}};
    uint32_t felt = 0;
    for (size_t i = 0; i < sizeof bits / sizeof bits[0]; i++) {
        felt |= bits[i].is ? bits[i].bit : 0;
    }
    return felt;
}

void grip_feel_all(struct engine *e)
{
    for (size_t i = 0; i < e->robot_count; i++) {
        struct engine_robot *r = &e->robots[i];
        r->grip_felt = r->gripper.make ? grip_feel(e, i) : 0;
    }
}
