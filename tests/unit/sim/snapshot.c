/* SPDX-License-Identifier: Apache-2.0 */
/* A run that goes on from a snapshot is the run that it was taken of, bit for bit. */
#include "physics.h"
#include "suite.h"

enum { STEPS = 500, SAVED_AT = 250, ROOM = 1 << 16, HEAD = 5 * 8 };

static unsigned char saved[ROOM];
static unsigned char bytes[ROOM];

/* A crowd that pushes, carries, slips, gets tired and is pushed. */
static struct engine *start_crowd(uint64_t seed)
{
    physics_clear();
    physics_fence(2.5);
    for (int i = 0; i < 4; i++) {
        struct world_robot *r = physics_robot(-1.5, i - 1.5, 5 * i);
        r->gripper = (struct world_gripper){.pose = {0.27, 0, 0},
                                            .length_m = 0.1,
                                            .width_m = 0.3,
                                            .paddle_length_m = 0.2,
                                            .paddle_width_m = 0.04};
        r->origin_x_m = -0.04;
        r->gps_drift_m = 0.05;
        r->gps_noise_m = 0.1;
        r->compass_noise_rad = 0.1;
        r->odometry.forward_error = 0.1;
        r->odometry.turn_error = 0.1;
        r->battery_j = 1000 - 200 * i; /* one of them ends */
        r->battery_max_j = 1000;
        r->power_w = 10;
    }
    for (int k = 0; k < 9; k++) {
        struct world_object *o = physics_object(-1.03 + k % 3 * 0.6, k / 3 * 1 - 1.5, 0.07);
        o->shape.kind = k % 2 ? WORLD_DISC : WORLD_BOX;
    }
    return physics_start(seed);
}

static uint64_t mix(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (hash ^ bits) * 1099511628211ull;
}

static uint64_t feel(struct engine *e, uint64_t hash)
{
    for (size_t i = 0; i < 4; i++) {
        struct engine_sample p = physics_sense(e, i);
        const double felt[] = {
            p.percept.x_m,           p.percept.gps_y_m,      p.percept.compass_rad,
            p.percept.odometer_x_m,  p.percept.odometer_y_m, p.percept.odometer_heading_rad,
            p.percept.stalled,       p.percept.bumpers,      p.percept.gripper,
            p.percept.battery_share, p.percept.forward_m_s,  p.percept.fault};
        for (size_t k = 0; k < sizeof felt / sizeof felt[0]; k++) {
            hash = mix(hash, felt[k]);
        }
    }
    return hash;
}

/* What happens depends on the number of the step alone. */
static uint64_t live(struct engine *e, unsigned from, unsigned to, bool *held)
{
    uint64_t hash = 1469598103934665603ull;
    for (unsigned k = from; k < to; k++) {
        for (size_t i = 0; i < 4; i++) {
            physics_drive(e, i,
                          k % 50 < 10   ? 0
                          : k % 50 < 38 ? 0.4
                                        : -0.3,
                          k > 30 ? (double)((k / 30 + i) % 3) - 1 : 0);
            int32_t lift = k % 120 > 20 && k % 120 < 70 ? 1 : -1;
            hash = mix(hash, engine_grip(e, i, k % 120 < 80 ? 1 : -1, lift));
        }
        if (k % 50 == 45) {
            physics_push(e, k / 50 % 2 ? 3 : 2, 30, 1);
        }
        engine_step(e);
        hash = feel(e, physics_hash(e, hash));
        for (size_t i = 0; i < 4; i++) {
            struct engine_sample p = physics_sense(e, i);
            *held = *held || (p.percept.gripper & MU_GRIPPER_HOLDS) != 0;
        }
    }
    return hash;
}

static void test_it_goes_on_as_if_nothing_had_been(void)
{
    const char *reason = NULL;
    bool held = false;
    struct engine *e = start_crowd(1);
    size_t size = engine_save_size(e);
    CU_ASSERT_FATAL(size <= ROOM);
    (void)live(e, 0, SAVED_AT, &held);
    CU_ASSERT_TRUE(held);
    engine_save(e, saved);
    uint64_t whole = live(e, SAVED_AT, STEPS, &held);

    /* Back in time in the same engine: another day in between must leave no trace. */
    CU_ASSERT_EQUAL(engine_restore(e, saved, size, &reason), MU_OK);
    CU_ASSERT_EQUAL(live(e, SAVED_AT, STEPS, &held), whole);
    engine_close(e);

    e = start_crowd(1);
    CU_ASSERT_EQUAL(engine_restore(e, saved, size, &reason), MU_OK);
    engine_save(e, bytes);
    CU_ASSERT_EQUAL(memcmp(bytes, saved, size), 0);
    CU_ASSERT_EQUAL(live(e, SAVED_AT, STEPS, &held), whole);
    engine_close(e);

    e = start_crowd(1);
    CU_ASSERT_NOT_EQUAL(live(e, SAVED_AT, STEPS, &held), whole); /* it is not all the commands */
    engine_close(e);
}

