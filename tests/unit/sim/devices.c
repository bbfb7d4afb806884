/* SPDX-License-Identifier: Apache-2.0 */
/* Odometer, absolute place, compass, battery, bumper: against what they must say by hand. */
#include "physics.h"
#include "suite.h"

static void test_the_odometer_reads_the_wheels(void)
{
    physics_clear();
    struct world_robot *r = physics_robot(3, 1, 90);
    r->odometry.start = (struct world_pose){10, 20, 0};
    physics_robot(6, 1, 90)->odometry.true_start = true;
    struct engine *e = physics_start(1);
    for (size_t i = 0; i < 2; i++) {
        physics_drive(e, i, 0.4, 0.3);
    }
    struct engine_sample p = physics_run(e, 0, 100);
    /* Without slip, the way is the body's, turned from its start pose to the odometer's. */
    CU_ASSERT_DOUBLE_EQUAL(p.percept.odometer_x_m - 10, p.pose.y_m - 1, 0.02);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.odometer_y_m - 20, 3 - p.pose.x_m, 0.02);
    CU_ASSERT_DOUBLE_EQUAL(
        remainder(p.percept.odometer_heading_rad + M_PI / 2 - p.pose.heading_rad, 2 * M_PI), 0,
        1e-4);
    struct engine_sample q = physics_run(e, 1, 0);
    CU_ASSERT_DOUBLE_EQUAL(q.percept.odometer_x_m, q.pose.x_m, 0.02);
    CU_ASSERT_DOUBLE_EQUAL(q.percept.odometer_y_m, q.pose.y_m, 0.02);
    engine_close(e);
}

static void test_slip_is_not_noticed(void)
{
    physics_clear();
    physics_wall(1.1, 0, 0.1, 3);
    struct world_robot *r = physics_robot(0, 0, 0);
    r->reads_odometer = true;
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 100);
    double way = PHYSICS_DT_S * (0.5 * PHYSICS_DT_S * (40 * 41 / 2) + 460 * 0.4);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 1 - 0.22, 0.003);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.odometer_x_m, way, 1e-9); /* its wheels spin at the wall */
    CU_ASSERT_EQUAL(p.percept.x_m, p.percept.odometer_x_m);
    CU_ASSERT_EQUAL(p.percept.gps_x_m, p.pose.x_m);
    engine_close(e);
}

/* @return the gain of the way of one robot, by driving it straight */
static double gain_of(uint64_t seed, size_t robot)
{
    physics_clear();
    for (int i = 0; i < 3; i++) {
        physics_robot(0, 2 * i, 0)->odometry.forward_error = 0.1;
    }
    struct engine *e = physics_start(seed);
    physics_drive(e, robot, 0.4, 0);
    struct engine_sample p = physics_run(e, robot, 50);
    engine_close(e);
    return p.percept.odometer_x_m / p.pose.x_m;
}

static void test_the_odometer_has_its_own_error(void)
{
    double sum = 0;
    for (uint64_t seed = 1; seed <= 12; seed++) {
        double gain = gain_of(seed, 0);
        CU_ASSERT(gain > 0.95 - 1e-6 && gain < 1.05 + 1e-6);
        sum += fabs(gain - 1);
    }
    CU_ASSERT(sum / 12 > 0.01);
    CU_ASSERT_EQUAL(gain_of(1, 0), gain_of(1, 0));
    CU_ASSERT_NOT_EQUAL(gain_of(1, 0), gain_of(1, 1));
    CU_ASSERT_NOT_EQUAL(gain_of(1, 0), gain_of(2, 0));
}

enum { READINGS = 2000 };

