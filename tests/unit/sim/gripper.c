/* SPDX-License-Identifier: Apache-2.0 */
/* Grippers: what they take, how they carry it, and where they do not let it go. */
#include "physics.h"
#include "suite.h"

/* The case reaches from the robot's front, 0.22, to 0.32; its paddles from there to 0.52, and
 * their gap is 0.22 wide. */
enum { OPEN = -1, CLOSE = 1, DOWN = -1, UP = 1 };

#define IS(p, bits)  (((p).percept.gripper & (bits)) == (bits))
#define HAS(p, bits) (((p).percept.gripper & (bits)) != 0)

static const uint32_t beams = MU_GRIPPER_INNER_BEAM | MU_GRIPPER_OUTER_BEAM;

static struct world_robot *add_gripper(double x_m)
{
    struct world_robot *r = physics_robot(x_m, 0, 0);
    r->gripper = (struct world_gripper){.pose = {0.27, 0, 0},
                                        .length_m = 0.1,
                                        .width_m = 0.3,
                                        .paddle_length_m = 0.2,
                                        .paddle_width_m = 0.04};
    return r;
}

static struct engine_sample grip(struct engine *e, int32_t paddles, int32_t lift, unsigned steps)
{
    CU_ASSERT_EQUAL(engine_grip(e, 0, paddles, lift), MU_OK);
    return physics_run(e, 0, steps);
}

/* Where the thing is in the robot's frame. */
static void check_borne_at(const struct engine *e, double x_m, double y_m)
{
    struct world_pose robot = engine_pose(e, 0);
    struct world_pose thing = engine_pose(e, 1);
    double dx = thing.x_m - robot.x_m;
    double dy = thing.y_m - robot.y_m;
    double c = cos(robot.heading_rad);
    double s = sin(robot.heading_rad);
    CU_ASSERT_DOUBLE_EQUAL(c * dx + s * dy, x_m, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(c * dy - s * dx, y_m, 1e-9);
}

static void test_it_takes_carries_and_releases(void)
{
    physics_clear();
    add_gripper(0);
    physics_object(0.42, 0, 0.05);
    struct engine *e = physics_start(1);
    struct engine_sample p = physics_run(e, 0, 1);
    CU_ASSERT_EQUAL(p.percept.gripper, MU_GRIPPER_THERE | MU_GRIPPER_INNER_BEAM);
    /* The paddles have 0.06 of 0.11 m to go, at 0.11 m/s: 0.55 s. */
    p = grip(e, CLOSE, 0, 5);
    CU_ASSERT_FALSE(HAS(p, MU_GRIPPER_HOLDS));
    p = physics_run(e, 0, 1);
    CU_ASSERT_TRUE(IS(p, MU_GRIPPER_HOLDS | MU_GRIPPER_CLOSED));
    check_borne_at(e, 0.42, 0);
    p = grip(e, 0, UP, 9);
    CU_ASSERT_FALSE(HAS(p, MU_GRIPPER_LIFTED));
    p = physics_run(e, 0, 1);
    CU_ASSERT_TRUE(IS(p, MU_GRIPPER_LIFTED | MU_GRIPPER_HOLDS));

    physics_drive(e, 0, 0.4, 0.5);
    p = physics_run(e, 0, 60);
    check_borne_at(e, 0.42, 0);
    CU_ASSERT(engine_pose(e, 1).y_m > 0.5);
    CU_ASSERT_TRUE(physics_is_flat(e));
    physics_drive(e, 0, 0, 0);
    p = physics_run(e, 0, 20);
    p = grip(e, OPEN, DOWN, 10);
    CU_ASSERT_TRUE(IS(p, MU_GRIPPER_HOLDS));
    CU_ASSERT_FALSE(HAS(p, MU_GRIPPER_LIFTED));
    struct world_pose left = engine_pose(e, 1);
    p = physics_run(e, 0, 10);
    CU_ASSERT_FALSE(HAS(p, MU_GRIPPER_HOLDS | MU_GRIPPER_CLOSED));
    physics_drive(e, 0, -0.3, 0);
    (void)physics_run(e, 0, 30);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).x_m, left.x_m, 1e-3);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).y_m, left.y_m, 1e-3);
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

