/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What an agent is shown of its body's sensors, and how it says which of them it wants and what its
 * gripper is to do; without a network.
 */
#include "capture.h"
#include "runtime/process.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>

static mu_process process;
static muster_Percept percept;
static muster_Sense sense;
static struct mu_percept got;
static float laser_m[3] = {0.5f, 4.0f, 8.0f};
static muster_Blob blobs[2] = {{0xff0000, 0.25, 0.125, 1.5}, {0x00ff00, -0.5, 0.25, 3.0}};
static muster_Fiducial fiducials[1] = {{-7, 0.75, 2.5, -1.25}};

/* idlc makes no const members; the runtime writes to none. */
static char *words(const char *s)
{
    return (char *)(uintptr_t)s;
}

static void on_step(void *self, mu_agent *a, const struct mu_percept *p)
{
    (void)self;
    (void)a;
    got = *p;
}

static struct mu_agent *join(enum mu_kind kind)
{
    struct mu_agent *a = NULL;
    struct mu_handlers handlers = {.on_step = on_step};
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &a, "red", kind, 0, &handlers), MU_OK);
    a->state = MU_RUNNING;
    return a;
}

static void set_up(void)
{
    memset(&process, 0, sizeof process);
    process.role = PROCESS_BODY;
    process_take_memory(&process, 1, 2);
    percept = (muster_Percept){.robot = words("red"), .battery_share = -1};
    sense = (muster_Sense){.process = words("p1"), .step = 7};
    sense.robots._buffer = &percept;
    sense.robots._length = 1;
}

/* The act of the only agent in its answer to a step. */
static const muster_Act *answer(void)
{
    static const muster_Delivery nothing;
    capture_begin();
    (void)process_step_on(&process, STEP_LOCKSTEP);
    step_live(&process, &sense, &nothing);
    capture_end();
    CU_ASSERT_EQUAL_FATAL(process.out.acts._length, 1);
    process.up_state = UP_NONE;
    return process.out.acts._buffer;
}

static void test_a_percept_has_every_sense(void)
{
    (void)join(MU_KIND_ROBOT);
    percept.fault = true;
    percept.gps_x_m = 1;
    percept.gps_y_m = 2;
    percept.compass_rad = 3;
    percept.odometer_x_m = 4;
    percept.odometer_y_m = 5;
    percept.odometer_heading_rad = 6;
    percept.bumpers = 0x81;
    percept.gripper = MU_GRIPPER_THERE | MU_GRIPPER_HOLDS;
    percept.battery_share = 0.5;
    percept.laser_m._buffer = laser_m;
    percept.laser_m._length = 3;
    percept.blobs._buffer = blobs;
    percept.blobs._length = 2;
    percept.fiducials._buffer = fiducials;
    percept.fiducials._length = 1;
    (void)answer();
    CU_ASSERT(got.fault && got.bumpers == 0x81 && got.gripper == 33);
    const double numbers[] = {got.gps_x_m,      got.gps_y_m,      got.compass_rad,
                              got.odometer_x_m, got.odometer_y_m, got.odometer_heading_rad};
    for (int i = 0; i < 6; i++) {
        CU_ASSERT_DOUBLE_EQUAL(numbers[i], i + 1, 0);
    }
    CU_ASSERT_DOUBLE_EQUAL(got.battery_share, 0.5, 0);
    CU_ASSERT(got.laser_count == 3 && got.laser_m == laser_m);
    CU_ASSERT_EQUAL_FATAL(got.blob_count, 2);
    CU_ASSERT_EQUAL(got.blobs[1].rgb, 0x00ff00);
    CU_ASSERT_DOUBLE_EQUAL(got.blobs[1].bearing_rad, -0.5, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.blobs[1].width_rad, 0.25, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.blobs[1].range_m, 3.0, 0);
    CU_ASSERT_EQUAL_FATAL(got.fiducial_count, 1);
    CU_ASSERT_EQUAL(got.fiducials[0].number, -7);
    CU_ASSERT_DOUBLE_EQUAL(got.fiducials[0].bearing_rad, 0.75, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.fiducials[0].range_m, 2.5, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.fiducials[0].heading_rad, -1.25, 0);
}

static void test_what_is_wanted_is_said_with_each_act(void)
{
    struct mu_agent *red = join(MU_KIND_ROBOT);
    CU_ASSERT_EQUAL(answer()->senses, MU_SENSE_SONAR); /* of who says nothing */
    memset(&process.roll, 0, sizeof process.roll);     /* as if written */
    mu_agent_senses(red, MU_SENSE_SONAR);
    CU_ASSERT_EQUAL(process.roll.due_count, 0); /* no news */
    mu_agent_senses(red, MU_SENSE_LASER | MU_SENSE_CAMERA | 0x100);
    CU_ASSERT_EQUAL(process.roll.due_count, 1);
    CU_ASSERT_EQUAL(answer()->senses, MU_SENSE_LASER | MU_SENSE_CAMERA);
    red->state = MU_SUSPENDED; /* it is shown on, to who looks at it */
    CU_ASSERT_EQUAL(answer()->senses, MU_SENSE_LASER | MU_SENSE_CAMERA);
    mu_agent_senses(red, 0);
    CU_ASSERT_EQUAL(answer()->senses, 0);
}

static void test_an_agent_without_a_body_wants_nothing(void)
{
    (void)join(MU_KIND_AGENT);
    CU_ASSERT_EQUAL(answer()->senses, 0);
}

static void test_orders_to_the_gripper(void)
{
    struct mu_agent *red = join(MU_KIND_ROBOT);
    const muster_Act *act = answer();
    CU_ASSERT(act->paddles == 0 && act->lift == 0);
    CU_ASSERT_EQUAL(mu_agent_grip(red, MU_PADDLES_CLOSE, MU_LIFT_KEEP), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_grip(red, MU_PADDLES_KEEP, MU_LIFT_UP), MU_OK);
    act = answer();
    CU_ASSERT(act->paddles == 1 && act->lift == 1);
    CU_ASSERT_EQUAL(mu_agent_grip(red, MU_PADDLES_OPEN, MU_LIFT_DOWN), MU_OK);
    act = answer();
    CU_ASSERT(act->paddles == -1 && act->lift == -1);
    red->state = MU_SUSPENDED;
    act = answer();
    CU_ASSERT(act->paddles == 0 && act->lift == 0);
}

static void test_orders_that_are_none(void)
{
    struct mu_agent *red = join(MU_KIND_ROBOT);
    CU_ASSERT_EQUAL(mu_agent_grip(red, (enum mu_paddles)2, MU_LIFT_UP), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_grip(red, MU_PADDLES_OPEN, (enum mu_lift)(-2)), MU_MALFORMED);
    const muster_Act *act = answer();
    CU_ASSERT(act->paddles == 0 && act->lift == 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a percept has every sense", test_a_percept_has_every_sense},
        {"what is wanted is said with each act", test_what_is_wanted_is_said_with_each_act},
        {"an agent without a body wants nothing", test_an_agent_without_a_body_wants_nothing},
        {"orders to the gripper", test_orders_to_the_gripper},
        {"orders that are none", test_orders_that_are_none},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/senses", NULL, NULL, set_up, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
