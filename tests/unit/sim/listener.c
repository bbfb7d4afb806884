/* SPDX-License-Identifier: Apache-2.0 */
/* For whom a Frame is made: nobody, a listener in the process, readers of the latest, of every. */
#include "bus/raw/raw.h"
#include "core/clock.h"
#include "physics.h"
#include "samples.h"
#include "sim/session/parts.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;

static struct session s; /* static: DDS keeps pointers into it */
static uint32_t wanted[PHYSICS_THINGS];

/* What the listener was told last. */
static struct {
    unsigned scenes, frames;
    int64_t step;
    uint64_t digest;
    uint32_t acts;
    unsigned char bytes[64];
    size_t size;
} heard;

static void on_scene(void *self, const muster_Scene *scene, const struct bus_bytes *bytes)
{
    CU_ASSERT_PTR_EQUAL(self, &heard);
    heard.scenes += scene->robots._length == 1 && bytes->size > 16;
}

static void on_frame(void *self, const muster_Frame *frame, const struct bus_bytes *bytes)
{
    CU_ASSERT_PTR_EQUAL(self, &heard);
    heard.frames++;
    heard.step = frame->step;
    heard.digest = frame->digest;
    heard.acts = frame->acts._length;
    heard.size = bytes->size;
    memcpy(heard.bytes, bytes->data, sizeof heard.bytes);
}

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_SIMULATOR, .name = "simulator"};
    physics_clear();
    physics_robot(0, 0, 0);
    s.world = &physics_world;
    s.hash = run_hash_open();
    s.robot_count = 1;
    s.robots = calloc(1, sizeof *s.robots);
    agents_open(&s.agents, &physics_world);
    s.options.step_ns = PHYSICS_STEP_NS;
    snprintf(s.name, sizeof s.name, "simulator.1");
    return bus_open(&s.bus, &options) != MU_OK || observe_open(&s) != MU_OK;
}

static int end(void)
{
    bus_bytes_free(&s.view_bytes);
    bus_close(&s.bus);
    free(s.robots);
    return 0;
}

/* One step, in which the robot does something. */
static void step(bool last)
{
    muster_Act act = {
        .agent = words("robot0"), .rules = words("go"), .goal = words("stay"), .diary = words("")};
    s.robots[0].sensed = engine_sense_all(s.engine, wanted)[0];
    observe_begin(&s, last);
    observe_act(&s, 0, &act);
    run_hash_fold_number(s.hash, (uint64_t)s.step);
    observe_finish(&s);
    engine_step(s.engine);
    s.step++;
}

static void test_nobody_wants_it(void)
{
    s.engine = physics_start(1);
    observe_scene(&s);
    step(false);
    CU_ASSERT_EQUAL(s.view_for, 0);
    CU_ASSERT_EQUAL(heard.scenes + heard.frames, 0);
    CU_ASSERT_TRUE(s.tallies[0].seen); /* who comes later finds the totals */
}

static void test_a_listener_is_told_everything(void)
{
    static const unsigned char head[] = {0,   1,   0,   0,   12,  0,   0,   0,   's', 'i',
                                         'm', 'u', 'l', 'a', 't', 'o', 'r', '.', '1', 0};
    const struct record_listener listener = {.self = &heard, .scene = on_scene, .frame = on_frame};
    session_listen(&s, &listener);
    observe_scene(&s);
    CU_ASSERT_EQUAL(heard.scenes, 1);
    for (unsigned i = 1; i <= 3; i++) {
        step(false);
        CU_ASSERT_EQUAL(s.view_for, SESSION_FOR_LISTENER);
        CU_ASSERT_EQUAL(heard.frames, i);
        CU_ASSERT_EQUAL(heard.step, i);
        CU_ASSERT_EQUAL(heard.acts, 1);
        CU_ASSERT_EQUAL(heard.digest, run_hash_peek(s.hash));
        CU_ASSERT_EQUAL(memcmp(heard.bytes, head, sizeof head), 0);
        int64_t number; /* behind the name, at a multiple of 8 from the body's beginning */
        memcpy(&number, heard.bytes + 20, sizeof number);
        CU_ASSERT_EQUAL(number, (int64_t)i);
    }
    session_listen(&s, &(struct record_listener){0});
}

/* Takes a Frame of a reader.  @return its step; -1: there is none */
static int64_t frame_take(struct bus_reader *reader, uint64_t patience_ns)
{
    uint64_t until_ns = mu_clock_ns() + patience_ns;
    enum bus_life life;
    const muster_Frame *f = NULL;
    while (!(f = bus_next(reader, &life)) && mu_clock_ns() < until_ns) {
        bus_wait(&s.bus, 1, 5000000);
    }
    return f && life == BUS_DATA ? f->step : -1;
}

static void test_who_shows_frames_gets_some_and_the_last(void)
{
    static struct bus_reader latest;
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&s.bus, BUS_FRAME, "latest", &latest), MU_OK);
    s.latest_wall_ns = 0;
    int64_t first = s.step;
    step(false);
    CU_ASSERT_EQUAL(s.view_for, SESSION_FOR_LATEST);
    CU_ASSERT_EQUAL(frame_take(&latest, PATIENCE_NS), first);
    s.latest_wall_ns = mu_clock_ns() + PATIENCE_NS; /* no period ends while this test lasts */
    step(false);
    CU_ASSERT_EQUAL(s.view_for, 0);
    step(true);
    CU_ASSERT_EQUAL(frame_take(&latest, PATIENCE_NS), first + 2);
}

static void test_who_computes_from_frames_gets_every(void)
{
    static struct bus_reader every;
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&s.bus, BUS_FRAME, "every", &every), MU_OK);
    for (unsigned i = 0; i < 20; i++) {
        int64_t wanted_step = s.step;
        step(false);
        CU_ASSERT_TRUE(s.view_for & SESSION_FOR_EVERY);
        CU_ASSERT_EQUAL(frame_take(&every, PATIENCE_NS), wanted_step);
    }
    CU_ASSERT_EQUAL(s.frames_lost, 0);
    CU_ASSERT_EQUAL(s.bus.malformed, 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"nobody wants it", test_nobody_wants_it},
        {"a listener is told everything", test_a_listener_is_told_everything},
        {"who shows frames gets some and the last", test_who_shows_frames_gets_some_and_the_last},
        {"who computes from frames gets every", test_who_computes_from_frames_gets_every},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/listener", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