static void test_paddles_close_on_nothing_and_stop_at_the_rest(void)
{
    physics_clear();
    add_gripper(0);
    struct engine *e = physics_start(1);
    struct engine_sample p = grip(e, CLOSE, 0, 9);
    CU_ASSERT_FALSE(HAS(p, MU_GRIPPER_CLOSED));
    p = physics_run(e, 0, 1);
    CU_ASSERT_EQUAL(p.percept.gripper, MU_GRIPPER_THERE | MU_GRIPPER_CLOSED);
    engine_close(e);

    physics_object(0.42, 0, 0.05)->shape.look.graspable = false;
    e = physics_start(1);
    p = grip(e, CLOSE, 0, 30);
    CU_ASSERT_EQUAL(p.percept.gripper, MU_GRIPPER_THERE | MU_GRIPPER_INNER_BEAM);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).x_m, 0.42, 2e-3);
    CU_ASSERT_DOUBLE_EQUAL(engine_pose(e, 1).y_m, 0, 2e-3);
    engine_close(e);
}

static void test_beams(void)
{
    static const struct {
        double x_m;
        uint32_t broken;
    } cases[] = {{0.37, MU_GRIPPER_INNER_BEAM},
                 {0.52, MU_GRIPPER_OUTER_BEAM},
                 {0.44, MU_GRIPPER_OUTER_BEAM | MU_GRIPPER_INNER_BEAM},
                 {0.7, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        physics_clear();
        add_gripper(0);
        physics_object(cases[i].x_m, 0, 0.07)->shape.half_x_m = i == 2 ? 0.07 : 0.04;
        struct engine *e = physics_start(1);
        struct engine_sample p = physics_run(e, 0, 0);
        CU_ASSERT_EQUAL(p.percept.gripper & beams, cases[i].broken);
        engine_close(e);
    }
}

static void test_what_is_held_is_solid_until_it_is_up(void)
{
    physics_clear();
    physics_wall(2.1, 0, 0.1, 3); /* its face at x = 2 */
    add_gripper(0);
    physics_object(0.42, 0, 0.05)->shape.half_x_m = 0.12; /* reaches to 0.54, over the paddles */
    struct engine *e = physics_start(1);
    (void)grip(e, CLOSE, 0, 10);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 80);
    CU_ASSERT_TRUE(p.percept.stalled);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 2 - 0.54, 0.004);
    CU_ASSERT_EQUAL(p.percept.bumpers, 0); /* it is not the case that touches */

    p = grip(e, 0, UP, 10);
    p = physics_run(e, 0, 80);
    CU_ASSERT_TRUE(p.percept.stalled);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 2 - 0.22, 0.004); /* over the wall's edge */
    check_borne_at(e, 0.42, 0);
    physics_drive(e, 0, 0, 0);
    CU_ASSERT_EQUAL(engine_grip(e, 0, 0, DOWN), MU_REFUSED);
    CU_ASSERT_EQUAL(engine_grip(e, 0, OPEN, 0), MU_REFUSED);
    p = physics_run(e, 0, 30);
    CU_ASSERT_TRUE(IS(p, MU_GRIPPER_HOLDS | MU_GRIPPER_LIFTED));

    physics_drive(e, 0, -0.3, 0);
    (void)physics_run(e, 0, 30);
    physics_drive(e, 0, 0, 0);
    (void)physics_run(e, 0, 10);
    p = grip(e, OPEN, 0, 10); /* from above: it falls to where it is */
    CU_ASSERT_FALSE(HAS(p, MU_GRIPPER_HOLDS));
    CU_ASSERT(engine_pose(e, 1).x_m < 1.7);
    CU_ASSERT_TRUE(physics_is_flat(e));
    engine_close(e);
}

