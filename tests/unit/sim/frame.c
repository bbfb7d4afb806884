/* SPDX-License-Identifier: Apache-2.0 */
/* What observers are told of a small world: totals, the Scene, a Frame. */
#include "bus/bus.h"
#include "core/rounded.h"
#include "muster/memory.h"
#include "physics.h"
#include "samples.h"
#include "sim/record/record.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>

static const double NEAR = 1e-6;

/* --- totals ----------------------------------------------------------------------------------- */

static struct tally tally_of(const struct engine_sample *steps, size_t count)
{
    struct tally t = {0};
    for (size_t i = 0; i < count; i++) {
        tally_take(&t, i * PHYSICS_STEP_NS, PHYSICS_STEP_NS, &steps[i]);
    }
    return t;
}

static void test_distance_is_what_the_rows_add_up_to(void)
{
    const struct engine_sample steps[] = {
        {.pose = {7, 7, 0}}, {.pose = {10, 11, 0}}, {.pose = {10, 11, 2}}, {.pose = {9, 11, 2}}};
    CU_ASSERT_DOUBLE_EQUAL(tally_of(steps, 1).distance_m, 0, 0);
    CU_ASSERT_DOUBLE_EQUAL(tally_of(steps, 2).distance_m, 5, 0);
    CU_ASSERT_DOUBLE_EQUAL(tally_of(steps, 4).distance_m, 6, 0);
    const struct engine_sample placed[] = {{.pose = {1, 1, 0}},
                                           {.pose = {8, 1, 0}, .placed = true}};
    CU_ASSERT_DOUBLE_EQUAL(tally_of(placed, 2).distance_m, 0, 0);
    /* What has less than six decimals is not in run.csv, and so it is no way. */
    const struct engine_sample still[] = {{.pose = {1, 1, 0}}, {.pose = {1 + 4e-7, 1, 0}}};
    CU_ASSERT_DOUBLE_EQUAL(tally_of(still, 2).distance_m, 0, 0);
    CU_ASSERT_DOUBLE_EQUAL(mu_rounded(1.2345678), 1.234568, 0);
    CU_ASSERT_DOUBLE_EQUAL(mu_rounded(-0.1234565), strtod("-0.123457", NULL), 0);
}

static void test_a_stall_counts_once_and_lasts(void)
{
    static const bool stalled[] = {true, true, false, false, true, true};
    struct engine_sample steps[6] = {{.placed = false}};
    for (size_t i = 0; i < 6; i++) {
        steps[i].percept.stalled = stalled[i];
    }
    CU_ASSERT_EQUAL(tally_of(steps, 1).stalls, 1);
    CU_ASSERT_DOUBLE_EQUAL(tally_of(steps, 1).stalled_s, 0.1, NEAR);
    CU_ASSERT_EQUAL(tally_of(steps, 4).stalls, 1);
    CU_ASSERT_DOUBLE_EQUAL(tally_of(steps, 4).stalled_s, 0.2, NEAR);
    CU_ASSERT_EQUAL(tally_of(steps, 6).stalls, 2);
    CU_ASSERT_DOUBLE_EQUAL(tally_of(steps, 6).stalled_s, 0.4, NEAR);
}

/* --- the Scene -------------------------------------------------------------------------------- */

/* Expects the corners of an outline, counter-clockwise from the front left one. */
static void expect_corners(const muster_Outline *o, const double corners_m[8])
{
    CU_ASSERT_EQUAL_FATAL(o->corners_m._length, 8);
    for (size_t i = 0; i < 8; i++) {
        CU_ASSERT_DOUBLE_EQUAL((double)o->corners_m._buffer[i], corners_m[i], NEAR);
    }
}

static void scene_world(void)
{
    physics_clear();
    physics_wall(1, 2, 3, 0.5)->look.rgb = 0x123456;
    physics_wall(0, 0, 2, 1)->pose.heading_rad = M_PI / 2;
    struct world_shape *disc = physics_wall(-4, -5, 0, 0);
    disc->kind = WORLD_DISC;
    disc->radius_m = 0.75;
    struct world_robot *r = physics_robot(1, -1, 90);
    r->origin_x_m = -0.04;
    snprintf(r->color, sizeof r->color, "red");
    (void)physics_sonar(r);
    *physics_sonar(r) =
        (struct world_sonar){.pose = {0.1, 0.2, 0.3}, .range_max_m = 5, .fov_rad = 0.5};
    physics_robot(2, 2, 0)->laser =
        (struct world_laser){.pose = {0.05, 0, 0}, .range_max_m = 8, .fov_rad = 3, .samples = 180};
    physics_object(3, 3, 0.25)->shape.look.rgb = 0xff8000;
    snprintf(physics_world.file, sizeof physics_world.file, "some/folder/small.world");
    physics_world.max_x_m = 10;
}