/* In each phase of a grip, of a push and of a battery's end. */
static void test_at_any_step(void)
{
    const char *reason;
    bool held = false;
    for (unsigned at = 3; at < 300; at += 27) {
        struct engine *e = start_crowd(2);
        (void)live(e, 0, at, &held);
        engine_save(e, saved);
        uint64_t whole = live(e, at, at + 60, &held);
        engine_close(e);
        e = start_crowd(2);
        CU_ASSERT_EQUAL(engine_restore(e, saved, engine_save_size(e), &reason), MU_OK);
        CU_ASSERT_EQUAL(live(e, at, at + 60, &held), whole);
        engine_close(e);
    }
}

/* Makes the last number the sum of all before it, as an attacker would. */
static void seal(size_t size)
{
    uint64_t sum = 14695981039346656037ull;
    for (size_t i = 0; i < size - 8; i++) {
        sum = (sum ^ bytes[i]) * 1099511628211ull;
    }
    for (unsigned i = 0; i < 8; i++) {
        bytes[size - 8 + i] = (unsigned char)(sum >> (8 * i));
    }
}

static void check_refused(struct engine *e, size_t size, mu_result want)
{
    const char *reason = NULL;
    uint64_t before = feel(e, physics_hash(e, 1));
    CU_ASSERT_EQUAL(engine_restore(e, bytes, size, &reason), want);
    CU_ASSERT_PTR_NOT_NULL(reason);
    CU_ASSERT_EQUAL(feel(e, physics_hash(e, 1)), before);
}

static void test_what_is_broken_changes_nothing(void)
{
    bool held = false;
    struct engine *e = start_crowd(1);
    size_t size = engine_save_size(e);
    (void)live(e, 0, 20, &held);
    engine_save(e, saved);
    (void)live(e, 20, 30, &held);
    for (size_t i = 0; i < size; i += 7) {
        memcpy(bytes, saved, size);
        bytes[i] ^= 0x10;
        check_refused(e, size, i >= 16 && i < 24 ? MU_REFUSED : MU_MALFORMED);
    }
    memcpy(bytes, saved, size);
    for (size_t shorter = 0; shorter < size; shorter += 61) {
        check_refused(e, shorter, MU_MALFORMED);
    }
    check_refused(e, size + 8, MU_MALFORMED);
    engine_close(e);
}

/* Numbers that are sealed well and yet none: never into the solver. */
static void test_poison_is_refused(void)
{
    static const double poison[] = {(double)NAN, (double)INFINITY, 1e300};
    const char *reason;
    bool held = false;
    struct engine *e = start_crowd(1);
    size_t size = engine_save_size(e);
    (void)live(e, 0, 20, &held);
    engine_save(e, saved);
    size_t taken = 0;
    for (size_t i = HEAD; i < size - 8; i += 8) {
        for (size_t k = 0; k < 3; k++) {
            memcpy(bytes, saved, size);
            memcpy(&bytes[i], &poison[k], 8);
            seal(size);
            if (engine_restore(e, bytes, size, &reason) == MU_OK) { /* a counter may be anything */
                taken++;
                (void)live(e, 20, 21, &held);
            }
        }
    }
    CU_ASSERT(taken < 60);
    for (size_t b = 0; b < engine_body_count(e); b++) {
        CU_ASSERT(fabs(engine_pose(e, b).x_m) < 3);
    }
    engine_close(e);
}

/* What the sensors read is not part of it: who goes on looks anew, in whatever process. */
static void test_sensors_look_anew(void)
{
    const char *reason;
    physics_clear();
    physics_wall(5, 0, 0.1, 4);
    struct world_robot *r = physics_robot(0, 0, 0);
    r->laser = (struct world_laser){.range_max_m = 8, .fov_rad = 1, .samples = 3};
    r->period_ns[MU_SENSOR_LASER] = 10000000000;
    struct engine *e = physics_start(1);
    CU_ASSERT_DOUBLE_EQUAL((double)physics_run(e, 0, 1).percept.laser_m[1], 4.9, 1e-6);
    physics_drive(e, 0, 0.5, 0);
    struct engine_sample p = physics_run(e, 0, 20);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.laser_m[1], 4.9, 1e-6); /* it stands */
    CU_ASSERT(p.pose.x_m > 0.5);
    size_t size = engine_save_size(e);
    CU_ASSERT_FATAL(size <= ROOM);
    engine_save(e, bytes);
    CU_ASSERT_EQUAL(engine_restore(e, bytes, size, &reason), MU_OK);
    p = physics_run(e, 0, 0);
    CU_ASSERT_DOUBLE_EQUAL((double)p.percept.laser_m[1], 4.9 - p.pose.x_m, 1e-6);
    engine_close(e);
}

static void test_another_world_is_refused(void)
{
    struct engine *e = start_crowd(1);
    size_t size = engine_save_size(e);
    engine_save(e, bytes);
    engine_close(e);
    e = start_crowd(2);
    check_refused(e, size, MU_REFUSED);
    engine_close(e);
    e = start_crowd(1);
    engine_close(e);
    physics_objects[3].mass_kg *= 2;
    e = physics_start(1);
    check_refused(e, size, MU_REFUSED);
    engine_close(e);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"it goes on as if nothing had been", test_it_goes_on_as_if_nothing_had_been},
        {"at any step", test_at_any_step},
        {"sensors look anew", test_sensors_look_anew},
        {"what is broken changes nothing", test_what_is_broken_changes_nothing},
        {"poison is refused", test_poison_is_refused},
        {"another world is refused", test_another_world_is_refused},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/snapshot", tests);
}
