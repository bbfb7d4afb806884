/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/engine.h"

#include "muster/memory.h"
#include "sim/drive.h"
#include "sim/grid.h"
#include "sim/narrow.h"
#include "sim/ode_world.h"
#include "sim/senses.h"

#include <math.h>
#include <stdio.h>

#define ENGINE_SUBSTEP_NS 20000000ull

/* Farther out than any world reaches: what is there has been flung, not driven. */
#define ENGINE_PLACE_MAX_M 1e7

struct engine_robot {
    struct drive drive;
    struct ode_motion motion;        /* as of now */
    struct ode_motion last_good;     /* as of the last control step */
    double outline_x_m, outline_y_m; /* the outline's middle in the robot's frame */
};

struct engine {
    uint64_t seed, substeps; /* substeps since the start */
    uint64_t steps;          /* control steps since the start */
    unsigned substeps_per_step;
    double dt_s;
    size_t robot_count;
    struct engine_robot *robots;
    struct solid *outlines; /* of the robots, where they are now */
    struct solid *shapes;
    struct grid grid;
    struct grid_near near;
    struct senses *senses;
    struct engine_percept *percepts; /* of engine_sense_all */
};

/* splitmix64's last stage: neighbouring steps get seeds that have nothing in common. */
static uint64_t engine_mix(uint64_t x)
{
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

static void engine_follow(struct engine *e, size_t i)
{
    struct engine_robot *r = &e->robots[i];
    ode_world_motion(i, &r->motion);
    const struct ode_motion *m = &r->motion;
    struct solid *outline = &e->outlines[i];
    outline->x = m->x + m->c * r->outline_x_m - m->s * r->outline_y_m;
    outline->y = m->y + m->s * r->outline_x_m + m->c * r->outline_y_m;
    outline->c = m->c;
    outline->s = m->s;
}

static struct drive_motion engine_own_motion(const struct ode_motion *m)
{
    return (struct drive_motion){.forward_m_s = m->c * m->vx + m->s * m->vy,
                                 .left_m_s = m->c * m->vy - m->s * m->vx,
                                 .turn_rad_s = m->turn};
}

/*
 * Half of the thinnest thing that a robot could meet, and of itself, per substep: nothing is
 * jumped over.
 */
static double engine_speed_max(const struct engine *e, const struct world *world,
                               const struct world_robot *robot)
{
    double thinnest = INFINITY;
    for (size_t i = 0; i < world->shape_count; i++) {
        thinnest = fmin(thinnest, fmin(e->shapes[i].half_x, e->shapes[i].half_y));
    }
    thinnest = isfinite(thinnest) ? thinnest : 0;
    return 0.5 * (fmin(robot->length_m, robot->width_m) / 2 + thinnest) / e->dt_s;
}

static void engine_add_robot(struct engine *e, const struct world *world, size_t i)
{
    const struct world_robot *robot = &world->robots[i];
    struct engine_robot *r = &e->robots[i];
    struct ode_body_size size = {.mass_kg = robot->mass_kg,
                                 .length_m = robot->length_m,
                                 .width_m = robot->width_m,
                                 .middle_x_m = robot->origin_x_m,
                                 .middle_y_m = robot->origin_y_m};
    double inertia = ode_world_add(&size, robot->pose);
    r->outline_x_m = robot->origin_x_m;
    r->outline_y_m = robot->origin_y_m;
    drive_init(&r->drive, robot, inertia, engine_speed_max(e, world, robot));
    e->outlines[i] = solid_box(robot->pose, robot->length_m / 2, robot->width_m / 2);
    e->outlines[i].owner = (int32_t)i;
    solid_look(&e->outlines[i], &robot->look);
    engine_follow(e, i);
    r->last_good = r->motion;
}

struct engine *engine_open(const struct world *world, const struct engine_options *options)
{
    uint64_t substep_ns = options->substep_ns ? options->substep_ns : ENGINE_SUBSTEP_NS;
    MU_ASSERT(options->step_ns >= substep_ns && options->step_ns % substep_ns == 0);
    size_t robots = world->robot_count;
    struct engine *e = mu_startup_alloc(sizeof *e);
    e->seed = options->seed;
    e->substeps_per_step = (unsigned)(options->step_ns / substep_ns);
    e->dt_s = (double)substep_ns * 1e-9;
    e->robot_count = robots;
    e->robots = mu_startup_array(robots, sizeof *e->robots);
    e->outlines = mu_startup_array(robots, sizeof *e->outlines);
    e->shapes = mu_startup_array(world->shape_count, sizeof *e->shapes);
    e->near.still = mu_startup_array(world->shape_count, sizeof *e->near.still);
    e->near.moving = mu_startup_array(robots, sizeof *e->near.moving);
    for (size_t i = 0; i < world->shape_count; i++) {
        e->shapes[i] = solid_of_shape(&world->shapes[i]);
    }
    ode_world_open(robots);
    for (size_t i = 0; i < robots; i++) {
        engine_add_robot(e, world, i);
    }
    grid_init(&e->grid, e->shapes, world->shape_count, e->outlines, robots);
    e->senses = senses_open(&(struct senses_scene){.world = world,
                                                   .grid = &e->grid,
                                                   .seed = options->seed,
                                                   .step_ns = options->step_ns,
                                                   .threads = options->threads});
    e->percepts = mu_startup_array(robots, sizeof *e->percepts);
    return e;
}

void engine_close(struct engine *e)
{
    if (e) {
        senses_close(e->senses);
        ode_world_close();
    }
}

mu_result engine_command(struct engine *e, size_t robot, double *forward_m_s, double *turn_rad_s)
{
    MU_ASSERT(robot < e->robot_count);
    if (!isfinite(*forward_m_s) || !isfinite(*turn_rad_s)) {
        return MU_REFUSED; /* one of these in ODE would end the process */
    }
    drive_aim(&e->robots[robot].drive, forward_m_s, turn_rad_s);
    return MU_OK;
}

static void engine_push(struct engine *e, size_t i)
{
    struct engine_robot *r = &e->robots[i];
    const struct ode_motion *m = &r->motion;
    struct drive_motion motion = engine_own_motion(m);
    struct drive_force f = drive_run(&r->drive, &motion, e->dt_s);
    ode_world_push(i, m->c * f.forward_n - m->s * f.left_n, m->s * f.forward_n + m->c * f.left_n,
                   f.turn_nm);
}

/* The order of the contacts is part of the result: by robot, then as grid_near lists them. */
static void engine_collide(struct engine *e, size_t i)
{
    struct narrow_contact contact;
    grid_near(&e->grid, (uint32_t)i, &e->near);
    for (size_t k = 0; k < e->near.still_count; k++) {
        narrow_collide(&e->outlines[i], &e->shapes[e->near.still[k]], &contact);
        ode_world_touch(i, ODE_WORLD_STANDS, &contact);
    }
    for (size_t k = 0; k < e->near.moving_count; k++) {
        uint32_t other = e->near.moving[k];
        narrow_collide(&e->outlines[i], &e->outlines[other], &contact);
        ode_world_touch(i, (int)other, &contact);
    }
}

static void engine_substep(struct engine *e)
{
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_push(e, i);
    }
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_collide(e, i);
    }
    e->substeps++;
    ode_world_step(e->dt_s, engine_mix(e->seed ^ engine_mix(e->substeps)));
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_follow(e, i);
        struct engine_robot *r = &e->robots[i];
        struct drive_motion motion = engine_own_motion(&r->motion);
        drive_watch(&r->drive, &motion, e->dt_s);
    }
    grid_update(&e->grid);
}

