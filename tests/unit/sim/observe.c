/* SPDX-License-Identifier: Apache-2.0 */
/* For whom a Frame is made: nobody, a recording, readers of the latest, of every. */
#include "bus/raw/raw.h"
#include "core/clock.h"
#include "mcap/mcap.h"
#include "physics.h"
#include "samples.h"
#include "sim/session/parts.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;

static struct session s;
static struct bus bus; /* static: DDS keeps pointers into it */
static uint32_t wanted[PHYSICS_THINGS];
static char path[] = "/tmp/muster-observe-XXXXXX";

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    close(mkstemp(path));
    struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_SIMULATOR, .name = "simulator"};
    physics_clear();
    physics_robot(0, 0, 0);
    s.bus = &bus;
    s.world = &physics_world;
    s.hash = run_hash_open();
    s.robot_count = s.totals_count = 1;
    s.robots = calloc(1, sizeof *s.robots);
    s.totals = calloc(1, sizeof *s.totals);
    agents_open(&s.agents, &physics_world);
    s.agents.at[0].process = 0;
    s.options.step_ns = PHYSICS_STEP_NS;
    snprintf(s.name, sizeof s.name, "simulator.1");
    return bus_open(&bus, &options) != MU_OK || observe_open(&s) != MU_OK;
}

static int end(void)
{
    unlink(path);
    bus_close(&bus);
    free(s.robots);
    free(s.totals);
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
    CU_ASSERT_EQUAL(s.observe.wanted, 0);
    CU_ASSERT_TRUE(s.observe.tallies[0].seen); /* who comes later finds the totals */
}

/* Closes the recording and opens it for reading. */
static struct mcap_reader *recording_read(void)
{
    struct mcap_reader *r = mcap_reader_create();
    struct mu_fault fault;
    CU_ASSERT_EQUAL_FATAL(mcap_file_close(s.options.recording), MU_OK);
    s.options.recording = NULL;
    CU_ASSERT_EQUAL_FATAL(mcap_reader_open(r, path, &fault), MU_OK);
    return r;
}

static void check_recording(bool without_percepts)
{
    static const unsigned char head[] = {0,   1,   0,   0,   12,  0,   0,   0,   's', 'i',
                                         'm', 'u', 'l', 'a', 't', 'o', 'r', '.', '1', 0};
    static struct mu_option_list none;
    struct mcap_file_options options = {
        .path = path, .files = &none, .notes = &none, .without_percepts = without_percepts};
    CU_ASSERT_EQUAL_FATAL(mcap_file_open(&s.options.recording, &options), MU_OK);
    observe_scene(&s);
    static unsigned char bytes[4096];
    void *sample;
    uint64_t digests[3];
    int64_t first = s.step;
    s.observe.end_recorded = false;
    for (unsigned i = 0; i < 3; i++) {
        step(false);
        CU_ASSERT_EQUAL(s.observe.wanted, SESSION_FOR_RECORDING);
        digests[i] = run_hash_peek(s.hash);
    }
    const muster_RunStatus status = {.simulator = s.name,
                                     .state = muster_RUN_DONE,
                                     .step = 3,
                                     .time_ns = (uint64_t)s.step * PHYSICS_STEP_NS,
                                     .hash = words("none"),
                                     .waits_for = words("")};
    observe_status(&s, &status);
    observe_status(&s, &status); /* once */
    struct mcap_reader *r = recording_read();
    struct mcap_message m;
    CU_ASSERT_EQUAL_FATAL(mcap_reader_next(r, &m), MU_OK);
    CU_ASSERT_EQUAL(m.channel, mcap_reader_find(r, bus_topic_name(BUS_SCENE)));
    for (unsigned i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL_FATAL(mcap_reader_next(r, &m), MU_OK);
        CU_ASSERT_EQUAL(m.channel, mcap_reader_find(r, bus_topic_name(BUS_FRAME)));
        CU_ASSERT_FATAL(m.size < sizeof bytes);
        CU_ASSERT_EQUAL(memcmp(m.data, head, sizeof head), 0);
        memcpy(bytes, m.data, m.size);
        CU_ASSERT_EQUAL_FATAL(bus_decode(BUS_FRAME, bytes, m.size, &sample), MU_OK);
        const muster_Frame *f = sample;
        CU_ASSERT_EQUAL(f->step, first + i);
        CU_ASSERT_EQUAL(f->digest, digests[i]);
        CU_ASSERT_EQUAL(f->acts._length, 1);
        CU_ASSERT_EQUAL(f->percepts._length, !without_percepts);
        bus_decode_free(BUS_FRAME, sample);
    }
    CU_ASSERT_EQUAL_FATAL(mcap_reader_next(r, &m), MU_OK);
    CU_ASSERT_EQUAL(m.channel, mcap_reader_find(r, bus_topic_name(BUS_RUN_STATUS)));
    CU_ASSERT_EQUAL(mcap_reader_next(r, &m), MU_DONE);
    READS(mcap_reader_value(r, "end", "state"), "done");
    READS(mcap_reader_value(r, "end", "steps"), "3");
    mcap_reader_close(r);
}

static void test_a_recording_has_everything(void)
{
    check_recording(false);
}

static void test_a_recording_without_percepts(void)
{
    check_recording(true);
}

/* Takes a Frame of a reader.  @return its step; -1: there is none */
static int64_t frame_take(struct bus_reader *reader, uint64_t patience_ns)
{
    uint64_t until_ns = mu_clock_ns() + patience_ns;
    enum bus_life life;
    const muster_Frame *f = NULL;
    while (!(f = bus_next(reader, &life)) && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, 5000000);
    }
    return f && life == BUS_DATA ? f->step : -1;
}

static void test_who_shows_frames_gets_some_and_the_last(void)
{
    static struct bus_reader latest;
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_FRAME, "latest", &latest), MU_OK);
    s.observe.latest_wall_ns = 0;
    int64_t first = s.step;
    step(false);
    CU_ASSERT_EQUAL(s.observe.wanted, SESSION_FOR_LATEST);
    CU_ASSERT_EQUAL(frame_take(&latest, PATIENCE_NS), first);
    s.observe.latest_wall_ns =
        mu_clock_ns() + PATIENCE_NS; /* no period ends while this test lasts */
    step(false);
    CU_ASSERT_EQUAL(s.observe.wanted, 0);
    step(true);
    CU_ASSERT_EQUAL(frame_take(&latest, PATIENCE_NS), first + 2);
}

static void test_who_computes_from_frames_gets_every(void)
{
    static struct bus_reader every;
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_FRAME, "every", &every), MU_OK);
    for (unsigned i = 0; i < 20; i++) {
        int64_t wanted_step = s.step;
        step(false);
        CU_ASSERT_TRUE(s.observe.wanted & SESSION_FOR_EVERY);
        CU_ASSERT_EQUAL(frame_take(&every, PATIENCE_NS), wanted_step);
    }
    CU_ASSERT_EQUAL(s.observe.lost, 0);
    CU_ASSERT_EQUAL(bus.malformed, 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"nobody wants it", test_nobody_wants_it},
        {"a recording has everything", test_a_recording_has_everything},
        {"a recording without percepts", test_a_recording_without_percepts},
        {"who shows frames gets some and the last", test_who_shows_frames_gets_some_and_the_last},
        {"who computes from frames gets every", test_who_computes_from_frames_gets_every},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/observe", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
