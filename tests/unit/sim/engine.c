/* SPDX-License-Identifier: Apache-2.0 */
/* Driving, pushing, stalling and seeing, in worlds small enough to compute by hand. */
#include "sim/engine/engine.h"
#include "physics.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <string.h>

static void add_sonar(struct world_robot *r, double x_m, double y_m, double heading_deg)
{
    *physics_sonar(r) = (struct world_sonar){
        .pose = {x_m, y_m, heading_deg * M_PI / 180}, .range_min_m = 0.05, .range_max_m = 5};
}

static void test_straight_drive(void)
{
    physics_clear();
    physics_robot(0, 0, 90);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 50);
    /* 0.8 s of ramp in 40 substeps of 20 ms, each at its end speed, then 210 at 0.4 m/s */
    double way = 0.02 * (0.5 * 0.02 * (40 * 41 / 2) + 210 * 0.4);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.y_m, way, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 0, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0.4, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.heading_rad, M_PI / 2, 1e-9);
    CU_ASSERT_FALSE(p.percept.stalled);
    engine_close(e);
}

static void test_turning_keeps_the_place_and_the_range_of_headings(void)
{
    physics_clear();
    physics_robot(1, 2, 0)->origin_x_m = -0.04;
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0, 1);
    double least = 0;
    double most = 0;
    struct engine_sample p;
    for (int k = 0; k < 100; k++) {
        p = physics_run(e, 0, 1);
        least = fmin(least, p.pose.heading_rad);
        most = fmax(most, p.pose.heading_rad);
    }
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 1, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.y_m, 2, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.turn_rad_s, 1, 1e-9);
    CU_ASSERT(least > -M_PI && least < -3);
    CU_ASSERT(most <= M_PI && most > 3);
    engine_close(e);

    physics_clear();
    physics_robot(0, 0, -180);
    e = physics_start(1);
    p = physics_run(e, 0, 0);
    CU_ASSERT_EQUAL(p.pose.heading_rad, M_PI);
    engine_close(e);
}

static void test_commands_are_clamped_or_refused(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    struct engine *e = physics_start(1);
    static const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    for (size_t i = 0; i < 3; i++) {
        double speed = bad[i];
        double turn = 0;
        CU_ASSERT_EQUAL(engine_command(e, 0, &speed, &turn), MU_REFUSED);
        speed = 0;
        turn = bad[i];
        CU_ASSERT_EQUAL(engine_command(e, 0, &speed, &turn), MU_REFUSED);
    }
    struct engine_sample p = physics_run(e, 0, 10);
    CU_ASSERT_EQUAL(p.pose.x_m, 0); /* the old aim, to stand, stayed */
    double speed = 1e300;
    double turn = -1e300;
    CU_ASSERT_EQUAL(engine_command(e, 0, &speed, &turn), MU_OK);
    CU_ASSERT_EQUAL(speed, 0.5);
    CU_ASSERT_EQUAL(turn, -M_PI / 2);
    speed = -7;
    turn = 7;
    CU_ASSERT_EQUAL(engine_command(e, 0, &speed, &turn), MU_OK);
    CU_ASSERT_EQUAL(speed, -0.3);
    CU_ASSERT_EQUAL(turn, M_PI / 2);
    engine_close(e);
}

static void test_a_wall_stalls_and_holds(void)
{
    physics_clear();
    physics_wall(2.05, 0, 0.05, 4);
    physics_robot(1, 0, 0);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 15);
    CU_ASSERT_FALSE(p.percept.stalled);
    p = physics_run(e, 0, 100);
    CU_ASSERT_TRUE(p.percept.stalled);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 2 - 0.22, 0.003); /* the front at the wall */
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0, 1e-3);
    double held = p.pose.x_m;
    p = physics_run(e, 0, 300);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, held, 1e-3);
    physics_drive(e, 0, -0.2, 0);
    p = physics_run(e, 0, 30);
    CU_ASSERT_FALSE(p.percept.stalled);
    CU_ASSERT(p.pose.x_m < held - 0.3);
    engine_close(e);
}

static void test_stall_comes_after_the_held_time(void)
{
    physics_clear();
    physics_wall(0.32, 0, 0.1, 4); /* touches the robot from the start */
    physics_robot(0, 0, 0);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    /* The wheels are above 0.02 m/s from the 3rd substep of 20 ms on: then 0.3 s. */
    struct engine_sample p = physics_run(e, 0, 3);
    CU_ASSERT_FALSE(p.percept.stalled);
    p = physics_run(e, 0, 2);
    CU_ASSERT_TRUE(p.percept.stalled);
    engine_close(e);
}