/* The wheels must move both, and have the weight of both to do it with. */
static void test_a_load_weighs(void)
{
    physics_clear();
    add_gripper(0);
    physics_object(0.42, 0, 0.05)->mass_kg = 6;
    physics_object(3, 0, 0.2)->mass_kg = 10.5; /* its friction of 51.5 N just lets 53 N pass */
    struct engine *e = physics_start(1);
    (void)grip(e, CLOSE, UP, 20);
    physics_drive(e, 0, 0.4, 0);
    struct engine_sample p = physics_run(e, 0, 40);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0.4, 1e-9);
    /* m (aim - v) / dt is the friction, of 15 kg instead of 9 */
    p = physics_run(e, 0, 80);
    double lag = 0.5 * 10.5 * PHYSICS_G_M_S2 * PHYSICS_DT_S / (PHYSICS_ROBOT_KG + 6);
    CU_ASSERT_DOUBLE_EQUAL(p.percept.forward_m_s, 0.4 - lag, 2e-3);
    engine_close(e);
}

static void test_paddles_push_and_have_room(void)
{
    physics_clear();
    struct world_robot *r = add_gripper(0);
    r->gripper.starts_closed = true;
    physics_wall(0.52, 0.2, 0.2, 0.1); /* 0.1 m beside: no room to open wholly */
    physics_wall(0.52, -0.2, 0.2, 0.1);
    physics_wall(2.1, 0, 0.1, 3);
    struct engine *e = physics_start(1);
    struct engine_sample p = physics_run(e, 0, 0);
    CU_ASSERT_TRUE(IS(p, MU_GRIPPER_CLOSED));
    p = grip(e, OPEN, 0, 20);
    CU_ASSERT_FALSE(HAS(p, MU_GRIPPER_CLOSED));
    CU_ASSERT_DOUBLE_EQUAL(p.pose.y_m, 0, 1e-3);
    engine_close(e);

    physics_world.shape_count = 0;
    physics_wall(2.1, 0, 0.1, 3);
    e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    p = physics_run(e, 0, 80);
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 2 - 0.52, 0.004); /* the paddles' tips */
    engine_close(e);

    physics_robots[0].gripper.starts_lifted = true;
    e = physics_start(1);
    physics_drive(e, 0, 0.4, 0);
    p = physics_run(e, 0, 80);
    CU_ASSERT_TRUE(IS(p, MU_GRIPPER_LIFTED));
    CU_ASSERT_DOUBLE_EQUAL(p.pose.x_m, 2 - 0.22, 0.004);
    engine_close(e);
}

static void test_two_robots_want_one_thing(void)
{
    physics_clear();
    add_gripper(0);
    struct world_robot *r = add_gripper(0.84);
    r->pose.heading_rad = M_PI;
    r->gripper.width_m = 0.2; /* its paddles are between the first one's */
    physics_object(0.42, 0, 0.03);
    struct engine *e = physics_start(1);
    CU_ASSERT_EQUAL(engine_grip(e, 1, CLOSE, 0), MU_OK);
    struct engine_sample first = grip(e, CLOSE, 0, 20);
    struct engine_sample second = physics_run(e, 1, 0);
    CU_ASSERT_TRUE(IS(second, MU_GRIPPER_HOLDS));
    CU_ASSERT_EQUAL(first.percept.gripper & (MU_GRIPPER_HOLDS | MU_GRIPPER_CLOSED), 0);
    engine_close(e);

    physics_clear();
    physics_robot(0, 0, 0);
    e = physics_start(1);
    CU_ASSERT_EQUAL(engine_grip(e, 0, CLOSE, 0), MU_ABSENT);
    CU_ASSERT_EQUAL(engine_grip(e, 0, 0, 0), MU_OK);
    engine_close(e);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"it takes, carries and releases", test_it_takes_carries_and_releases},
        {"paddles close on nothing", test_paddles_close_on_nothing_and_stop_at_the_rest},
        {"beams", test_beams},
        {"what is held is solid until it is up", test_what_is_held_is_solid_until_it_is_up},
        {"a load weighs", test_a_load_weighs},
        {"paddles push and have room", test_paddles_push_and_have_room},
        {"two robots want one thing", test_two_robots_want_one_thing},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/gripper", tests);
}