static void test_walls(void)
{
    scene_world();
    const muster_Scene *s = scene_make(&physics_world);
    READS(s->world, "small.world");
    CU_ASSERT_DOUBLE_EQUAL(s->max_x_m, 10, 0);
    CU_ASSERT_EQUAL_FATAL(s->walls._length, 3);
    expect_corners(&s->walls._buffer[0], (const double[]){4, 2.5, -2, 2.5, -2, 1.5, 4, 1.5});
    expect_corners(&s->walls._buffer[1], (const double[]){-1, 2, -1, -2, 1, -2, 1, 2});
    CU_ASSERT_EQUAL(s->walls._buffer[0].rgb, 0x123456);
    const muster_Outline *disc = &s->walls._buffer[2];
    CU_ASSERT_DOUBLE_EQUAL(disc->radius_m, 0.75, 0);
    CU_ASSERT_EQUAL_FATAL(disc->corners_m._length, 2);
    CU_ASSERT_DOUBLE_EQUAL((double)disc->corners_m._buffer[0], -4, NEAR);
    CU_ASSERT_DOUBLE_EQUAL((double)disc->corners_m._buffer[1], -5, NEAR);
}

static void test_figures(void)
{
    scene_world();
    const muster_Scene *s = scene_make(&physics_world);
    CU_ASSERT_EQUAL_FATAL(s->robots._length, 2);
    const muster_Figure *r = &s->robots._buffer[0];
    READS(r->name, "robot0");
    READS(r->color, "red");
    CU_ASSERT_DOUBLE_EQUAL(r->x_m, 1, 0);
    CU_ASSERT_DOUBLE_EQUAL(r->heading_rad, M_PI / 2, NEAR);
    expect_corners(&r->shape, (const double[]){0.18, 0.19, -0.26, 0.19, -0.26, -0.19, 0.18, -0.19});
    CU_ASSERT_EQUAL_FATAL(r->sonars._length, 2);
    CU_ASSERT_EQUAL(r->lasers._length, 0);
    CU_ASSERT_DOUBLE_EQUAL(r->sonars._buffer[1].y_m, 0.2, 0);
    CU_ASSERT_DOUBLE_EQUAL(r->sonars._buffer[1].range_m, 5, 0);
    CU_ASSERT_EQUAL(r->sonars._buffer[1].beams, 1);
    const muster_Figure *other = &s->robots._buffer[1];
    CU_ASSERT_EQUAL(other->sonars._length, 0);
    CU_ASSERT_EQUAL_FATAL(other->lasers._length, 1);
    CU_ASSERT_EQUAL(other->lasers._buffer[0].beams, 180);
    CU_ASSERT_DOUBLE_EQUAL(other->lasers._buffer[0].fov_rad, 3, 0);
    CU_ASSERT_EQUAL_FATAL(s->objects._length, 1);
    const muster_Figure *o = &s->objects._buffer[0];
    READS(o->name, "object0");
    READS(o->color, "#ff8000");
    CU_ASSERT_DOUBLE_EQUAL(o->x_m, 3, 0);
    expect_corners(&o->shape, (const double[]){0.25, 0.25, -0.25, 0.25, -0.25, -0.25, 0.25, -0.25});
}

/* --- a Frame ---------------------------------------------------------------------------------- */

static struct frame_builder *view;

static struct frame_builder *view_start(void)
{
    static struct frame_builder *kept[16]; /* so that leak checkers see them */
    static size_t count;
    physics_clear();
    physics_robot(0, 0, 0);
    physics_robot(2, 0, 0);
    physics_object(1, 1, 0.1);
    CU_ASSERT_FATAL(count < sizeof kept / sizeof kept[0]);
    return kept[count++] = frame_open(&physics_world, "simulator.1", 2);
}

static muster_Act act_of(const char *agent, const char *rules, muster_Mail *mails, uint32_t count)
{
    muster_Act act = {.agent = words(agent),
                      .rules = words(rules),
                      .goal = words("stay"),
                      .diary = words(""),
                      .firings = 1};
    act.mails = (dds_sequence_muster_Mail){._length = count, ._buffer = mails};
    return act;
}

