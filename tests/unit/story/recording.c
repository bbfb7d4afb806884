/* SPDX-License-Identifier: Apache-2.0 */
/* A recorded run read back: its steps, its minds, and when its robots were stalled. */
#include "bus/bus.h"
#include "bus/raw/raw.h"
#include "core/text.h"
#include "mcap/mcap.h"
#include "muster/version.h"
#include "story/story.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define W(s) ((char *)(uintptr_t)(s))

enum { STEPS = 40, STEP_MS = 100 };

static char path[] = "/tmp/story-XXXXXX";
static struct mcap_writer *writer;
static uint32_t scenes, frames;

/* --- a recording ------------------------------------------------------------------------------ */

static void message_write(uint32_t channel, enum bus_topic topic, const void *sample,
                          uint64_t log_ns)
{
    struct bus_bytes bytes = {0};
    CU_ASSERT_EQUAL_FATAL(bus_encode(topic, sample, &bytes), MU_OK);
    struct mcap_message m = {
        .channel = channel, .log_ns = log_ns, .data = bytes.data, .size = bytes.size};
    CU_ASSERT_EQUAL(mcap_writer_message(writer, &m), MU_OK);
    bus_bytes_free(&bytes);
}

static void scene_write(void)
{
    float corners[] = {2, -2, 2.5F, -2, 2.5F, 2, 2, 2};
    muster_Outline wall = {.corners_m = {._length = 8, ._maximum = 8, ._buffer = corners}};
    muster_Scene scene = {.simulator = W("sim"),
                          .world = W("w.world"),
                          .step_ns = STEP_MS * 1000000,
                          .max_x_m = 3,
                          .max_y_m = 3};
    scene.walls._buffer = &wall;
    scene.walls._length = scene.walls._maximum = 1;
    message_write(scenes, BUS_SCENE, &scene, 0);
}

/* A step of which something is another. */
static struct {
    int64_t step;
    double x_m, command_m_s;
} odd = {.step = -1};

/* red drives at the wall and is stalled in the steps 20 to 24 and from 30 on; blue stands. */
static void frame_write(int64_t step)
{
    char diary[64];
    bool stalled = (step >= 20 && step < 25) || step >= 30;
    muster_RobotView robots[2] = {{.name = W("red"),
                                   .state = muster_STATE_RUNNING,
                                   .x_m = stalled ? 1.8 : 0.05 * (double)step,
                                   .command_forward_m_s = 0.5,
                                   .stalled = stalled},
                                  {.name = W("blue"), .x_m = -5, .state = muster_STATE_STANDBY}};
    if (step == odd.step) {
        robots[0].x_m += odd.x_m;
        robots[0].command_forward_m_s += odd.command_m_s;
    }
    snprintf(diary, sizeof diary, "%sS\n+%lld (position %lld)\nR go %lld\nV 500.0 0.0\n",
             step == 0 ? "0\n" : "", (long long)step, (long long)step, (long long)step);
    muster_Act act = {.agent = W("red"),
                      .state = muster_STATE_RUNNING,
                      .rules = W(""),
                      .goal = W(""),
                      .diary = diary};
    muster_Frame frame = {
        .simulator = W("sim"), .step = step, .time_ns = (uint64_t)step * STEP_MS * 1000000};
    frame.robots._buffer = robots;
    frame.robots._length = frame.robots._maximum = 2;
    frame.acts._buffer = &act;
    frame.acts._length = frame.acts._maximum = 1;
    message_write(frames, BUS_FRAME, &frame, frame.time_ns);
}

static void recording_begin(void)
{
    static const struct mcap_channel scene = {
        .topic = "Scene", .encoding = "cdr", .schema_name = "", .schema_encoding = ""};
    static const struct mcap_channel frame = {
        .topic = "Frame", .encoding = "cdr", .schema_name = "", .schema_encoding = ""};
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(writer, path, "test"), MU_OK);
    CU_ASSERT_EQUAL(mcap_writer_channel(writer, &scene, &scenes), MU_OK);
    CU_ASSERT_EQUAL(mcap_writer_channel(writer, &frame, &frames), MU_OK);
}

