/* SPDX-License-Identifier: Apache-2.0 */
/* Things that can be pushed: how they slide, stand, and move others. */
#include "physics.h"
#include "suite.h"

/* An impulse, and friction from the first substep on: v0 - a dt, v0 - 2 a dt, ... */
static void test_a_shove_slides_by_friction(void)
{
    physics_clear();
    physics_object(0, 0, 0.2)->mass_kg = 4;
    physics_object(0, 2, 0.2)->shape.kind = WORLD_DISC;
    struct engine *e = physics_start(1);
    double v0 = 1.5;
    double brake = 0.5 * PHYSICS_G_M_S2;
    physics_push(e, 0, 4 * v0, 0);
    physics_push(e, 1, 1 * v0, 0);
    double way = 0;
    for (double v = v0 - brake * PHYSICS_DT_S; v > 0; v -= brake * PHYSICS_DT_S) {
        way += v * PHYSICS_DT_S;
    }
    for (int k = 0; k < 20; k++) {
        engine_step(e);
    }
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 0).x_m, way, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).x_m, way, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(way, v0 * v0 / (2 * brake), v0 * PHYSICS_DT_S);
    double state[ENGINE_STATE_DOUBLES];
    engine_state(e, 0, state);
    CU_ASSERT_EQUAL(state[7], 0); /* it has come to rest for good */
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

/* A disc on the floor turns against 2/3 of its radius, with half m r^2 of inertia. */
static void test_a_spin_ends_by_friction(void)
{
    physics_clear();
    struct world_object *o = physics_object(0, 0, 0.3);
    o->shape.kind = WORLD_DISC;
    o->mass_kg = 2;
    struct engine *e = physics_start(1);
    double inertia = 0.5 * 2 * 0.3 * 0.3;
    double brake = 0.5 * 2 * PHYSICS_G_M_S2 * (2.0 / 3) * 0.3 / inertia;
    const char *reason;
    double w0 = 6;
    struct engine_force spin = {.turn_nm = inertia * w0};
    CU_ASSERT_EQUAL(engine_push(e, 0, &spin, &reason), MU_OK);
    double angle = 0;
    for (double w = w0 - brake * PHYSICS_DT_S; w > 0; w -= brake * PHYSICS_DT_S) {
        angle += w * PHYSICS_DT_S;
    }
    for (int k = 0; k < 20; k++) {
        engine_step(e);
    }
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 0).heading_rad, angle, 1e-3);
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

static void test_a_weak_push_moves_nothing(void)
{
    physics_clear();
    physics_object(0, 0, 0.2)->mass_kg = 10;
    physics_object(0, 3, 0.2)->mass_kg = 10;
    struct engine *e = physics_start(1);
    double hold = 0.5 * 10 * PHYSICS_G_M_S2;
    physics_push(e, 0, 0.95 * hold, 10);
    physics_push(e, 1, 1.2 * hold, 2);
    for (int k = 0; k < 20; k++) {
        engine_step(e);
    }
    double a = 0.2 * hold / 10;
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 0).x_m, 0, 1e-6);
    /* a, 2a, 3a ... for 100 substeps */
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).x_m, a * PHYSICS_DT_S * PHYSICS_DT_S * 5050, 1e-3);
    engine_close(e);
}

static void test_a_robot_pushes_what_is_light(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    physics_object(0.6, 0, 0.15);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 50);
    CU_ASSERT_FALSE(p.percept.stalled);
    /* The wheels pull with what they lag behind: m (aim - v) / dt is the friction. */
    double lag = 0.5 * 1 * PHYSICS_G_M_S2 * PHYSICS_DT_S / PHYSICS_ROBOT_KG;
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0.4 - lag, 1e-4);
    CU_ASSERT_EQUAL(p.percept.bumpers, 0x83); /* ahead, from -34 to 34 degrees */
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).x_m - p.pose.x_m, 0.22 + 0.15, 0.003);
    physics_drive(e, 0, -0.3, 0);
    p = physics_run(e, 0, 30);
    CU_ASSERT_EQUAL(p.percept.bumpers, 0);
    double left = engine_pose(e, 1).x_m;
    CU_ASSERT(left > 1.5 && left - p.pose.x_m > 0.6);
    (void)physics_run(e, 0, 30);
    CU_ASSERT_EQUAL(engine_pose(e, 1).x_m, left);
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