static void test_bodies_and_percepts(void)
{
    view = view_start();
    const struct engine_sample moving = {.pose = {1, 2, 3},
                                         .percept = {.x_m = 9,
                                                     .y_m = 9,
                                                     .heading_rad = 9,
                                                     .forward_m_s = 0.25,
                                                     .turn_rad_s = -1,
                                                     .stalled = true}};
    const struct tally tally = {.distance_m = 12.5, .stalled_s = 0.5, .stalls = 2};
    frame_begin(view, 7, 700000000);
    frame_take_body(view, 1, &moving, &tally);
    frame_take_object(view, 0, (struct world_pose){4, 5, 6});
    muster_Percept percept = {.robot = words("robot1"), .x_m = 9};
    frame_add_percept(view, &percept);
    const muster_Frame *f = frame_finish(view);
    READS(f->simulator, "simulator.1");
    CU_ASSERT_EQUAL(f->step, 7);
    CU_ASSERT_EQUAL(f->time_ns, 700000000);
    CU_ASSERT_EQUAL_FATAL(f->robots._length, 2);
    const muster_RobotView *r = &f->robots._buffer[1];
    READS(r->name, "robot1");
    CU_ASSERT(r->x_m == 1 && r->y_m == 2 && r->heading_rad == 3); /* where it is, not believes */
    CU_ASSERT(r->forward_m_s == 0.25 && r->turn_rad_s == -1 && r->stalled && !r->fault);
    CU_ASSERT(r->distance_m == 12.5 && r->stalled_s == 0.5 && r->stalls == 2);
    CU_ASSERT_EQUAL_FATAL(f->objects._length, 1);
    READS(f->objects._buffer[0].name, "object0");
    CU_ASSERT_EQUAL(f->objects._buffer[0].heading_rad, 6);
    CU_ASSERT_EQUAL_FATAL(f->percepts._length, 1);
    CU_ASSERT_EQUAL(f->percepts._buffer[0].x_m, 9);
    frame_begin(view, 8, 800000000);
    CU_ASSERT_EQUAL(frame_finish(view)->percepts._length, 0);
}

/* Whatever order the answers come in, and though their memory is used again at once. */
static void test_acts_stand_in_the_order_of_the_robots(void)
{
    view = view_start();
    char rules[] = "avoid", content[] = "hello";
    muster_Mail mails[] = {letter("robot1", 1, "all", content), letter("robot1", 2, "all", "b")};
    muster_Act second = act_of("robot1", rules, mails, 2);
    muster_Act first = act_of("robot0", "wander", NULL, 0);
    muster_Act later = act_of("robot0", "stop", NULL, 0);
    frame_begin(view, 0, 0);
    frame_add_act(view, 1, &second);
    rules[0] = content[0] = '?';
    memset(mails, 0, sizeof mails);
    frame_add_act(view, 0, &first);
    frame_add_act(view, 0, &later);
    const muster_Frame *f = frame_finish(view);
    CU_ASSERT_EQUAL_FATAL(f->acts._length, 3);
    READS(f->acts._buffer[0].rules, "wander");
    READS(f->acts._buffer[1].rules, "stop");
    READS(f->acts._buffer[2].rules, "avoid");
    CU_ASSERT_EQUAL_FATAL(f->acts._buffer[2].mails._length, 2);
    READS(f->acts._buffer[2].mails._buffer[0].content, "hello");
    CU_ASSERT_EQUAL(f->acts._buffer[2].mails._buffer[1].seq, 2);
    frame_clear(view);
    CU_ASSERT_EQUAL(frame_finish(view)->acts._length, 0);
    CU_ASSERT_EQUAL(frame_left_out(view), 0);
}

/* The broker may be a step ahead of the simulator. */
static void test_mails_from_outside_come_at_their_step(void)
{
    view = view_start();
    muster_Mail now = letter("operator", 1, "robot0", "now");
    muster_Mail next = letter("operator", 2, "robot0", "next");
    frame_begin(view, 4, 0);
    frame_add_outside(view, 4, &now, 1);
    frame_add_outside(view, 5, &next, 1);
    const muster_Frame *f = frame_finish(view);
    CU_ASSERT_EQUAL_FATAL(f->outside._length, 1);
    READS(f->outside._buffer[0].content, "now");
    frame_clear(view);
    frame_begin(view, 5, 0);
    f = frame_finish(view);
    CU_ASSERT_EQUAL_FATAL(f->outside._length, 1);
    READS(f->outside._buffer[0].content, "next");
    frame_begin(view, 6, 0);
    CU_ASSERT_EQUAL(frame_finish(view)->outside._length, 0);
}

