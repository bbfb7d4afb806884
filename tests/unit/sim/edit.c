/* SPDX-License-Identifier: Apache-2.0 */
/* What a person changes in a running world, and what keeps a broken body from breaking the run. */
#include "capture.h"
#include "physics.h"
#include "suite.h"

static const char *reason;

static mu_result place(struct engine *e, size_t body, double x_m, double y_m)
{
    reason = NULL;
    return engine_place(e, body, (struct world_pose){x_m, y_m, 0.5}, &reason);
}

#define REFUSED(call, why)                           \
    do {                                             \
        CU_ASSERT_EQUAL(call, MU_REFUSED);           \
        CU_ASSERT_PTR_NOT_NULL_FATAL(reason);        \
        CU_ASSERT_PTR_NOT_NULL(strstr(reason, why)); \
    } while (0)

static void test_a_body_is_put_where_there_is_room(void)
{
    physics_clear();
    physics_fence(3);
    physics_wall(1, 1, 0.1, 0.1);
    physics_robot(0, 0, 0);
    physics_robot(-2, 0, 0);
    physics_object(0, -2, 0.2);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    (void)physics_run(e, 0, 5);
    REFUSED(place(e, 0, -2, 0.3), "robot1");
    REFUSED(place(e, 0, 0, -2), "object0");
    REFUSED(place(e, 0, 1, 1.2), "what stands there");
    REFUSED(place(e, 0, 2.9, 0), "what stands there");
    REFUSED(place(e, 0, 30, 0), "outside");
    REFUSED(place(e, 0, (double)NAN, 0), "outside");
    REFUSED(engine_place(e, 0, (struct world_pose){0, 0, (double)INFINITY}, &reason), "outside");
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 0).y_m, 0, 1e-9); /* nothing has changed */

    CU_ASSERT_EQUAL(place(e, 0, 2, -1), MU_OK);
    CU_ASSERT_EQUAL(place(e, 2, 2, 2), MU_OK);
    struct engine_sample p = physics_run(e, 0, 0);
    CU_ASSERT_EQUAL(p.pose.x_m, 2);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.heading_rad, 0.5, 1e-12);
    CU_ASSERT_EQUAL(p.percept.forward_m_s, 0);
    CU_ASSERT_EQUAL(engine_pose(e, 2).y_m, 2);
    CU_ASSERT_EQUAL(place(e, 0, 2.001, -1), MU_OK); /* it is not in its own way */
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

/* A robot at the origin that looks along x, with a gripper before it. */
static void add_gripper_robot(void)
{
    struct world_robot *r = physics_robot(0, 0, 0);
    r->gripper = (struct world_gripper){.pose = {0.27, 0, 0},
                                        .length_m = 0.1,
                                        .width_m = 0.3,
                                        .paddle_length_m = 0.2,
                                        .paddle_width_m = 0.04};
}

static void test_a_robot_takes_along_what_it_holds(void)
{
    physics_clear();
    physics_fence(3);
    add_gripper_robot();
    physics_object(0.42, 0, 0.05)->shape.half_x_m = 0.2;
    struct engine *e = physics_start(1);
    CU_ASSERT_EQUAL(engine_grip(e, 0, 1, 0), MU_OK);
    (void)physics_run(e, 0, 10);
    reason = NULL;
    REFUSED(engine_place(e, 0, (struct world_pose){2.6, 0, 0}, &reason), "what stands there");
    REFUSED(place(e, 1, 1, 1), "held by robot0");
    struct engine_force force = {.x_n = 1};
    REFUSED(engine_push(e, 1, &force, &reason), "held by robot0");
    CU_ASSERT_EQUAL(engine_place(e, 0, (struct world_pose){0, 1, M_PI / 2}, &reason), MU_OK);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).x_m, 0, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).y_m, 1.42, 1e-9);

    CU_ASSERT_EQUAL(engine_reset(e, 0, &reason), MU_OK); /* what it held stays */
    struct engine_sample p = physics_run(e, 0, 1);
    CU_ASSERT_EQUAL(p.percept.gripper, MU_GRIPPER_THERE);
    CU_ASSERT_EQUAL(p.pose.y_m, 0);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).y_m, 1.42, 1e-3);
    engine_close(e);
}

