/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Beams and rays a second in a scene that moves: no branch predictor knows it by heart.
 *   rays WORLD STEPS
 * prints laser beams a second of processor time by the fans, then single rays a second with the
 * geometry of the laser and of the sonars; `none` when MUSTER_FAN names a kernel that this
 * processor lacks.
 */
#include "muster/memory.h"
#include "sim/engine/engine.h"
#include "sim/geometry/geometry.h"
#include "sim/sensors/fan.h"
#include "wander.h"
#include "world/world_load.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* A ray in a robot's frame. */
struct ray {
    double from[2], along[2];
};

struct bench {
    struct ray laser[WANDER_BEAMS], sonar[WANDER_SONARS];
    const struct world *world;
    struct engine *engine;
    struct wander *minds;
    uint32_t *driving, *looking; /* what is wanted: the sonars, the laser */
    struct solid *still, *moving;
    struct grid grid;
    double fan_s, laser_s, sonar_s;
    double sum; /* of all ranges, so that none is left out */
};

static struct ray ray_at(struct world_pose pose)
{
    return (struct ray){{pose.x_m, pose.y_m}, {cos(pose.heading_rad), sin(pose.heading_rad)}};
}

static void bench_open(struct bench *b)
{
    for (int k = 0; k < WANDER_BEAMS; k++) {
        b->laser[k] = ray_at((struct world_pose){0, 0, -M_PI / 2 + M_PI * k / (WANDER_BEAMS - 1)});
    }
    for (int k = 0; k < WANDER_SONARS; k++) {
        b->sonar[k] = ray_at(b->world->robots[0].sonars[k].pose);
    }
    size_t robots = b->world->robot_count;
    struct engine_options options = {.seed = 1, .step_ns = MU_STEP_NS};
    b->engine = engine_open(b->world, &options);
    b->minds = mu_startup_array(robots, sizeof *b->minds);
    b->driving = mu_startup_array(robots, sizeof *b->driving);
    b->looking = mu_startup_array(robots, sizeof *b->looking);
    b->still = mu_startup_array(b->world->shape_count, sizeof *b->still);
    b->moving = mu_startup_array(robots, sizeof *b->moving);
    for (size_t i = 0; i < b->world->shape_count; i++) {
        b->still[i] = solid_of_shape(&b->world->shapes[i]);
    }
    for (size_t i = 0; i < robots; i++) {
        const struct world_robot *robot = &b->world->robots[i];
        wander_start(&b->minds[i], i);
        b->driving[i] = MU_SENSE_SONAR;
        b->looking[i] = MU_SENSE_LASER;
        b->moving[i] = solid_box(robot->pose, robot->length_m / 2, robot->width_m / 2);
        b->moving[i].owner = (int32_t)i;
    }
    grid_init(&b->grid, b->still, b->world->shape_count, b->moving, robots);
}

static void drive(struct bench *b)
{
    const struct engine_sample *percepts = engine_sense_all(b->engine, b->driving);
    for (size_t i = 0; i < b->world->robot_count; i++) {
        const struct engine_sample *p = &percepts[i];
        wander_step(&b->minds[i], p->percept.sonar_m, p->percept.bumpers != 0);
        double forward_m_s = b->minds[i].forward_m_s;
        double turn_rad_s = b->minds[i].turn_rad_s;
        MU_ASSERT(engine_command(b->engine, i, &forward_m_s, &turn_rad_s) == MU_OK);
        b->moving[i].x = p->pose.x_m;
        b->moving[i].y = p->pose.y_m;
        b->moving[i].c = cos(p->pose.heading_rad);
        b->moving[i].s = sin(p->pose.heading_rad);
    }
    grid_update(&b->grid);
    engine_step(b->engine);
}

static void cast(struct bench *b, const struct ray *rays, size_t count, double range_m)
{
    for (size_t i = 0; i < b->world->robot_count; i++) {
        const struct solid *r = &b->moving[i];
        for (size_t k = 0; k < count; k++) {
            const double *from = rays[k].from;
            const double *along = rays[k].along;
            double at[2] = {r->x + r->c * from[0] - r->s * from[1],
                            r->y + r->s * from[0] + r->c * from[1]};
            double to[2] = {r->c * along[0] - r->s * along[1], r->s * along[0] + r->c * along[1]};
            b->sum += grid_ray(&b->grid, (int)i, at, to, range_m);
        }
    }
}

/* Processor time: on a busy machine others' turns are none of a ray's. */
static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void measure(struct bench *b)
{
    drive(b);
    double begin = now_s();
    (void)engine_sense_all(b->engine, b->looking);
    b->fan_s += now_s() - begin;
    begin = now_s();
    cast(b, b->laser, WANDER_BEAMS, WANDER_LASER_M);
    b->laser_s += now_s() - begin;
    begin = now_s();
    cast(b, b->sonar, WANDER_SONARS, WANDER_SONAR_M);
    b->sonar_s += now_s() - begin;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: rays WORLD STEPS\n");
        return 2;
    }
    const char *kernel = getenv("MUSTER_FAN");
    if (kernel && !fan_choose(kernel)) {
        printf("none\n");
        return 0;
    }
    static struct world world;
    struct mu_fault fault;
    if (world_load(&world, argv[1], true, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return 3;
    }
    struct bench b = {.world = &world};
    bench_open(&b);
    int steps = (int)strtol(argv[2], NULL, 10);
    for (int k = 0; k < steps; k++) {
        measure(&b);
    }
    double robot_steps = (double)steps * (double)world.robot_count;
    printf("%.6g %.6g %.6g %.3f\n", robot_steps * WANDER_BEAMS / b.fan_s,
           robot_steps * WANDER_BEAMS / b.laser_s, robot_steps * WANDER_SONARS / b.sonar_s, b.sum);
    engine_close(b.engine);
    return 0;
}
