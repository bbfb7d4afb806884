/* SPDX-License-Identifier: Apache-2.0 */
/* The order of a control step.  The other files of this folder do the work. */
#include "core/hash.h"
#include "muster/memory.h"
#include "sim/engine/engine_core.h"

#define ENGINE_SUBSTEP_NS 20000000ull

/* Pairs of near parts per part: a box in a heap has about six neighbours, each counted twice. */
enum { ENGINE_PAIRS = 8 };

/* --- start and end ---------------------------------------------------------------------------- */

static size_t engine_count_paddles(const struct world *world)
{
    size_t count = 0;
    for (size_t i = 0; i < world->robot_count; i++) {
        count += world->robots[i].gripper.length_m > 0 ? GRIPPER_PADDLES : 0;
    }
    return count;
}

static void engine_take_memory(struct engine *e, const struct world *world)
{
    e->robot_count = world->robot_count;
    e->object_count = world->object_count;
    e->body_count = e->robot_count + e->object_count;
    e->part_count = e->body_count + engine_count_paddles(world);
    e->bodies = mu_startup_array(e->body_count, sizeof *e->bodies);
    e->robots = mu_startup_array(e->robot_count, sizeof *e->robots);
    e->objects = mu_startup_array(e->object_count, sizeof *e->objects);
    e->samples = mu_startup_array(e->robot_count, sizeof *e->samples);
    e->outlines = mu_startup_array(e->part_count, sizeof *e->outlines);
    e->pairs_max = ENGINE_PAIRS * e->part_count;
    e->pairs = mu_startup_array(e->pairs_max, sizeof *e->pairs);
    e->parts = mu_startup_array(e->part_count, sizeof *e->parts);
    e->shapes = mu_startup_array(world->shape_count, sizeof *e->shapes);
    e->stands = mu_startup_array(world->shape_count, sizeof *e->stands);
    e->near.still = mu_startup_array(world->shape_count, sizeof *e->near.still);
    e->near.moving = mu_startup_array(e->part_count, sizeof *e->near.moving);
    neighbours_start(e);
}

static void engine_build_bounds(struct engine *e)
{
    double gap_m = INFINITY; /* a narrower gap lets no body through */
    for (size_t b = 0; b < e->body_count; b++) {
        size_t part = b < e->robot_count ? b : bodies_object_part(e, b - e->robot_count);
        gap_m = fmin(gap_m, 2 * fmin(e->outlines[part].half_x, e->outlines[part].half_y));
    }
    bounds_measure(&e->bounds, e->shapes, e->world->shape_count, isfinite(gap_m) ? gap_m : 0);
    for (size_t b = 0; b < e->body_count; b++) {
        bounds_include(&e->bounds, e->bodies[b].motion.x, e->bodies[b].motion.y);
    }
}

struct engine *engine_open(const struct world *world, const struct engine_options *options)
{
    MU_ASSERT(options->step_ns > 0 && options->step_ns % ENGINE_SUBSTEP_NS == 0);
    struct engine *e = mu_startup_alloc(sizeof *e);
    e->world = world;
    e->seed = options->seed;
    e->substeps_per_step = (unsigned)(options->step_ns / ENGINE_SUBSTEP_NS);
    e->dt_s = (double)ENGINE_SUBSTEP_NS * 1e-9;
    engine_take_memory(e, world);
    for (size_t i = 0; i < world->shape_count; i++) {
        e->shapes[i] = solid_of_shape(&world->shapes[i]);
        e->stands[i] =
            (struct engine_part){.body = ODE_WORLD_STANDS, .look = &world->shapes[i].look};
    }
    ode_world_open(e->body_count);
    bodies_add(e);
    for (size_t b = 0; b < e->body_count; b++) {
        motion_follow(e, b);
        e->bodies[b].last_good = e->bodies[b].motion;
    }
    for (size_t i = 0; i < e->robot_count; i++) {
        bodies_start_devices(e, i);
    }
    engine_build_bounds(e);
    grid_init(&e->grid, e->shapes, world->shape_count, e->outlines, e->part_count);
    e->sensors = sensors_open(&(struct sensors_scene){.world = world,
                                                      .grid = &e->grid,
                                                      .seed = options->seed,
                                                      .step_ns = options->step_ns,
                                                      .threads = options->threads});
    grip_feel_all(e);
    return e;
}

void engine_close(struct engine *e)
{
    if (e) {
        sensors_close(e->sensors);
        ode_world_close();
    }
}