/* 20 kg on the floor hold 98 N, the wheels of 9 kg pull with 53 N. */
static void test_a_robot_stalls_at_what_is_heavy(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    physics_object(0.45, 0, 0.2)->mass_kg = 20;
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 8);
    CU_ASSERT_TRUE(p.percept.stalled);
    p = physics_run(e, 0, 100);
    CU_ASSERT_TRUE(p.percept.stalled);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).x_m, 0.45, 0.002);
    engine_close(e);
}

static void test_objects_push_objects_and_walls_hold_them(void)
{
    physics_clear();
    physics_wall(3.1, 0, 0.1, 3);
    physics_robot(0, 0, 0);
    for (int k = 0; k < 3; k++) {
        physics_object(0.6 + 0.5 * k, 0, 0.15);
    }
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 120);
    CU_ASSERT_TRUE(p.percept.stalled);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 3 - 0.9 - 0.22, 0.02); /* a row buckles */
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 3).x_m, 2.85, 0.006);
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

static void test_sonars_see_objects_and_ghosts_stop_nobody(void)
{
    physics_clear();
    struct world_robot *r = physics_robot(0, 0, 0);
    *physics_sonar(r) =
        (struct world_sonar){.pose = {0.1, 0, 0}, .range_min_m = 0.05, .range_max_m = 5, .rays = 1};
    physics_object(2, 0, 0.25);
    struct engine *e = physics_start(1);
    struct engine_sample p = physics_run(e, 0, 0);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.sonar_m[0], 1.65, 1e-6);
    engine_close(e);

    physics_objects[0].shape.look.stops = false;
    e = physics_start(1);
    physics_drive(e, 0, 0.5, 0);
    p = physics_run(e, 0, 100);
    CU_ASSERT(p.pose.x_m > 4);
    CU_ASSERT_EQUAL(engine_pose(e, 1).x_m, 2);
    engine_close(e);
}

/* A heap of boxes and discs that robots plough through. */
static uint64_t plough(uint64_t seed, bool *flat)
{
    physics_clear();
    physics_fence(2);
    for (int i = 0; i < 3; i++) {
        physics_robot(-1.5, i - 1, 10 * i);
    }
    for (int k = 0; k < 12; k++) {
        struct world_object *o = physics_object(k % 4 * 0.45 - 0.4, k / 4 * 0.5 - 0.5, 0.12);
        o->shape.kind = k % 3 ? WORLD_BOX : WORLD_DISC;
        o->shape.pose.heading_rad = k;
    }
    struct engine *e = physics_start(seed);
    uint64_t hash = 1469598103934665603ull;
    *flat = true;
    for (unsigned k = 0; k < 300; k++) {
        for (size_t i = 0; i < 3; i++) {
            physics_drive(e, i, k % 60 < 45 ? 0.5 : -0.3, (double)((k / 40 + i) % 3) - 1);
        }
        engine_step(e);
        hash = physics_hash(e, hash);
        *flat = *flat && physics_is_flat(e);
    }
    for (size_t b = 0; b < engine_body_count(e); b++) {
        struct world_pose pose = engine_pose(e, b);
        CU_ASSERT(fabs(pose.x_m) < 2 && fabs(pose.y_m) < 2);
    }
    engine_close(e);
    return hash;
}

static void test_the_same_bits_again_and_flat(void)
{
    bool flat;
    uint64_t first = plough(1, &flat);
    CU_ASSERT_TRUE(flat);
    CU_ASSERT_EQUAL(plough(1, &flat), first);
    CU_ASSERT_NOT_EQUAL(plough(2, &flat), first);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a shove slides by friction", test_a_shove_slides_by_friction},
        {"a spin ends by friction", test_a_spin_ends_by_friction},
        {"a weak push moves nothing", test_a_weak_push_moves_nothing},
        {"a robot pushes what is light", test_a_robot_pushes_what_is_light},
        {"a robot stalls at what is heavy", test_a_robot_stalls_at_what_is_heavy},
        {"objects push objects", test_objects_push_objects_and_walls_hold_them},
        {"sonars see objects, ghosts stop nobody", test_sonars_see_objects_and_ghosts_stop_nobody},
        {"the same bits again, and flat", test_the_same_bits_again_and_flat},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/objects", tests);
}