static void test_noise_of_place_and_compass(void)
{
    physics_clear();
    struct world_robot *r = physics_robot(5, -3, 180);
    r->gps_noise_m = 0.5;
    r->compass_noise_rad = 0.1;
    physics_robot(0, 0, 0)->gps_noise_m = 0.5;
    struct engine *e = physics_start(1);
    double sum = 0;
    double sum_2 = 0;
    double both = 0;
    double turn_2 = 0;
    for (int k = 0; k < READINGS; k++) {
        struct engine_sample p = physics_run(e, 0, 1);
        struct engine_sample again = physics_run(e, 0, 0);
        struct engine_sample other = physics_run(e, 1, 0);
        CU_ASSERT_EQUAL_FATAL(p.percept.gps_x_m,
                              again.percept.gps_x_m); /* to read is to change nothing */
        CU_ASSERT_EQUAL(p.percept.x_m, p.percept.gps_x_m);
        CU_ASSERT_EQUAL(p.percept.heading_rad, p.percept.compass_rad);
        CU_ASSERT(p.percept.compass_rad > -M_PI && p.percept.compass_rad <= M_PI);
        double off = p.percept.gps_x_m - p.pose.x_m;
        double turn = remainder(p.percept.compass_rad - p.pose.heading_rad, 2 * M_PI);
        sum += off;
        sum_2 += off * off;
        both += off * (p.percept.gps_y_m - p.pose.y_m) + off * other.percept.gps_x_m;
        turn_2 += turn * turn;
    }
    /* Standard errors: of the mean 0.011, of the deviation 0.008. */
    CU_ASSERT_DOUBLE_EQUAL(sum / READINGS, 0, 0.045);
    CU_ASSERT_DOUBLE_EQUAL(sqrt(sum_2 / READINGS), 0.5, 0.04);
    CU_ASSERT_DOUBLE_EQUAL(both / READINGS, 0, 0.04);
    CU_ASSERT_DOUBLE_EQUAL(sqrt(turn_2 / READINGS), 0.1, 0.008);
    engine_close(e);
}

/* The square of how far a walk has come is its time. */
static void test_the_place_drifts(void)
{
    double sum_2 = 0;
    enum { ROBOTS = 16 };
    physics_clear();
    for (int i = 0; i < ROBOTS; i++) {
        physics_robot(0, i, 0)->gps_drift_m = 0.02;
    }
    for (uint64_t seed = 1; seed <= 8; seed++) {
        struct engine *e = physics_start(seed);
        for (size_t i = 0; i < ROBOTS; i++) {
            struct engine_sample p = physics_run(e, i, i == 0 ? 250 : 0);
            sum_2 +=
                pow(p.percept.gps_x_m - p.pose.x_m, 2) + pow(p.percept.gps_y_m - p.pose.y_m, 2);
            CU_ASSERT_EQUAL(p.pose.x_m, 0);
        }
        engine_close(e);
    }
    /* 256 squares of mean 0.02^2 * 25 s; the standard error of such a mean is 9 % of it. */
    CU_ASSERT_DOUBLE_EQUAL(sum_2 / (2 * ROBOTS * 8) / (0.02 * 0.02 * 25), 1, 0.35);
}

static void test_a_battery_lives_as_long_as_it_holds(void)
{
    physics_clear();
    struct world_robot *r = physics_robot(0, 0, 0);
    r->battery_j = 100;
    r->battery_max_j = 200;
    r->power_w = 10;
    physics_robot(0, 2, 0);
    struct engine *e = physics_start(1);
    CU_ASSERT_EQUAL(physics_run(e, 1, 0).percept.battery_share, -1);
    CU_ASSERT_EQUAL(physics_run(e, 0, 0).percept.battery_share, 0.5);
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 50).percept.battery_share, 0.25, 1e-9);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 20);
    /* Two more seconds, and the work to get 9 kg to 0.4 m/s: a ramp of 40 equal forces. */
    double work = PHYSICS_ROBOT_KG * 0.01 / PHYSICS_DT_S * 0.01 * PHYSICS_DT_S * (40 * 41 / 2);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.battery_share, (50 - 20 - work) / 200, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(work, 0.5 * PHYSICS_ROBOT_KG * 0.4 * 0.4, 0.03);
    p = physics_run(e, 0, 28);
    CU_ASSERT(p.percept.battery_share > 0);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0.4, 1e-6);
    physics_drive(e, 0, 0.4, 0);
    p = physics_run(e, 0, 12);
    CU_ASSERT_EQUAL(p.percept.battery_share, 0);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0, 1e-6);
    double there = p.pose.x_m;
    physics_drive(e, 0, 0.4, 0);
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 20).pose.x_m, there, 1e-6);
    engine_close(e);
}