static void test_orders(void)
{
    view = view_start();
    muster_RunCommand order = {.simulator = words("x"),
                               .source = words("operator"),
                               .seq = 3,
                               .order = muster_RUN_PLACE,
                               .name = words("robot0"),
                               .file = words(""),
                               .when = words(""),
                               .x_m = 1.5};
    frame_begin(view, 0, 0);
    frame_add_order(view, &order);
    const muster_Frame *f = frame_finish(view);
    CU_ASSERT_EQUAL_FATAL(f->orders._length, 1);
    READS(f->orders._buffer[0].simulator, "simulator.1");
    READS(f->orders._buffer[0].name, "robot0");
    CU_ASSERT_EQUAL(f->orders._buffer[0].x_m, 1.5);
    frame_begin(view, 1, 0);
    CU_ASSERT_EQUAL(frame_finish(view)->orders._length, 0);
}

static void test_what_does_not_fit_is_left_out_and_counted(void)
{
    view = view_start();
    size_t size = 1u << 20;
    char *text = mu_startup_alloc(size);
    memset(text, 't', size - 1);
    muster_Act big = act_of("robot0", text, NULL, 0);
    muster_Act small = act_of("robot1", "wander", NULL, 0);
    uint64_t fitting = MU_FRAME_BYTES_MAX / size - 1; /* its name takes room, too */
    frame_begin(view, 0, 0);
    for (uint64_t i = 0; i < fitting + 3; i++) {
        frame_add_act(view, 0, &big);
    }
    frame_add_act(view, 1, &small); /* for which there is room still */
    CU_ASSERT_EQUAL(frame_finish(view)->acts._length, fitting + 1);
    CU_ASSERT_EQUAL(frame_left_out(view), 3);
    frame_clear(view);
    for (unsigned i = 0; i < MU_FRAME_ACTS_MAX + 2; i++) {
        frame_add_act(view, 1, &small);
    }
    CU_ASSERT_EQUAL(frame_finish(view)->acts._length, MU_FRAME_ACTS_MAX);
    CU_ASSERT_EQUAL(frame_left_out(view), 5);
    muster_Mail mail = letter("operator", 1, "robot0", "x");
    for (unsigned i = 0; i < MU_FRAME_MAILS_MAX + 2; i++) {
        frame_add_outside(view, 0, &mail, 1);
    }
    CU_ASSERT_EQUAL(frame_finish(view)->outside._length, MU_FRAME_MAILS_MAX);
    CU_ASSERT_EQUAL(frame_left_out(view), 7);
}

/* A run that goes on is not changed by who asks. */
static void test_a_digest_is_how_the_hash_would_begin(void)
{
    char text[RUN_HASH_TEXT], asked[17];
    static struct run_hash *h[2];
    uint64_t before = 0;
    for (size_t i = 0; i < 2; i++) {
        h[i] = run_hash_open();
        run_hash_fold_number(h[i], 1);
        if (i == 1) {
            before = run_hash_peek(h[i]);
        }
        run_hash_fold_number(h[i], 2);
    }
    snprintf(asked, sizeof asked, "%016llx", (unsigned long long)run_hash_peek(h[1]));
    CU_ASSERT(before != run_hash_peek(h[1]));
    run_hash_end(h[1], text);
    CU_ASSERT_EQUAL(strncmp(text, asked, 16), 0);
    char other[RUN_HASH_TEXT];
    run_hash_end(h[0], other);
    READS(text, other);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"distance is what the rows add up to", test_distance_is_what_the_rows_add_up_to},
        {"a stall counts once and lasts", test_a_stall_counts_once_and_lasts},
        {"walls", test_walls},
        {"figures", test_figures},
        {"bodies and percepts", test_bodies_and_percepts},
        {"acts stand in the order of the robots", test_acts_stand_in_the_order_of_the_robots},
        {"mails from outside come at their step", test_mails_from_outside_come_at_their_step},
        {"orders", test_orders},
        {"what does not fit is left out and counted",
         test_what_does_not_fit_is_left_out_and_counted},
        {"a digest is how the hash would begin", test_a_digest_is_how_the_hash_would_begin},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/frame", tests);
}