static struct recording *recording_read(void)
{
    static struct recording all[8]; /* its memory is for the life of the process */
    static size_t count;
    struct mu_fault fault;
    CU_ASSERT_FATAL(count < sizeof all / sizeof all[0]);
    struct recording *r = &all[count++];
    CU_ASSERT_EQUAL_FATAL(recording_create(r, path, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_open(r, path, &fault), MU_OK);
    return r;
}

/* Step 7 is missing, and a message is no Frame. */
static struct recording *recording_make(void)
{
    recording_begin();
    scene_write();
    for (int64_t step = 0; step < STEPS; step++) {
        if (step != 7) {
            frame_write(step);
        }
    }
    struct mcap_message junk = {
        .channel = frames, .log_ns = 1000000000, .data = "junk", .size = sizeof "junk"};
    CU_ASSERT_EQUAL(mcap_writer_message(writer, &junk), MU_OK);
    CU_ASSERT_EQUAL(mcap_writer_close(writer), MU_OK);
    return recording_read();
}

/* --- what is read ----------------------------------------------------------------------------- */

static void test_steps(void)
{
    struct recording *r = recording_make();
    CU_ASSERT_EQUAL(r->steps_count, STEPS - 1);
    CU_ASSERT_EQUAL(r->malformed, 1);
    CU_ASSERT_EQUAL(r->step_ns, STEP_MS * 1000000);
    for (int64_t step = STEPS - 1; step >= 0; step--) {
        const muster_Frame *f = recording_frame(r, step);
        CU_ASSERT_EQUAL(f != NULL, step != 7);
        CU_ASSERT(!f || f->step == step);
    }
    CU_ASSERT_PTR_NULL(recording_frame(r, -1));
    CU_ASSERT_PTR_NULL(recording_frame(r, STEPS));
    recording_close(r);
}

static void test_on_from_a_step(void)
{
    static const int64_t cases[][2] = {{5, 5}, {7, 6}, {-3, 0}, {STEPS + 9, STEPS - 1}};
    struct recording *r = recording_make();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        recording_seek(r, cases[i][0]);
        for (int64_t step = cases[i][1]; step < STEPS; step += step == 6 ? 2 : 1) {
            const muster_Frame *f = recording_next(r);
            CU_ASSERT_PTR_NOT_NULL_FATAL(f);
            CU_ASSERT_EQUAL(f->step, step);
        }
        CU_ASSERT_PTR_NULL(recording_next(r));
    }
    recording_close(r);
}

static void test_times(void)
{
    struct recording *r = recording_make();
    CU_ASSERT_EQUAL(recording_step_at(r, -5), 0);
    CU_ASSERT_EQUAL(recording_step_at(r, 1.2), 12);
    CU_ASSERT_EQUAL(recording_step_at(r, 0.7), 6); /* 7 is missing */
    CU_ASSERT_EQUAL(recording_step_at(r, 1e300), STEPS - 1);
    recording_close(r);
}

static void test_minds(void)
{
    struct recording *r = recording_make();
    int32_t red = minds_robot(r->minds, "red");
    CU_ASSERT_NOT_EQUAL_FATAL(red, MINDS_NONE);
    CU_ASSERT_EQUAL(minds_robot(r->minds, "blue"), MINDS_NONE);
    size_t facts = 0;
    int32_t line = minds_at(r->minds, red, 10);
    for (int32_t f = minds_next_fact(r->minds, line, MINDS_NONE); f != MINDS_NONE;
         f = minds_next_fact(r->minds, line, f)) {
        facts++;
    }
    CU_ASSERT_EQUAL(facts, 10); /* of the steps 0 to 10, but for 7 */
    recording_close(r);
}

static void test_stalls(void)
{
    struct recording *r = recording_make();
    struct stall s[4];
    uint32_t red = stalls_robot(r, "red");
    CU_ASSERT_EQUAL_FATAL(red, 0);
    CU_ASSERT_EQUAL(stalls_robot(r, "green"), MU_NONE);
    CU_ASSERT_EQUAL_FATAL(stalls_find(r, red, s, 4), 2);
    CU_ASSERT_EQUAL(s[0].from, 20);
    CU_ASSERT_EQUAL(s[0].to, 24);
    CU_ASSERT_EQUAL(s[1].from, 30);
    CU_ASSERT_EQUAL(s[1].to, STEPS - 1);
    CU_ASSERT_STRING_EQUAL(s[0].near, "a wall");
    CU_ASSERT_DOUBLE_EQUAL(s[0].near_m, 0.2, 1e-9);
    CU_ASSERT_DOUBLE_EQUAL(s[0].forward_m_s, 0.5, 0);
    CU_ASSERT_EQUAL(s[0].state, muster_STATE_RUNNING);
    CU_ASSERT_PTR_EQUAL(stalls_at(s, 2, 0), &s[0]);
    CU_ASSERT_PTR_EQUAL(stalls_at(s, 2, 26), &s[0]);
    CU_ASSERT_PTR_EQUAL(stalls_at(s, 2, 28), &s[1]);
    CU_ASSERT_PTR_EQUAL(stalls_at(s, 2, 35), &s[1]);
    CU_ASSERT_PTR_NULL(stalls_at(s, 0, 35));
    CU_ASSERT_EQUAL(stalls_find(r, red, s, 1), 2); /* no room, and counted all the same */
    CU_ASSERT_EQUAL(stalls_find(r, stalls_robot(r, "blue"), s, 4), 0);
    recording_close(r);
}

