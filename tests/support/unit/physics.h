/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file physics.h
 * Worlds that are small enough to compute by hand, for tests of the engine.
 */
#ifndef MUSTER_TESTS_PHYSICS_H
#define MUSTER_TESTS_PHYSICS_H

#include "core/hash.h"
#include "sim/engine/engine.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A substep of the engine, and the pull of the earth. */
#define PHYSICS_DT_S      0.02
#define PHYSICS_G_M_S2    9.81
#define PHYSICS_STEP_NS   100000000ull
#define PHYSICS_ROBOT_M   0.44
#define PHYSICS_ROBOT_KG  9.0
#define PHYSICS_ACCEL     0.5
#define PHYSICS_SPEED_M_S 0.5

enum { PHYSICS_THINGS = 16, PHYSICS_ENGINES = 64, PHYSICS_BODIES = MU_ROBOTS_MAX + 16 };

static struct world_shape physics_shapes[PHYSICS_THINGS];
static struct world_robot physics_robots[PHYSICS_THINGS];
static struct world_sonar physics_sonars[PHYSICS_THINGS][MU_SONARS_MAX];
static struct world_object physics_objects[PHYSICS_THINGS];
static struct world physics_world;

/* Their memory lives as long as the process: kept here, so that leak checkers see it. */
static struct engine *physics_engines[PHYSICS_ENGINES];
static size_t physics_engines_used;

static inline void physics_clear(void)
{
    memset(physics_shapes, 0, sizeof physics_shapes);
    memset(physics_robots, 0, sizeof physics_robots);
    memset(physics_sonars, 0, sizeof physics_sonars);
    memset(physics_objects, 0, sizeof physics_objects);
    physics_world = (struct world){
        .shapes = physics_shapes, .robots = physics_robots, .objects = physics_objects};
}

static inline struct world_look physics_look(void)
{
    return (struct world_look){.stops = true, .echoes = true, .shows = true};
}

static inline struct world_shape *physics_wall(double x_m, double y_m, double half_x_m,
                                               double half_y_m)
{
    struct world_shape *shape = &physics_shapes[physics_world.shape_count++];
    *shape = (struct world_shape){.kind = WORLD_BOX,
                                  .pose = {x_m, y_m, 0},
                                  .half_x_m = half_x_m,
                                  .half_y_m = half_y_m,
                                  .look = physics_look()};
    return shape;
}

/* Four walls around a square, whose inside reaches so far from the middle. */
static inline void physics_fence(double half_m)
{
    physics_wall(0, half_m + 0.1, half_m + 0.2, 0.1);
    physics_wall(0, -half_m - 0.1, half_m + 0.2, 0.1);
    physics_wall(half_m + 0.1, 0, 0.1, half_m + 0.2);
    physics_wall(-half_m - 0.1, 0, 0.1, half_m + 0.2);
}

static inline struct world_robot *physics_robot(double x_m, double y_m, double heading_deg)
{
    struct world_robot *r = &physics_robots[physics_world.robot_count];
    *r = (struct world_robot){.pose = {x_m, y_m, heading_deg * M_PI / 180},
                              .look = physics_look(),
                              .length_m = PHYSICS_ROBOT_M,
                              .width_m = 0.38,
                              .mass_kg = PHYSICS_ROBOT_KG,
                              .forward_max_m_s = PHYSICS_SPEED_M_S,
                              .reverse_max_m_s = 0.3,
                              .turn_max_rad_s = M_PI / 2,
                              .forward_accel_m_s2 = PHYSICS_ACCEL,
                              .turn_accel_rad_s2 = M_PI / 2};
    snprintf(r->name, sizeof r->name, "robot%zu", physics_world.robot_count++);
    return r;
}

/* One more sonar, of which nothing is said yet. */
static inline struct world_sonar *physics_sonar(struct world_robot *r)
{
    struct world_sonar *ring = physics_sonars[r - physics_robots];
    r->sonars = ring;
    return &ring[r->sonar_count++];
}

static inline struct world_object *physics_object(double x_m, double y_m, double half_m)
{
    struct world_object *o = &physics_objects[physics_world.object_count];
    *o = (struct world_object){.shape = {.kind = WORLD_BOX,
                                         .pose = {x_m, y_m, 0},
                                         .half_x_m = half_m,
                                         .half_y_m = half_m,
                                         .radius_m = half_m,
                                         .look = physics_look()},
                               .mass_kg = 1,
                               .friction = 0.5};
    o->shape.look.graspable = true;
    snprintf(o->name, sizeof o->name, "object%zu", physics_world.object_count++);
    return o;
}

static inline struct engine *physics_start(uint64_t seed)
{
    struct engine_options options = {.seed = seed, .step_ns = PHYSICS_STEP_NS};
    struct engine *e = engine_open(&physics_world, &options);
    CU_ASSERT_FATAL(physics_engines_used < PHYSICS_ENGINES);
    physics_engines[physics_engines_used++] = e;
    return e;
}

static inline void physics_drive(struct engine *e, size_t robot, double forward_m_s,
                                 double turn_rad_s)
{
    CU_ASSERT_EQUAL(engine_command(e, robot, &forward_m_s, &turn_rad_s), MU_OK);
}

/* All that one robot senses now; the others are not read. */
static inline struct engine_sample physics_sense(struct engine *e, size_t robot)
{
    static uint32_t wanted[PHYSICS_BODIES];
    CU_ASSERT_FATAL(engine_body_count(e) <= PHYSICS_BODIES);
    memset(wanted, 0, sizeof wanted);
    wanted[robot] = MU_SENSES;
    return engine_sense_all(e, wanted)[robot];
}

static inline struct engine_sample physics_run(struct engine *e, size_t robot, unsigned steps)
{
    for (unsigned k = 0; k < steps; k++) {
        engine_step(e);
    }
    return physics_sense(e, robot);
}

static inline void physics_push(struct engine *e, size_t body, double x_n, double time_s)
{
    const char *reason = NULL;
    struct engine_force force = {.x_n = x_n, .time_s = time_s};
    CU_ASSERT_EQUAL(engine_push(e, body, &force, &reason), MU_OK);
}

/* Whether height, roll and pitch, and how fast they change, are exactly 0. */
static inline bool physics_is_flat(const struct engine *e)
{
    bool flat = true;
    for (size_t b = 0; b < engine_body_count(e); b++) {
        double s[ENGINE_STATE_DOUBLES];
        engine_state(e, b, s);
        flat = flat && s[2] == 0 && s[4] == 0 && s[5] == 0 && s[9] == 0 && s[10] == 0 && s[11] == 0;
    }
    return flat;
}

/* A hash over the state of all bodies. */
static inline uint64_t physics_hash(const struct engine *e, uint64_t hash)
{
    for (size_t b = 0; b < engine_body_count(e); b++) {
        double state[ENGINE_STATE_DOUBLES];
        engine_state(e, b, state);
        hash = mu_hash_bytes(hash, state, sizeof state);
    }
    return hash;
}

#endif