static void test_nothing_tunnels(void)
{
    physics_clear();
    physics_wall(0, 0, 0.005, 8); /* a centimetre thick */
    for (int i = 0; i < 6; i++) { /* so that at full speed some would step right over it */
        struct world_robot *r = physics_robot(-97 - 0.11 * i, 2 * i - 5, 0);
        r->forward_max_m_s = 100;
        r->forward_accel_m_s2 = 100;
    }
    struct engine *e = physics_start(1);
    for (size_t i = 0; i < 6; i++) {
        physics_drive(e, i, 100, 0);
    }
    physics_run(e, 0, 300);
    for (size_t i = 0; i < 6; i++) {
        struct engine_sample p = physics_run(e, i, 0);
        CU_ASSERT(p.pose.x_m < 0);
        CU_ASSERT_TRUE(p.percept.stalled);
    }
    engine_close(e);
}

static void test_head_on_both_stand(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    physics_robot(2, 0, 180);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    physics_drive(e, 1, 0.4, 0);
    struct engine_sample a = physics_run(e, 0, 100);
    struct engine_sample b = physics_run(e, 1, 0);
    CU_ASSERT_TRUE(a.percept.stalled);
    CU_ASSERT_TRUE(b.percept.stalled);
    CU_ASSERT_DOUBLE_EQUAL(hypot(b.pose.x_m - a.pose.x_m, b.pose.y_m - a.pose.y_m), 0.44, 0.02);
    engine_close(e);
}

static void test_pushing(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    physics_robot(0.6, 0, 0)->mass_kg = 1; /* light, and standing on its brakes */
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample light = physics_run(e, 1, 100);
    CU_ASSERT(light.pose.x_m > 2);
    CU_ASSERT(light.percept.forward_m_s > 0.1);
    engine_close(e);

    physics_clear();
    physics_robot(0, 0, 0);
    physics_robot(0.6, 0, 0)->mass_kg = 90;
    e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample heavy = physics_run(e, 1, 100);
    struct engine_sample pusher = physics_run(e, 0, 0);
    CU_ASSERT(fabs(heavy.pose.x_m - 0.6) < 0.35);
    CU_ASSERT_TRUE(pusher.percept.stalled);
    engine_close(e);
}

static void test_sonar_geometry(void)
{
    physics_clear();
    physics_wall(2.1, 0, 0.1, 4); /* its face at x = 2 */
    physics_wall(0, -20, 1, 0.1); /* out of range */
    physics_shapes[physics_world.shape_count++] = (struct world_shape){
        .kind = WORLD_DISC, .pose = {0, 3, 0}, .radius_m = 0.5, .look = physics_look()};
    struct world_robot *r = physics_robot(0, 0, 0);
    add_sonar(r, 0.1, 0, 0);
    add_sonar(r, 0, 0.1, 90);
    add_sonar(r, 0, 0, -90);
    add_sonar(r, 0.1, 0, 45);
    add_sonar(r, -0.25, 0, 180);
    physics_robot(-1.25, 0, 0);       /* its front at x = -1.03 */
    physics_robot(2 - 0.205, 1.2, 0); /* near the wall: a reading below the least */
    add_sonar(&physics_robots[2], 0.2, 0, 0);
    struct engine *e = physics_start(1);
    struct engine_sample p = physics_run(e, 0, 0);
    CU_ASSERT_EQUAL_FATAL(p.percept.sonar_count, 5);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.sonar_m[0], 1.9, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.sonar_m[1], 2.4, 1e-6);
    CU_ASSERT_EQUAL((double)p.percept.sonar_m[2], 5);
    /* Along 45 degrees the third robot's side, y = 1.01, is met at x = 1.11, before it starts at
     * x = 1.575; its rear, x = 1.575, at y = 1.475, behind its other side: so it is the wall. */
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.sonar_m[3], 1.9 * sqrt(2), 1e-6);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.sonar_m[4], 0.78, 1e-6);
    p = physics_run(e, 2, 0);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.sonar_m[0], 0.05, 1e-6);
    engine_close(e);
}

/* Four robots in a box that bump into walls and into each other. */
static uint64_t hash_of_a_crowd(uint64_t seed, bool *flat)
{
    physics_clear();
    physics_wall(0, 2.1, 2.2, 0.1);
    physics_wall(0, -2.1, 2.2, 0.1);
    physics_wall(2.1, 0, 0.1, 2.2);
    physics_wall(-2.1, 0, 0.1, 2.2);
    physics_wall(0, 0, 0.3, 0.2);
    for (int i = 0; i < 4; i++) {
        struct world_robot *r = physics_robot(i % 2 * 2 - 1, i / 2 * 2 - 1, 37 * i);
        r->origin_x_m = -0.04;
        add_sonar(r, 0.1, 0, 0);
        add_sonar(r, 0.1, 0, 40);
    }
    struct engine *e = physics_start(seed);
    uint64_t hash = MU_HASH_EMPTY;
    *flat = true;
    for (unsigned k = 0; k < 400; k++) {
        for (size_t i = 0; i < 4; i++) {
            physics_drive(e, i, (k + i * 7) % 40 < 30 ? 0.5 : -0.3, (double)((k / 25 + i) % 3) - 1);
        }
        engine_step(e);
        for (size_t i = 0; i < 4; i++) {
            double state[ENGINE_STATE_DOUBLES];
            struct engine_sample p = physics_sense(e, i);
            engine_state(e, i, state);
            hash = mu_hash_bytes(hash, state, sizeof state);
            hash = mu_hash_bytes(hash, p.percept.sonar_m, 2 * sizeof(float));
            CU_ASSERT_FATAL(fabs(state[0]) < 2.1 && fabs(state[1]) < 2.1);
        }
        *flat = *flat && physics_is_flat(e);
    }
    engine_close(e);
    return hash;
}

