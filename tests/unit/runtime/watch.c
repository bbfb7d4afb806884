/* SPDX-License-Identifier: Apache-2.0 */
/* What a stranger's program sees of samples: all that is there, and never more than there is room
 * for. */
#include "runtime/watch.h"
#include "muster/memory.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static struct watch_room *room;
static char red[] = "red", none[] = "", rules[] = "go stay", sim[] = "sim";

static void test_scene(void)
{
    float corners_m[8] = {0, 0, 1, 0, 1, 1, 0, 1};
    muster_Outline wall = {.rgb = 7, .flat = true};
    wall.corners_m._buffer = corners_m;
    wall.corners_m._length = 8;
    muster_Figure robot = {.name = red, .color = none, .shape = wall, .x_m = 3, .controlled = true};
    muster_Scene s = {.simulator = sim, .world = red, .seed = 5, .step_ns = 10, .max_x_m = 4};
    s.walls._buffer = &wall;
    s.walls._length = 1;
    s.robots._buffer = &robot;
    s.robots._length = 1;
    const struct mu_scene *seen = watch_scene(room, &s);
    CU_ASSERT_EQUAL(seen->wall_count, 1);
    CU_ASSERT_EQUAL(seen->walls[0].corner_count, 4);
    CU_ASSERT_TRUE(seen->walls[0].flat);
    CU_ASSERT_EQUAL(seen->robot_count, 1);
    READS(seen->robots[0].name, "red");
    CU_ASSERT_TRUE(seen->robots[0].controlled && seen->robots[0].x_m == 3);
    CU_ASSERT_EQUAL(seen->object_count, 0);
    CU_ASSERT(seen->seed == 5 && seen->step_ns == 10 && seen->max_x_m == 4);
}

static muster_Mail mail_of(uint64_t seq)
{
    return letter(red, seq, red, rules);
}

static void test_frame(void)
{
    muster_RobotView view = {.name = red,
                             .state = muster_STATE_SUSPENDED,
                             .x_m = 1,
                             .stalls = 4,
                             .firings = 9,
                             .mails_sent = 8,
                             .mails_received = 7};
    muster_Mail mail = mail_of(12), late = mail_of(13);
    late.layer = 0;
    late.due_ns = 77;
    muster_Act act = {
        .agent = red, .state = muster_STATE_RUNNING, .firings = 2, .rules = rules, .diary = none};
    act.mails._buffer = &mail;
    act.mails._length = 1;
    muster_Frame f = {.simulator = sim, .step = 4, .time_ns = 5, .digest = 6};
    f.robots._buffer = &view;
    f.robots._length = 1;
    f.acts._buffer = &act;
    f.acts._length = 1;
    f.outside._buffer = &late;
    f.outside._length = 1;
    const struct mu_frame *seen = watch_frame(room, &f);
    CU_ASSERT(seen->step == 4 && seen->time_ns == 5 && seen->digest == 6 && seen->cut == 0);
    CU_ASSERT_EQUAL(seen->robots[0].state, MU_SUSPENDED);
    CU_ASSERT(seen->robots[0].stalls == 4 && seen->robots[0].firings == 9);
    CU_ASSERT(seen->robots[0].mails_sent == 8 && seen->robots[0].mails_received == 7);
    READS(seen->acts[0].rules, "go stay");
    CU_ASSERT_EQUAL(seen->acts[0].mail_count, 1);
    CU_ASSERT_EQUAL(seen->acts[0].mails[0].seq, 12);
    CU_ASSERT_FALSE(seen->acts[0].mails[0].directive || seen->acts[0].mails[0].timed);
    CU_ASSERT_EQUAL(seen->outside_count, 1);
    CU_ASSERT_TRUE(seen->outside[0].directive && seen->outside[0].timed);
    CU_ASSERT_EQUAL(seen->outside[0].due_ns, 77);
}

static void test_more_than_there_is_room_for(void)
{
    static muster_Mail mails[MU_WATCH_MAILS_MAX - 10];
    static muster_Act acts[MU_FRAME_ACTS_MAX + 5];
    static muster_RobotView views[MU_ROBOTS_MAX + 5];
    static muster_Outline walls[MU_WATCH_WALLS_MAX + 5];
    size_t count = sizeof mails / sizeof mails[0];
    for (size_t i = 0; i < count; i++) {
        mails[i] = mail_of(i + 1);
    }
    for (size_t i = 0; i < sizeof acts / sizeof acts[0]; i++) {
        acts[i] = (muster_Act){.agent = red, .rules = none, .diary = none};
    }
    for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
        views[i] = (muster_RobotView){.name = red, .state = (muster_State)99};
    }
    acts[0].mails._buffer = acts[1].mails._buffer = mails;
    acts[0].mails._length = acts[1].mails._length = (uint32_t)count;
    muster_Frame f = {.simulator = sim};
    f.acts._buffer = acts;
    f.acts._length = sizeof acts / sizeof acts[0];
    f.robots._buffer = views;
    f.robots._length = sizeof views / sizeof views[0];
    f.outside._buffer = mails;
    f.outside._length = 3;
    const struct mu_frame *seen = watch_frame(room, &f);
    CU_ASSERT_EQUAL(seen->act_count, MU_FRAME_ACTS_MAX);
    CU_ASSERT_EQUAL(seen->robot_count, MU_ROBOTS_MAX);
    CU_ASSERT_EQUAL(seen->robots[0].state, MU_GONE); /* a state that is none */
    CU_ASSERT_EQUAL(seen->acts[0].mail_count, count);
    CU_ASSERT_EQUAL(seen->acts[1].mail_count, 10);
    CU_ASSERT_EQUAL(seen->outside_count, 0);
    CU_ASSERT_EQUAL(seen->cut, count - 10 + 3);
    muster_Scene s = {.simulator = sim, .world = none};
    s.walls._buffer = walls;
    s.walls._length = sizeof walls / sizeof walls[0];
    CU_ASSERT_EQUAL(watch_scene(room, &s)->wall_count, MU_WATCH_WALLS_MAX);
}

int main(void)
{
    room = watch_room_take();
    mu_memory_seal();
    CU_TestInfo tests[] = {
        {"a Scene", test_scene},
        {"a Frame", test_frame},
        {"more than there is room for", test_more_than_there_is_room_for},
        CU_TEST_INFO_NULL,
    };
    return suite_run("what a watch hands out", tests);
}