static void test_a_refused_reset_changes_nothing(void)
{
    physics_clear();
    physics_fence(3);
    add_gripper_robot();
    physics_object(0.42, 0, 0.05);
    physics_robot(-2, 0, 0);
    struct engine *e = physics_start(1);
    CU_ASSERT_EQUAL(engine_grip(e, 0, 1, 0), MU_OK);
    (void)physics_run(e, 0, 15);
    CU_ASSERT_EQUAL(engine_grip(e, 0, 0, 1), MU_OK);
    struct engine_sample p = physics_run(e, 0, 15);
    CU_ASSERT(p.percept.gripper & MU_GRIPPER_HOLDS && p.percept.gripper & MU_GRIPPER_LIFTED);
    CU_ASSERT_EQUAL(place(e, 0, 2, 0), MU_OK);
    CU_ASSERT_EQUAL(place(e, 1, 0.2, 0), MU_OK);
    uint64_t before = physics_hash(e, 1);
    p = physics_run(e, 0, 0);
    REFUSED(engine_reset(e, 0, &reason), "robot1");
    REFUSED(engine_reset(e, 2, &reason), "robot1"); /* the thing that it holds */
    CU_ASSERT_EQUAL(physics_hash(e, 1), before);
    CU_ASSERT_EQUAL(physics_run(e, 0, 0).percept.gripper, p.percept.gripper);
    REFUSED(place(e, 2, 1, 1), "held by robot0");
    physics_drive(e, 0, 0, 1);
    (void)physics_run(e, 0, 5);
    double from_m = hypot(engine_pose(e, 2).x_m - engine_pose(e, 0).x_m,
                          engine_pose(e, 2).y_m - engine_pose(e, 0).y_m);
    CU_ASSERT_DOUBLE_EQUAL(from_m, 0.42, 1e-3); /* it still goes where the robot goes */
    engine_close(e);
}

static void test_pushes(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    struct engine *e = physics_start(1);
    /* Brakes hold 0.6 m g: 53 N. */
    physics_push(e, 0, 40, 1);
    double creep = 40 * PHYSICS_DT_S / PHYSICS_ROBOT_KG; /* brakes hold against speed */
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 10).percept.forward_m_s, creep, 1e-6);
    physics_push(e, 0, 100, 1);
    double a = (100 - 0.6 * PHYSICS_ROBOT_KG * PHYSICS_G_M_S2) / PHYSICS_ROBOT_KG;
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 5).percept.forward_m_s, creep + a * 0.5, 0.03);
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 15).percept.forward_m_s, 0, 1e-9);
    static const struct engine_force bad[] = {{.x_n = (double)NAN},
                                              {.y_n = (double)INFINITY},
                                              {.turn_nm = 1e30},
                                              {.x_n = 1, .time_s = -1},
                                              {.x_n = 1, .time_s = (double)NAN}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        REFUSED(engine_push(e, 0, &bad[i], &reason), "robot0");
    }
    engine_close(e);
}

static void test_a_reset_is_a_new_start(void)
{
    physics_clear();
    struct world_robot *r = physics_robot(0, 0, 0);
    r->battery_j = r->battery_max_j = 100;
    r->power_w = 5;
    physics_object(0.6, 0, 0.1);
    physics_robot(0, 2, 0);
    struct engine *e = physics_start(1);
    uint64_t before = physics_hash(e, 1);
    physics_drive(e, 0, 0.4, 0.2);
    physics_drive(e, 1, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 30);
    CU_ASSERT(p.percept.battery_share < 0.9 && p.percept.odometer_x_m > 0.5);
    CU_ASSERT_EQUAL(place(e, 1, 0.1, 0), MU_OK);
    REFUSED(engine_reset(e, 0, &reason), "robot1");
    engine_reset_all(e);
    CU_ASSERT_EQUAL(physics_hash(e, 1), before);
    p = physics_run(e, 0, 0);
    CU_ASSERT_EQUAL(p.percept.battery_share, 1);
    CU_ASSERT_EQUAL(p.percept.odometer_x_m, 0);
    CU_ASSERT_EQUAL(physics_run(e, 0, 5).pose.x_m, 0); /* the old speed is forgotten */
    engine_close(e);
}

