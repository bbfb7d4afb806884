/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Random worlds in which everything happens at once: drives, grips, pushes, new places, resets,
 * snapshots.  Whatever it is, bodies stay finite, flat and inside, and a snapshot is the same run.
 * MUSTER_WORLDS: how many, instead of 24.
 */
#include "capture.h"
#include "core/random.h"
#include "physics.h"
#include "suite.h"

#define HALF_M 2.5

enum { ROOM = 1 << 16, STEPS = 100 };

static struct mu_random dice;
static unsigned char saved[ROOM];

static double between(double lo, double hi)
{
    return lo + (hi - lo) * mu_random_unit(&dice);
}

static bool one_in(int64_t n)
{
    return mu_random_between(&dice, 1, n) == 1;
}

static struct world_pose any_pose(void)
{
    struct world_pose pose;
    pose.x_m = between(-HALF_M, HALF_M);
    pose.y_m = between(-HALF_M, HALF_M);
    pose.heading_rad = between(-M_PI, M_PI);
    return pose;
}

/* They may start in each other and in the walls: the physics must get them out. */
static struct engine *any_world(uint64_t seed)
{
    mu_random_seed(&dice, seed, "world");
    physics_clear();
    physics_fence(HALF_M);
    for (int64_t i = mu_random_between(&dice, 1, 7); i > 0; i--) {
        struct world_robot *r = physics_robot(0, 0, 0);
        r->pose = any_pose();
        r->length_m = between(0.1, 0.8);
        r->width_m = between(0.1, 0.6);
        r->mass_kg = between(0.5, 40);
        r->forward_max_m_s = between(0.1, 3);
        r->forward_accel_m_s2 = between(0.1, 5);
        r->battery_j = r->battery_max_j = one_in(3) ? between(1, 100) : 0;
        r->power_w = 5;
        if (one_in(2)) {
            r->gripper = (struct world_gripper){.pose = {r->length_m / 2 + 0.05, 0, 0},
                                                .length_m = 0.1,
                                                .width_m = between(0.2, 0.5),
                                                .paddle_length_m = between(0.05, 0.3),
                                                .paddle_width_m = between(0.02, 0.06),
                                                .starts_closed = one_in(4),
                                                .starts_lifted = one_in(4)};
        }
    }
    for (int64_t k = mu_random_between(&dice, 0, 14); k > 0; k--) {
        struct world_object *o = physics_object(0, 0, between(0.02, 0.3));
        o->shape.pose = any_pose();
        o->shape.kind = one_in(2) ? WORLD_DISC : WORLD_BOX;
        o->shape.half_y_m = between(0.02, 0.3);
        o->mass_kg = between(0.01, 20);
        o->friction = between(0, 2);
        o->shape.look.stops = !one_in(6);
        o->shape.look.give_w = one_in(3) ? 20 : 0;
    }
    return physics_start(seed);
}

/* One thing that somebody outside does; refused or not, it must do no harm. */
static mu_result meddle(struct engine *e)
{
    const char *reason;
    size_t body = (size_t)mu_random_between(&dice, 0, (int64_t)engine_body_count(e) - 1);
    struct engine_force force = {between(-50, 50), between(-50, 50), between(-5, 5), 0};
    force.time_s = one_in(2) ? between(0, 1) : 0;
    if (one_in(20)) {
        force.x_n = 1e5;
    }
    switch (mu_random_between(&dice, 0, 5)) {
    case 0: return engine_place(e, body, any_pose(), &reason);
    case 1: return engine_reset(e, body, &reason);
    case 2: engine_reset_all(e); return MU_OK;
    default: return engine_push(e, body, &force, &reason);
    }
}

static uint64_t live(struct engine *e, unsigned steps)
{
    uint64_t hash = 1469598103934665603ull;
    for (unsigned k = 0; k < steps; k++) {
        for (size_t i = 0; i < physics_world.robot_count; i++) {
            physics_drive(e, i, between(-4, 4), between(-2, 2));
            int32_t paddles = (int32_t)mu_random_between(&dice, -1, 1);
            hash = hash * 31 + (uint64_t)engine_grip(e, i, paddles, one_in(9) ? -1 : one_in(9));
        }
        if (one_in(10)) {
            hash = hash * 31 + (uint64_t)meddle(e);
        }
        engine_step(e);
        hash = physics_hash(e, hash);
    }
    return hash;
}

static bool is_sound(struct engine *e)
{
    size_t held = 0;
    bool sound = physics_is_flat(e);
    for (size_t b = 0; b < engine_body_count(e); b++) {
        struct world_pose p = engine_pose(e, b);
        sound = sound && fabs(p.x_m) <= HALF_M + 0.5 && fabs(p.y_m) <= HALF_M + 0.5;
        sound = sound && isfinite(p.heading_rad);
    }
    for (size_t i = 0; i < physics_world.robot_count; i++) {
        struct engine_sample p = physics_sense(e, i);
        held += (p.percept.gripper & MU_GRIPPER_HOLDS) != 0;
        sound = sound &&
                isfinite(p.percept.forward_m_s + p.percept.turn_rad_s + p.percept.battery_share);
        sound = sound && p.percept.battery_share <= 1 && p.percept.bumpers < 256;
    }
    return sound && held <= physics_world.object_count;
}

/* Half a life, a snapshot, the other half; then the other half once more, in a new engine. */
static void check_world(uint64_t seed)
{
    const char *reason;
    struct engine *e = any_world(seed);
    CU_ASSERT_FATAL(engine_save_size(e) <= ROOM);
    (void)live(e, STEPS / 2);
    CU_ASSERT(is_sound(e));
    engine_save(e, saved);
    mu_random_seed(&dice, seed, "second half");
    uint64_t first = live(e, STEPS / 2);
    CU_ASSERT(is_sound(e));
    engine_close(e);

    e = any_world(seed);
    CU_ASSERT_EQUAL(engine_restore(e, saved, engine_save_size(e), &reason), MU_OK);
    mu_random_seed(&dice, seed, "second half");
    CU_ASSERT_EQUAL(live(e, STEPS / 2), first);
    engine_close(e);
}

static void test_any_world(void)
{
    uint64_t worlds = suite_setting("MUSTER_WORLDS", 24);
    capture_begin(); /* some are flung out, as they should be */
    for (uint64_t seed = 1; seed <= worlds; seed++) {
        physics_engines_used = worlds > 24 ? 0 : physics_engines_used;
        check_world(seed);
    }
    capture_end();
}

int main(void)
{
    CU_TestInfo tests[] = {{"any world", test_any_world}, CU_TEST_INFO_NULL};
    return suite_run("sim/any", tests);
}