/* --- how it ended ----------------------------------------------------------------------------- */

/* Of so many steps, of a run that was to have so many seconds; NULL: that is not known, or there is
 * no table at the end. */
static void ended_make(struct recording *r, int64_t count, const char *duration_s,
                       const char *state, const char *steps)
{
    const struct mcap_pair about[] = {{"duration_s", duration_s}};
    const struct mcap_pair end[] = {{"state", state}, {"steps", steps}};
    struct mu_fault fault;
    recording_begin();
    (void)mcap_writer_metadata(writer, "run", about, duration_s ? 1 : 0);
    scene_write();
    for (int64_t step = 0; step < count; step++) {
        frame_write(step);
    }
    if (state) {
        (void)mcap_writer_metadata(writer, "end", end, 2);
    }
    CU_ASSERT_EQUAL(mcap_writer_close(writer), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_create(r, path, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_open(r, path, &fault), MU_OK);
    unlink(path); /* whoever has it open keeps it */
}

static void test_how_it_ended(void)
{
    static const struct {
        const char *duration_s, *state, *steps;
        enum recording_end wanted;
    } cases[] = {
        {"3.9", "done", "39", RECORDING_DONE},      {"3.85", "done", "39", RECORDING_DONE},
        {"4", "done", "39", RECORDING_STOPPED},     {"60", "done", "39", RECORDING_STOPPED},
        {"60", "done", "45", RECORDING_DONE}, /* Frames have been taken away: that differs */
        {"60", "fault", "40", RECORDING_FAULT},     {"60", NULL, NULL, RECORDING_CUT},
        {"3.9", NULL, NULL, RECORDING_DONE}, /* what is cut off is behind the last Frame */
        {NULL, "done", "39", RECORDING_DONE},       {NULL, NULL, NULL, RECORDING_CUT},
        {"nonsense", "done", "39", RECORDING_DONE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        static struct recording r;
        ended_make(&r, STEPS, cases[i].duration_s, cases[i].state, cases[i].steps);
        CU_ASSERT_EQUAL(recording_end(&r), cases[i].wanted);
        recording_close(&r);
    }
}

/* Of a run that has its end every step counts; of another one, those that it has. */
static void test_how_far_they_are_compared(void)
{
    static const struct {
        const char *duration_s, *state, *steps;
        int64_t again; /* steps of the other one, which broke off */
        bool differs;
    } cases[] = {
        {"3.9", "done", "39", STEPS, false},     {"3.9", "done", "39", STEPS - 1, true},
        {"3.9", "done", "39", STEPS + 1, true},  {"60", "done", "39", STEPS + 1, false},
        {"60", "done", "39", STEPS - 1, true},   {"60", NULL, NULL, STEPS + 1, false},
        {"60", NULL, NULL, STEPS - 1, true},     {"60", "fault", "40", STEPS + 1, false},
        {"60", "fault", "40", STEPS - 1, false}, {"60", "fault", "40", STEPS - 2, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        static struct recording one, other;
        struct difference d = {.step = -1};
        ended_make(&one, STEPS, cases[i].duration_s, cases[i].state, cases[i].steps);
        ended_make(&other, cases[i].again, "60", "fault", "1");
        CU_ASSERT_EQUAL(differ_find(&one, &other, &d), cases[i].differs);
        CU_ASSERT(!cases[i].differs || strcmp(d.what, "the step") == 0);
        CU_ASSERT(!cases[i].differs || d.step == (cases[i].again < STEPS ? cases[i].again : STEPS));
        recording_close(&one);
        recording_close(&other);
    }
}

/* The last Frame of a run that was stopped says how the world was left, and not who acted. */
static void test_what_is_compared_of_the_last_step(void)
{
    static const struct {
        const char *state;
        int64_t step;
        double x_m, command_m_s;
        bool differs;
    } cases[] = {
        {"done", STEPS - 1, 0, 1, false}, {"done", STEPS - 1, 1, 0, true},
        {"done", STEPS - 2, 0, 1, true},  {NULL, STEPS - 1, 0, 1, false},
        {NULL, STEPS - 1, 1, 0, true},    {"fault", STEPS - 1, 0, 1, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        static struct recording one, other;
        struct difference d = {.step = -1};
        odd.step = cases[i].step;
        odd.x_m = cases[i].x_m;
        odd.command_m_s = cases[i].command_m_s;
        ended_make(&one, STEPS, "60", cases[i].state, "39");
        odd.step = -1;
        ended_make(&other, STEPS + 1, "60", NULL, NULL);
        CU_ASSERT_EQUAL(differ_find(&one, &other, &d), cases[i].differs);
        CU_ASSERT(!cases[i].differs || d.step == cases[i].step);
        recording_close(&one);
        recording_close(&other);
    }
}

/* --- what is no recording ----------------------------------------------------------------------
 */

static void test_no_frames(void)
{
    static struct recording r;
    struct mu_fault fault;
    recording_begin();
    CU_ASSERT_EQUAL(mcap_writer_close(writer), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_create(&r, path, &fault), MU_OK);
    CU_ASSERT_EQUAL(recording_open(&r, path, &fault), MU_OK); /* a channel, and nothing on it */
    CU_ASSERT_EQUAL(r.steps_count, 0);
    CU_ASSERT_EQUAL(recording_end(&r), RECORDING_CUT);
    CU_ASSERT_PTR_NULL(recording_frame(&r, 0));
    CU_ASSERT_EQUAL(recording_step_at(&r, 1), 0);
    CU_ASSERT_EQUAL(stalls_robot(&r, "red"), MU_NONE);
    recording_close(&r);
    CU_ASSERT_EQUAL(recording_create(&r, "/tmp/no/such.mcap", &fault), MU_FAULT_FILE);
}

static void test_something_else(void)
{
    static struct recording r;
    struct mu_fault fault;
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(writer, path, "test"), MU_OK);
    CU_ASSERT_EQUAL(mcap_writer_close(writer), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_create(&r, path, &fault), MU_OK);
    CU_ASSERT_EQUAL(recording_open(&r, path, &fault), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "no Frame"));
    recording_close(&r);
}

/* --- of another version ----------------------------------------------------------------------- */

/* Opens a recording whose Frames are described so.  @return as recording_open */
static mu_result described_open(const char *schema, size_t size, struct mu_fault *fault)
{
    static struct recording r;
    static const struct mcap_pair about[] = {{"muster", "0.0.7"},
                                             {"began_wall_ns", "1767225600000000000"}};
    struct mcap_channel c = {.topic = "Frame",
                             .encoding = "cdr",
                             .schema_name = "muster/msg/Frame",
                             .schema_encoding = "ros2msg",
                             .schema = schema,
                             .schema_size = size};
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(writer, path, "test"), MU_OK);
    CU_ASSERT_EQUAL(mcap_writer_metadata(writer, "run", about, 2), MU_OK);
    CU_ASSERT_EQUAL(mcap_writer_channel(writer, &c, &frames), MU_OK);
    frame_write(0);
    CU_ASSERT_EQUAL(mcap_writer_close(writer), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_create(&r, path, fault), MU_OK);
    mu_result opened = recording_open(&r, path, fault);
    CU_ASSERT_EQUAL(r.foreign != NULL, opened != MU_OK);
    recording_close(&r);
    return opened;
}

static void test_another_versions_type(void)
{
    static char bytes[65536];
    char name_bytes[64];
    struct mu_fault fault = {.text = ""};
    struct mu_text name, schema;
    mu_text_init(&name, name_bytes, sizeof name_bytes);
    mu_text_init(&schema, bytes, sizeof bytes);
    CU_ASSERT_EQUAL_FATAL(bus_schema(BUS_FRAME, &name, &schema), MU_OK);
    CU_ASSERT_EQUAL(described_open(schema.at, schema.len, &fault), MU_OK);
    CU_ASSERT_EQUAL(described_open(schema.at, schema.len - 1, &fault), MU_FAULT_FILE);
    READS(fault.text, "it was written by muster 0.0.7 on 2026-01-01, whose Frame is another type "
                      "than that of this muster, " MU_VERSION ": use the one that wrote it, or do "
                      "the run again with this one");
}

/* Whoever counts steps in 32 bits never sees one that does not fit. */
static void test_steps_that_are_none(void)
{
    recording_begin();
    scene_write();
    frame_write(INT64_MIN);
    frame_write(3);
    frame_write(UINT32_MAX);
    frame_write(INT64_MAX);
    CU_ASSERT_EQUAL(mcap_writer_close(writer), MU_OK);
    struct recording *r = recording_read();
    CU_ASSERT_EQUAL(r->malformed, 3);
    CU_ASSERT_EQUAL_FATAL(r->steps_count, 1);
    CU_ASSERT_EQUAL(r->steps[0].step, 3);
    recording_close(r);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"another version's type", test_another_versions_type},
        {"steps that are none", test_steps_that_are_none},
        {"steps", test_steps},
        {"on from a step", test_on_from_a_step},
        {"times", test_times},
        {"minds", test_minds},
        {"stalls", test_stalls},
        {"how it ended", test_how_it_ended},
        {"how far they are compared", test_how_far_they_are_compared},
        {"what is compared of the last step", test_what_is_compared_of_the_last_step},
        {"no frames", test_no_frames},
        {"something else", test_something_else},
        CU_TEST_INFO_NULL,
    };
    int fd = mkstemp(path);
    if (fd < 0) {
        return 1;
    }
    close(fd);
    writer = mcap_writer_create();
    int code = suite_run("story/recording", tests);
    unlink(path);
    return code;
}