/* A body that has left the numbers goes back to where it was, at rest. */
static void engine_mend(struct engine *e, size_t i)
{
    struct engine_robot *r = &e->robots[i];
    const struct ode_motion *m = &r->motion;
    double sum = m->x + m->y + m->c + m->s + m->vx + m->vy + m->turn;
    if (isfinite(sum) && fabs(m->x) < ENGINE_PLACE_MAX_M && fabs(m->y) < ENGINE_PLACE_MAX_M) {
        r->last_good = *m;
        return;
    }
    fprintf(stderr, "robot %zu was flung out of the world; it is put back\n", i);
    ode_world_put(i, r->last_good.x, r->last_good.y, atan2(r->last_good.s, r->last_good.c));
    r->drive.forward_m_s = 0;
    r->drive.turn_rad_s = 0;
    engine_follow(e, i);
    grid_update(&e->grid);
}

void engine_step(struct engine *e)
{
    for (unsigned k = 0; k < e->substeps_per_step; k++) {
        engine_substep(e);
    }
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_mend(e, i);
    }
    e->steps++;
}

static void engine_place_senses(struct engine *e, size_t robot)
{
    const struct ode_motion *m = &e->robots[robot].motion;
    senses_place(e->senses, robot, &(struct frame){m->x, m->y, m->c, m->s});
}

/* What a robot feels of its own body. */
static void engine_feel(const struct engine *e, size_t robot, struct engine_percept *out)
{
    const struct engine_robot *r = &e->robots[robot];
    const struct ode_motion *m = &r->motion;
    struct drive_motion motion = engine_own_motion(m);
    double heading = atan2(m->s, m->c);
    struct world_pose pose = {m->x, m->y, heading <= -M_PI ? M_PI : heading};
    *out = (struct engine_percept){.pose = pose,
                                   .position = pose,
                                   .gps_x_m = pose.x_m,
                                   .gps_y_m = pose.y_m,
                                   .compass_rad = pose.heading_rad,
                                   .odometer = pose,
                                   .battery_share = -1};
    out->forward_m_s = motion.forward_m_s;
    out->turn_rad_s = motion.turn_rad_s;
    out->stalled = drive_stalled(&r->drive);
}

const struct engine_percept *engine_sense_all(struct engine *e, const uint32_t wanted[])
{
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_place_senses(e, i);
    }
    senses_read_all(e->senses, wanted, e->steps);
    for (size_t i = 0; i < e->robot_count; i++) {
        engine_feel(e, i, &e->percepts[i]);
        senses_tell(e->senses, i, wanted[i], &e->percepts[i]);
    }
    return e->percepts;
}

void engine_sense(struct engine *e, size_t robot, struct engine_percept *out)
{
    MU_ASSERT(robot < e->robot_count);
    engine_place_senses(e, robot);
    senses_read(e->senses, robot, ENGINE_ALL_SENSES, e->steps);
    engine_feel(e, robot, out);
    senses_tell(e->senses, robot, ENGINE_ALL_SENSES, out);
}

void engine_state(const struct engine *e, size_t robot, double state[ENGINE_STATE_DOUBLES])
{
    MU_ASSERT(robot < e->robot_count);
    ode_world_state(robot, state);
}