/* --- a step ----------------------------------------------------------------------------------- */

mu_result engine_command(struct engine *e, size_t robot, double *forward_m_s, double *turn_rad_s)
{
    MU_ASSERT(robot < e->robot_count);
    if (!isfinite(*forward_m_s) || !isfinite(*turn_rad_s)) {
        return MU_REFUSED; /* such a number would make ODE end the process */
    }
    drive_aim(&e->robots[robot].drive, forward_m_s, turn_rad_s);
    return MU_OK;
}

static struct drive_motion engine_own_motion(const struct ode_motion *m)
{
    return (struct drive_motion){.forward_m_s = m->c * m->vx + m->s * m->vy,
                                 .left_m_s = m->c * m->vy - m->s * m->vx,
                                 .turn_rad_s = m->turn};
}

/* Drives the wheels of a robot, and pushes its body. */
static void engine_roll(struct engine *e, size_t i)
{
    struct engine_robot *r = &e->robots[i];
    const struct ode_motion *m = &e->bodies[i].motion;
    struct drive_motion motion = engine_own_motion(m);
    if (battery_is_empty(&r->battery)) {
        double none = 0;
        drive_aim(&r->drive, &none, &none);
    }
    struct drive_force f = drive_run(&r->drive, &motion, e->dt_s);
    r->drive_w = fabs(f.forward_n * r->drive.forward_m_s) + fabs(f.turn_nm * r->drive.turn_rad_s);
    ode_world_push(i, m->c * f.forward_n - m->s * f.left_n, m->s * f.forward_n + m->c * f.left_n,
                   f.turn_nm);
}

/* Updates the devices after the physics has moved the body. */
static void engine_note(struct engine *e, size_t i)
{
    struct engine_robot *r = &e->robots[i];
    struct drive_motion motion = engine_own_motion(&e->bodies[i].motion);
    drive_watch(&r->drive, &motion, e->dt_s);
    odometer_run(&r->odometer, r->drive.forward_m_s, r->drive.turn_rad_s, e->dt_s);
    battery_run(&r->battery, r->drive_w, r->charge_w, e->dt_s);
}

static void engine_run_grippers(struct engine *e)
{
    bool moved = false;
    for (size_t i = 0; i < e->robot_count; i++) {
        moved = grip_run(e, i) || moved;
    }
    if (moved) {
        e->grid_is_old = true;
    }
}

static void engine_substep(struct engine *e)
{
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_roll(e, i);
    }
    motion_load_forces(e);
    contacts_find(e);
    e->substeps++;
    /* mixed, so that the seeds of consecutive substeps are independent */
    ode_world_step(e->dt_s, mu_hash_number(e->seed ^ mu_hash_number(e->substeps)));
    motion_settle(e);
    separate_all(e);
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_note(e, i);
    }
    e->grid_is_old = true;
    engine_run_grippers(e);
}

void engine_step(struct engine *e)
{
    for (size_t i = 0; i < e->robot_count; i++) {
        e->robots[i].bumpers = 0;
    }
    for (unsigned k = 0; k < e->substeps_per_step; k++) {
        engine_substep(e);
    }
    sanity_check(e);
    e->steps++;
    for (size_t i = 0; i < e->robot_count; i++) {
        struct gps_when now = {e->seed, i, e->steps};
        gps_walk(&e->robots[i].gps, &now);
    }
    grip_feel_all(e);
}

/* --- results ---------------------------------------------------------------------------------- */

static void engine_place_sensors(struct engine *e, size_t robot)
{
    const struct ode_motion *m = &e->bodies[robot].motion;
    sensors_place(e->sensors, robot, &(struct frame){m->x, m->y, m->c, m->s});
}

const struct engine_sample *engine_sense_all(struct engine *e, const uint32_t wanted[])
{
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_place_sensors(e, i);
    }
    space_refresh(e);
    sensors_read_all(e->sensors, wanted, e->steps);
    for (size_t i = 0; i < e->robot_count; i++) {
        percept_read(e, i, &e->samples[i]);
        e->bodies[i].placed = false;
        sensors_tell(e->sensors, i, wanted[i], &e->samples[i].percept);
    }
    return e->samples;
}

size_t engine_body_count(const struct engine *e)
{
    return e->body_count;
}

void engine_state(const struct engine *e, size_t body, double state[ENGINE_STATE_DOUBLES])
{
    MU_ASSERT(body < e->body_count);
    ode_world_state(body, state);
}
