/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Crowds that press: against a wall, head on, and all towards one place.  MUSTER_ROBOTS and
 * MUSTER_SECONDS make the last one larger (make soak-crush).
 */
#include "physics.h"
#include "sim/geometry/geometry.h"
#include "suite.h"

#define OVERLAP_MAX_M 0.010
#define ROOM_M2       1.6 /* for each robot, so that it takes a while until they meet */

enum { ROBOTS = 60, SECONDS = 20 };

static struct world_robot crowd[MU_ROBOTS_MAX];
static struct solid outlines[MU_ROBOTS_MAX];
static bool is_sound;

static struct solid outline_of(const struct engine *e, size_t i)
{
    const struct world_robot *r = &physics_world.robots[i];
    return solid_box(engine_pose(e, i), r->length_m / 2, r->width_m / 2);
}

static double depth_of(const struct solid *a, const struct solid *b)
{
    struct narrow_contact contact;
    narrow_collide(a, b, &contact);
    return narrow_depth(&contact);
}

/* The deepest that anything lies in anything else; notes a NaN, a tilt, and who is outside. */
static double look_for_overlap(const struct engine *e, double half_m)
{
    double deepest = 0;
    size_t robots = physics_world.robot_count;
    for (size_t i = 0; i < robots; i++) {
        outlines[i] = outline_of(e, i);
        is_sound = is_sound && fabs(outlines[i].x) < half_m && fabs(outlines[i].y) < half_m;
    }
    for (size_t i = 0; i < robots; i++) {
        for (size_t k = i + 1; k < robots; k++) {
            deepest = fmax(deepest, depth_of(&outlines[i], &outlines[k]));
        }
        for (size_t k = 0; k < physics_world.shape_count; k++) {
            struct solid wall = solid_of_shape(&physics_world.shapes[k]);
            deepest = fmax(deepest, depth_of(&outlines[i], &wall));
        }
    }
    is_sound = is_sound && physics_is_flat(e);
    return deepest;
}

static void steer_to_the_middle(struct engine *e, size_t i)
{
    struct world_pose pose = engine_pose(e, i);
    double bearing = atan2(-pose.y_m, -pose.x_m);
    physics_drive(e, i, PHYSICS_SPEED_M_S, 2 * remainder(bearing - pose.heading_rad, 2 * M_PI));
}

static void test_a_heap(void)
{
    size_t robots = (size_t)suite_setting("MUSTER_ROBOTS", ROBOTS);
    unsigned seconds = (unsigned)suite_setting("MUSTER_SECONDS", SECONDS);
    CU_ASSERT_FATAL(robots <= MU_ROBOTS_MAX);
    size_t side = (size_t)ceil(sqrt((double)robots));
    double half_m = sqrt((double)robots * ROOM_M2) / 2;
    physics_clear();
    physics_fence(half_m);
    struct world_robot like = *physics_robot(0, 0, 0);
    physics_world.robots = crowd;
    physics_world.robot_count = robots;
    for (size_t i = 0; i < robots; i++) {
        crowd[i] = like;
        crowd[i].pose.x_m = ((double)(i % side) + 0.5) / (double)side * 2 * half_m - half_m;
        crowd[i].pose.y_m = ((double)(i / side) + 0.5) / (double)side * 2 * half_m - half_m;
        crowd[i].pose.heading_rad = (double)i;
    }
    struct engine *e = physics_start(1);
    double deepest = 0;
    is_sound = true;
    for (unsigned k = 0; k < seconds * 10; k++) {
        for (size_t i = 0; i < robots; i++) {
            steer_to_the_middle(e, i);
        }
        engine_step(e);
        deepest = fmax(deepest, look_for_overlap(e, half_m));
    }
    size_t stalled = 0;
    size_t faults = 0;
    for (size_t i = 0; i < robots; i++) {
        struct engine_sample p = physics_run(e, i, 0);
        stalled += p.percept.stalled;
        faults += p.percept.fault;
    }
    printf("%zu robots, %u s: %.1f mm deep, %zu stalled ", robots, seconds, deepest * 1e3, stalled);
    CU_ASSERT(deepest <= OVERLAP_MAX_M);
    CU_ASSERT(stalled > robots / 4); /* it is a heap */
    CU_ASSERT_EQUAL(faults, 0);
    CU_ASSERT_TRUE(is_sound);
    engine_close(e);
}

static void test_against_a_wall_and_head_on(void)
{
    physics_clear();
    physics_fence(4);
    for (int i = 0; i < 3; i++) {
        struct world_robot *r = physics_robot(3, 2 * i - 2, 0); /* against the wall */
        r->forward_max_m_s = 0.5 * (i + 1);
    }
    for (int i = 0; i < 3; i++) { /* head on, the second a little aside, the third much */
        for (int k = 0; k < 2; k++) {
            physics_robot(k ? 0 : -3, 2 * i - 2 + 0.15 * i * k, 180 * k);
        }
    }
    struct engine *e = physics_start(1);
    double deepest = 0;
    is_sound = true;
    for (unsigned k = 0; k < 300; k++) {
        for (size_t i = 0; i < physics_world.robot_count; i++) {
            physics_drive(e, i, 10, 0);
        }
        engine_step(e);
        deepest = fmax(deepest, look_for_overlap(e, 4));
    }
    printf("%.1f mm deep ", deepest * 1e3);
    CU_ASSERT(deepest <= OVERLAP_MAX_M);
    CU_ASSERT_TRUE(is_sound);
    for (size_t i = 0; i < 3; i++) {
        CU_ASSERT_TRUE(physics_run(e, i, 0).percept.stalled);
    }
    engine_close(e);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"against a wall and head on", test_against_a_wall_and_head_on},
        {"a heap", test_a_heap},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/crush", tests);
}