static void test_a_charger_charges_whom_it_touches(void)
{
    physics_clear();
    physics_wall(0.62, 0, 0.2, 1)->look.give_w = 50; /* its face at 0.42 */
    struct world_shape *pad = physics_wall(0, 3, 1, 1);
    pad->look = (struct world_look){.give_w = 5};
    for (int i = 0; i < 2; i++) {
        struct world_robot *r = physics_robot(0, 3 * i, 0);
        r->battery_j = 10;
        r->battery_max_j = 100;
        r->take_w = 20;
    }
    struct engine *e = physics_start(1);
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 10).percept.battery_share, 0.1, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 1, 0).percept.battery_share, 0.15, 1e-9); /* on the pad */
    physics_drive(e, 0, 0.3, 0);
    (void)physics_run(e, 0, 20);
    physics_drive(e, 0, 0, 0);
    double before = physics_run(e, 0, 8).percept.battery_share;
    double after = physics_run(e, 0, 10).percept.battery_share;
    CU_ASSERT_DOUBLE_EQUAL(after - before, 0.2, 1e-6); /* 20 W for 1 s, of 100 J */
    CU_ASSERT_EQUAL(physics_run(e, 0, 100).percept.battery_share, 1);
    engine_close(e);
}

/* Eight walls around, one at a time. */
static void test_the_bumper_says_where(void)
{
    for (int k = 0; k < 8; k++) {
        double at = k * M_PI / 4 + 0.3;
        physics_clear();
        physics_robot(1, 2, 0.3 * 180 / M_PI)->length_m = 0.38;
        struct world_shape *post = physics_wall(1 + 0.5 * cos(at), 2 + 0.5 * sin(at), 0, 0);
        post->kind = WORLD_DISC;
        post->radius_m = k % 2 ? 0.5 - 0.268 : 0.5 - 0.189; /* a corner, or a side */
        struct engine *e = physics_start(1);
        CU_ASSERT_EQUAL(physics_run(e, 0, 0).percept.bumpers, 0);
        CU_ASSERT_EQUAL(physics_run(e, 0, 1).percept.bumpers, 1u << k);
        engine_close(e);
    }
}

static void test_a_blocked_wheel_is_told_within_half_a_second(void)
{
    physics_clear();
    physics_wall(0.32, 0, 0.1, 4); /* at its front */
    physics_robot(0, 0, 0);
    physics_robot(0, 3, 0)->turn_max_rad_s = 2; /* between two posts: it cannot turn */
    physics_wall(0.21, 3.28, 0.04, 0.08);
    physics_wall(-0.21, 2.72, 0.04, 0.08);
    physics_wall(0.21, 2.72, 0.04, 0.08);
    physics_wall(-0.21, 3.28, 0.04, 0.08);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    physics_drive(e, 1, 0, 2);
    (void)physics_run(e, 0, 5);
    CU_ASSERT_TRUE(physics_run(e, 0, 0).percept.stalled);
    CU_ASSERT_TRUE(physics_run(e, 1, 2).percept.stalled); /* it has a play of some degrees first */
    engine_close(e);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the odometer reads the wheels", test_the_odometer_reads_the_wheels},
        {"slip is not noticed", test_slip_is_not_noticed},
        {"the odometer has its own error", test_the_odometer_has_its_own_error},
        {"noise of place and compass", test_noise_of_place_and_compass},
        {"the place drifts", test_the_place_drifts},
        {"a battery's life", test_a_battery_lives_as_long_as_it_holds},
        {"a charger", test_a_charger_charges_whom_it_touches},
        {"the bumper says where", test_the_bumper_says_where},
        {"a blocked wheel", test_a_blocked_wheel_is_told_within_half_a_second},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/devices", tests);
}