static void test_the_same_bits_again_and_flat(void)
{
    bool flat;
    uint64_t first = hash_of_a_crowd(1, &flat);
    CU_ASSERT_TRUE(flat);
    CU_ASSERT_EQUAL(hash_of_a_crowd(1, &flat), first);
    CU_ASSERT_TRUE(flat);
    CU_ASSERT_NOT_EQUAL(hash_of_a_crowd(2, &flat), first); /* the seed shuffles the solver */
}

static void test_out_in_the_open(void)
{
    physics_clear();
    physics_wall(0, 0, 0.5, 0.5);
    struct world_robot *r = physics_robot(2, 0, 0);
    add_sonar(r, 0, 0, 180);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.5, 0);
    struct engine_sample p = physics_run(e, 0, 60);
    CU_ASSERT(p.pose.x_m > 4);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.sonar_m[0], p.pose.x_m - 0.5, 1e-6);
    engine_close(e);
    physics_clear();
    e = physics_start(1); /* nothing at all */
    engine_step(e);
    engine_close(e);
}

static void test_a_mark_on_the_floor_slows_nobody(void)
{
    physics_clear();
    physics_wall(5, 0, 0.1, 4);
    physics_wall(0, 0, 0.0005, 4); /* a line on the floor */
    physics_shapes[1].look = (struct world_look){.shows = true};
    struct world_robot *r = physics_robot(-1, 0, 0);
    r->length_m = r->width_m = 0.02;
    r->forward_max_m_s = 1;
    r->forward_accel_m_s2 = 5;
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 1, 0);
    struct engine_sample p = physics_run(e, 0, 20);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 1, 1e-6);
    CU_ASSERT(p.pose.x_m > 0.5);
    engine_close(e);
}

static void test_all_are_sensed_as_one_is(void)
{
    physics_clear();
    physics_wall(2.1, 0, 0.1, 4);
    for (int i = 0; i < 3; i++) {
        struct world_robot *r = physics_robot(0, 1.0 * i - 1, 0);
        add_sonar(r, 0.1, 0, 0);
        r->laser = (struct world_laser){.range_max_m = 8, .fov_rad = M_PI, .samples = 3};
    }
    struct engine *e = physics_start(1);
    physics_drive(e, 1, 0.4, 0.2);
    const uint32_t wanted[3] = {0, MU_SENSE_SONAR | MU_SENSE_LASER, MU_SENSE_LASER};
    for (int step = 0; step < 20; step++) {
        engine_step(e);
        const struct engine_sample *all = engine_sense_all(e, wanted);
        CU_ASSERT(all[0].percept.sonar_count == 0 && all[0].percept.laser_count == 0);
        CU_ASSERT(all[1].percept.sonar_count == 1 && all[1].percept.laser_count == 3);
        CU_ASSERT(all[2].percept.sonar_count == 0 && all[2].percept.laser_count == 3);
        float sonar = all[1].percept.sonar_m[0];
        float laser = all[1].percept.laser_m[1];
        double x = all[1].pose.x_m;
        struct engine_sample one = physics_sense(e, 1);
        CU_ASSERT(one.percept.sonar_m[0] == sonar && one.percept.laser_m[1] == laser &&
                  one.pose.x_m == x);
        CU_ASSERT(step < 10 || (laser < 2 && x > 0));
    }
    engine_close(e);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"straight drive", test_straight_drive},
        {"turning", test_turning_keeps_the_place_and_the_range_of_headings},
        {"commands are clamped or refused", test_commands_are_clamped_or_refused},
        {"a wall stalls and holds", test_a_wall_stalls_and_holds},
        {"stall comes after the held time", test_stall_comes_after_the_held_time},
        {"nothing tunnels", test_nothing_tunnels},
        {"head-on", test_head_on_both_stand},
        {"pushing", test_pushing},
        {"sonar geometry", test_sonar_geometry},
        {"the same bits again, and flat", test_the_same_bits_again_and_flat},
        {"out in the open", test_out_in_the_open},
        {"a mark on the floor slows nobody", test_a_mark_on_the_floor_slows_nobody},
        {"all are sensed as one is", test_all_are_sensed_as_one_is},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/engine", tests);
}