static void test_who_is_flung_out_is_put_back(void)
{
    physics_clear();
    physics_fence(3);
    physics_robot(0, 0, 90);
    physics_robot(2, 2, 0);
    physics_object(-2, 0, 0.2);
    struct engine *e = physics_start(1);
    physics_drive(e, 1, -0.2, 0);
    (void)physics_run(e, 0, 10);
    physics_push(e, 0, 1e6, 1);
    physics_push(e, 2, -1e6, 1);
    capture_begin();
    struct engine_sample p = physics_run(e, 0, 1);
    capture_end();
    CU_ASSERT_PTR_NOT_NULL(strstr(captured, "robot0"));
    CU_ASSERT_PTR_NOT_NULL(strstr(captured, "object0"));
    CU_ASSERT_PTR_NULL(strstr(captured, "robot1"));
    CU_ASSERT_TRUE(p.percept.fault);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 0, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.heading_rad, M_PI / 2, 1e-9);
    CU_ASSERT_EQUAL(p.percept.forward_m_s, 0);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 2).x_m, -2, 1e-9);
    struct engine_sample other = physics_run(e, 1, 0);
    CU_ASSERT_FALSE(other.percept.fault);
    CU_ASSERT_DOUBLE_EQUAL(other.percept.forward_m_s, -0.2, 1e-6);
    CU_ASSERT_FALSE(physics_run(e, 0, 1).percept.fault);
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

/* Faster than half its length in a substep: through a wall, were it not for the guard. */
static void test_a_push_does_not_tunnel(void)
{
    physics_clear();
    physics_wall(3, 0, 0.005, 3);
    for (int i = 0; i < 5; i++) {
        physics_robot(-0.13 * i, i - 2, 0);
    }
    struct engine *e = physics_start(1);
    for (size_t i = 0; i < 5; i++) {
        physics_push(e, i, 600, 0.5);
    }
    (void)physics_run(e, 0, 30);
    for (size_t i = 0; i < 5; i++) {
        CU_ASSERT(engine_pose(e, i).x_m < 3);
        CU_ASSERT(engine_pose(e, i).x_m > 0.5);
    }
    engine_close(e);
}

/* All in one place, in a world without any extent: something must come of it, and no NaN. */
static void test_a_world_of_no_size(void)
{
    physics_clear();
    for (int i = 0; i < 12; i++) {
        physics_robot(0, 0, 0);
    }
    for (int i = 0; i < 12; i++) {
        physics_object(0, 0, 0.1)->shape.kind = i % 2 ? WORLD_DISC : WORLD_BOX;
    }
    struct engine *e = physics_start(1);
    for (size_t i = 0; i < 12; i++) {
        physics_drive(e, i, 0.4, i % 2 ? 1 : -1);
    }
    for (int k = 0; k < 300; k++) {
        engine_step(e);
        for (size_t b = 0; b < engine_body_count(e); b++) {
            struct world_pose pose = engine_pose(e, b);
            CU_ASSERT_FATAL(isfinite(pose.x_m + pose.y_m + pose.heading_rad));
            CU_ASSERT_FATAL(fabs(pose.x_m) < 30 && fabs(pose.y_m) < 30);
        }
    }
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

/* The ends of what the wheels can do: to speed in v / a, and back within v^2 / 2a. */
static void test_speed_and_way_to_stop(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    struct engine *e = physics_start(1);
    physics_drive(e, 0, 99, 0);
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 5).percept.forward_m_s, PHYSICS_ACCEL * 0.5, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(physics_run(e, 0, 15).percept.forward_m_s, PHYSICS_SPEED_M_S, 1e-9);
    double from = engine_pose(e, 0).x_m;
    physics_drive(e, 0, 0, 0);
    struct engine_sample p = physics_run(e, 0, 11);
    double way = PHYSICS_SPEED_M_S * PHYSICS_SPEED_M_S / (2 * PHYSICS_ACCEL);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m - from, way, PHYSICS_SPEED_M_S * PHYSICS_DT_S);
    engine_close(e);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a body is put where there is room", test_a_body_is_put_where_there_is_room},
        {"a robot takes along what it holds", test_a_robot_takes_along_what_it_holds},
        {"a refused reset changes nothing", test_a_refused_reset_changes_nothing},
        {"pushes", test_pushes},
        {"a reset is a new start", test_a_reset_is_a_new_start},
        {"who is flung out is put back", test_who_is_flung_out_is_put_back},
        {"a push does not tunnel", test_a_push_does_not_tunnel},
        {"a world of no size", test_a_world_of_no_size},
        {"speed, and the way to stop", test_speed_and_way_to_stop},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/edit", tests);
}
