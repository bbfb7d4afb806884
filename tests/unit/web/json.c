/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes, frames and runs as the page reads them, with names from hell. */
#include "web/json.h"
#include "muster/memory.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <string.h>

enum { BYTES = 64 * 1024 };

static char bytes[BYTES];
static struct mu_text text;
static struct mu_json j;

static void has(const char *wanted)
{
    if (!strstr(text.at, wanted)) {
        READS(text.at, wanted);
    }
    CU_ASSERT_PTR_NOT_NULL(strstr(text.at, wanted));
}

static void begin(void)
{
    mu_text_init(&text, bytes, sizeof bytes);
    mu_json_to_text(&j, &text, MU_JSON_LINE);
}

/* --- a small run ------------------------------------------------------------------------------ */

static muster_RobotView views[2];
static muster_Percept percepts[2];
static muster_Act acts[2];
static muster_Mail mails[FRAME_JSON_MAILS_MAX + 6];

static muster_Frame frame_make(void)
{
    views[0] = (muster_RobotView){.name = words("red"),
                                  .goal = words(""),
                                  .state = muster_STATE_RUNNING,
                                  .x_m = 1.2345,
                                  .y_m = -0.5,
                                  .heading_rad = 3.14159,
                                  .forward_m_s = 0.3,
                                  .command_forward_m_s = 0.25,
                                  .distance_m = 12.5,
                                  .stalls = 2,
                                  .stalled_s = 1.5,
                                  .firings = 7,
                                  .mails_sent = 8,
                                  .mails_received = 9};
    views[1] = (muster_RobotView){.name = words("blue"),
                                  .goal = words(""),
                                  .state = muster_STATE_SUSPENDED,
                                  .x_m = NAN,
                                  .y_m = INFINITY,
                                  .stalled = true,
                                  .fault = true};
    for (int i = 0; i < 2; i++) {
        acts[i] = (muster_Act){
            .agent = views[i].name, .rules = words(""), .diary = words(""), .firings = 0};
        percepts[i] = (muster_Percept){.robot = views[i].name};
    }
    muster_Frame f = {.simulator = words("sim"),
                      .step = 12,
                      .time_ns = 1200000000,
                      .wall_ns = 600000000,
                      .digest = 0xabc};
    f.robots = (dds_sequence_muster_RobotView){._length = 2, ._buffer = views};
    f.percepts = (dds_sequence_muster_Percept){._length = 2, ._buffer = percepts};
    f.acts = (dds_sequence_muster_Act){._length = 2, ._buffer = acts};
    return f;
}

static void test_a_frame_in_thousandths(void)
{
    muster_Frame f = frame_make();
    begin();
    frame_json_write(&j, NULL, &f, false);
    has("{\"step\": 12, \"time_ms\": 1200, \"wall_ms\": 600, \"digest\": \"0000000000000abc\", "
        "\"robots\": [[1235, -500, 3142, 300, 0, 250, 0, 1], [0, 0, 0, 0, 0, 0, 0, 26]], "
        "\"objects\": [], \"lists\": {\"sonar\": [], \"laser\": []");
    has("}, \"fired\": [], \"mails\": [], "
        "\"goals\": [], \"orders\": []}\n");
}

static void test_totals(void)
{
    muster_Frame f = frame_make();
    begin();
    frame_json_totals(&j, NULL, &f);
    has("\"time_ms\": 1200, \"robots\": [[12500, 2, 1500, 7, 8, 9], [0, 0, 0, 0, 0, 0]]");
}

/* --- beams ------------------------------------------------------------------------------------ */

static unsigned digit(char c)
{
    const char *at = strchr(BEAMS_DIGITS, c);
    CU_ASSERT_PTR_NOT_NULL_FATAL(at);
    return (unsigned)(at - BEAMS_DIGITS);
}

static void test_beams_are_centimetres(void)
{
    static const float range_m[] = {0, 0.004f, 0.006f, 1, 40.94f, 41, 1000, -1, NAN, INFINITY};
    static const unsigned cm[] = {0, 0, 1, 100, 4094, 4095, 4095, 4095, 4095, 4095};
    char out[BEAMS_TEXT];
    CU_ASSERT_EQUAL(beams_write(out, range_m, 10), 10);
    for (size_t i = 0; i < 10; i++) {
        CU_ASSERT_EQUAL(64 * digit(out[2 * i]) + digit(out[2 * i + 1]), cm[i]);
    }
    CU_ASSERT_EQUAL(strlen(out), 20);
}

static void test_of_many_beams_some_are_shown(void)
{
    static float range_m[1000];
    char out[BEAMS_TEXT];
    CU_ASSERT_EQUAL(beams_write(out, range_m, 181), 181);
    CU_ASSERT_EQUAL(beams_write(out, range_m, 182), 91);
    CU_ASSERT_EQUAL(beams_write(out, range_m, 1000), 167);
    CU_ASSERT_EQUAL(beams_write(out, range_m, 0), 0);
    READS(out, "");
}

static void test_a_frame_says_whose_beams_they_are(void)
{
    static float near[] = {1.0f, 0.64f};
    muster_Frame f = frame_make();
    percepts[1].sonar_m._buffer = near;
    percepts[1].sonar_m._length = 2;
    percepts[0].robot = words("nobody");
    percepts[0].laser_m._buffer = near;
    percepts[0].laser_m._length = 2;
    begin();
    frame_json_write(&j, NULL, &f, false);
    has("\"sonar\": [[1, \"BkBA\"]], \"laser\": []");
}

static void test_a_lean_frame_has_no_beams(void)
{
    static float near[] = {1.0f};
    muster_Frame f = frame_make();
    percepts[1].sonar_m._buffer = percepts[1].laser_m._buffer = near;
    percepts[1].sonar_m._length = percepts[1].laser_m._length = 1;
    begin();
    frame_json_write(&j, NULL, &f, true);
    has("\"sonar\": [], \"laser\": []");
}

/* --- names and words of strangers ------------------------------------------------------------- */

#define SEPARATORS "\xe2\x80\xa8\xe2\x80\xa9"

static void test_names_from_hell_stay_text(void)
{
    muster_Frame f = frame_make();
    mails[0] =
        letter("</script><script>alert(1)</script>", 1, "a\"b\\c", "x\n\ndata: {}\r\x01\x7f");
    mails[1] = letter("\xff\xfe\xc3", 2, SEPARATORS, "\xf0\x9f\x90\x9e");
    acts[0].mails = (dds_sequence_muster_Mail){._length = 2, ._buffer = mails};
    begin();
    frame_json_write(&j, NULL, &f, false);
    has("[\"</script><script>alert(1)</script>\", \"a\\\"b\\\\c\", \"tell\", "
        "\"x\\n\\ndata: {}\\r\\u0001\\u007f\"]");
    has("[\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\", \"" SEPARATORS "\", \"tell\", "
        "\"\xf0\x9f\x90\x9e\"]");
    CU_ASSERT_EQUAL(strcspn(text.at, "\n"),
                    text.len - 1); /* one line: the next would be an event's */
    CU_ASSERT_PTR_NULL(strchr(text.at, '\r'));
}

static void test_a_character_that_is_cut_is_no_broken_json(void)
{
    char content[FRAME_JSON_CONTENT_MAX + 8];
    muster_Frame f = frame_make();
    memset(content, 'x', sizeof content);
    memcpy(content + FRAME_JSON_CONTENT_MAX - 1, "\xe2\x82\xac", 4);
    mails[0] = letter("red", 1, "blue", content);
    acts[0].mails = (dds_sequence_muster_Mail){._length = 1, ._buffer = mails};
    begin();
    frame_json_write(&j, NULL, &f, false);
    has("x\xef\xbf\xbd\"]]");
}

static void test_of_many_mails_some_are_shown_people_s_first(void)
{
    muster_Frame f = frame_make();
    for (uint64_t i = 0; i < FRAME_JSON_MAILS_MAX + 5; i++) {
        mails[i] = letter("red", i, "blue", "x");
    }
    mails[FRAME_JSON_MAILS_MAX + 5] = letter("operator", 1, "red", "y");
    acts[0].mails =
        (dds_sequence_muster_Mail){._length = FRAME_JSON_MAILS_MAX + 5, ._buffer = mails};
    f.outside =
        (dds_sequence_muster_Mail){._length = 1, ._buffer = &mails[FRAME_JSON_MAILS_MAX + 5]};
    begin();
    frame_json_write(&j, NULL, &f, false);
    unsigned shown = 0;
    for (const char *at = text.at; (at = strstr(at, "\"blue\", \"tell\"")); at++) {
        shown++;
    }
    CU_ASSERT_EQUAL(shown, FRAME_JSON_MAILS_MAX - 1);
    has("\"mails\": [[\"operator\", \"red\", \"tell\", \"y\"], [\"red\"");
}

static void test_rules_and_orders(void)
{
    muster_RunCommand command = {
        .source = words("operator"), .order = muster_RUN_PUSH, .name = words("<b>")};
    muster_Frame f = frame_make();
    acts[1].firings = 3;
    acts[1].rules = words("wander avoid <img>");
    f.orders = (dds_sequence_muster_RunCommand){._length = 1, ._buffer = &command};
    begin();
    frame_json_write(&j, NULL, &f, false);
    has("\"fired\": [[1, 3, \"wander avoid <img>\"]]");
    has("\"orders\": [[\"operator\", \"push\", \"<b>\"]]");
}

/* --- the scene -------------------------------------------------------------------------------- */

static void test_a_scene(void)
{
    static float corners[] = {0, 0, 1, 0, 1, 1}, middle[] = {0, 0};
    muster_Outline wall = {.rgb = 0xff8000};
    muster_Mount sonar = {
        .x_m = 0.1, .heading_rad = M_PI, .fov_rad = 0.5, .range_m = 5, .beams = 1};
    muster_Figure robot = {.name = words("</title>"), .color = words("red;}"), .controlled = true};
    muster_Scene scene = {.simulator = words("sim"),
                          .world = words("a \"world\""),
                          .seed = 3,
                          .step_ns = 100000000,
                          .min_x_m = -1,
                          .max_x_m = 1,
                          .max_y_m = 2.00004};
    wall.corners_m._buffer = corners;
    wall.corners_m._length = 6;
    robot.shape = (muster_Outline){.radius_m = 0.25};
    robot.shape.corners_m._buffer = middle;
    robot.shape.corners_m._length = 2;
    robot.sonars = (dds_sequence_muster_Mount){._length = 1, ._buffer = &sonar};
    scene.walls = (dds_sequence_muster_Outline){._length = 1, ._buffer = &wall};
    scene.robots = (dds_sequence_muster_Figure){._length = 1, ._buffer = &robot};
    begin();
    scene_json_write(&text, &scene);
    has("{\"world\": \"a \\\"world\\\"\", \"seed\": 3, \"step_ms\": 100, "
        "\"sensors\": [\"sonar\", \"laser\", \"camera\", \"fiducials\"");
    has("], \"bounds\": [-1, 0, 1, 2], "
        "\"walls\": [{\"rgb\": \"#ff8000\", \"corners\": [0, 0, 1, 0, 1, 1]}], "
        "\"robots\": [{\"name\": \"</title>\", \"color\": \"red;}\", "
        "\"identity\": {\"light\": \"#0c0415\", \"dark\": \"#ffd2d7\", \"pattern\": 0}, "
        "\"shape\": {\"rgb\": \"#000000\", \"radius\": 0.25, \"corners\": [0, 0]}, "
        "\"start\": [0, 0, 0], \"controlled\": true, "
        "\"sonars\": [[0.1, 0, 3.1416, 0.5, 5, 1]], \"lasers\": []}], \"objects\": []}\n");
}

static void test_a_run(void)
{
    struct run_json run = {.step = 0};
    begin();
    run_json_write(&j, &run);
    has("\"state\": \"none\"");
    muster_RunStatus status = {.simulator = words("simulator.1"),
                               .state = muster_RUN_DONE,
                               .step = 5,
                               .time_ns = 500000000,
                               .hash = words("12ab"),
                               .waits_for = words("<i>")};
    run_json_take(&run, &status);
    begin();
    run_json_write(&j, &run);
    has("{\"state\": \"done\", \"step\": 5, \"time_ms\": 500,");
    has("\"hash\": \"12ab\", \"waits_for\": \"<i>\", \"broker\": \"\"");
}

static void test_which_simulator_is_gone(void)
{
    struct run_json run = {.step = 0};
    muster_RunStatus status = {.simulator = words("simulator.2"),
                               .state = muster_RUN_RUNNING,
                               .hash = words(""),
                               .waits_for = words("")};
    run_json_take(&run, &status);
    run_json_lose(&run, "simulator.1"); /* of the run before */
    CU_ASSERT_TRUE(run_json_lives(&run));
    run_json_lose(&run, "simulator.2");
    CU_ASSERT_FALSE(run_json_lives(&run));
    status.state = muster_RUN_FAULT;
    run_json_take(&run, &status);
    run_json_lose(&run, "simulator.2"); /* how it has ended is still to be seen */
    begin();
    run_json_write(&j, &run);
    has("\"state\": \"fault\"");
}

static void counts(struct run_json *run, const char *wanted)
{
    begin();
    run_json_write(&j, run);
    has(wanted);
}

static void test_mails_are_those_of_all_brokers(void)
{
    struct run_json run = {.step = 0};
    muster_BrokerStatus a = {.broker = words("a"), .sent = 10, .delivered = 9, .dropped = 1};
    muster_BrokerStatus b = {.broker = words("b"), .sent = 5, .waiting = 4, .no_store = 1};
    run_json_mails(&run, &a);
    run_json_mails(&run, &b);
    counts(&run, "\"broker\": \"\", \"mails\": [15, 9, 4, 0, 2]"); /* neither has said that it is */
    run_json_broker(&run, "b", true);
    run_json_broker(&run, "a", true);
    run_json_broker(&run, "b", false);
    run_json_broker(&run, "c", false);
    counts(&run, "\"broker\": \"a\", \"mails\": [15, 9, 4, 0, 2]");
    run_json_begin(&run);
    counts(&run, "\"broker\": \"a\", \"mails\": [10, 9, 0, 0, 1]");
}

static void test_limit_brokers(void)
{
    struct run_json run = {.step = 0};
    for (int i = 0; i <= MU_BROKERS_MAX; i++) {
        char name[24];
        snprintf(name, sizeof name, "b%d", i);
        muster_BrokerStatus status = {.broker = name, .sent = 1};
        run_json_mails(&run, &status);
    }
    counts(&run, "\"mails\": [32, 0, 0, 0, 0]");
}

/* --- goals ------------------------------------------------------------------------------------ */

static void test_what_robots_want(void)
{
    muster_Frame f = frame_make();
    views[1].goal = words("gohome 3000.0 \"a b\"");
    begin();
    frame_json_write(&j, NULL, &f, false);
    has("\"goals\": [\"\", \"gohome 3000.0 \\\"a b\\\"\"]");
}

/* --- minds ------------------------------------------------------------------------------------ */

static struct minds *minds_make(void)
{
    static struct minds *m;
    if (!m) {
        m = minds_open(BYTES, 2);
        minds_add(m, "red", 1,
                  "0\n+1 (goal wander)\nS\n+2 (position 1 2)\nR see 2,1\nV 1 2\nA look 2\n"
                  "A turn 2,1\n");
        minds_add(m, "blue", 1, "0\n+1 (goal stay)\n");
        minds_add(m, "red", 3,
                  "S\n-2\n+3 (said \"</b>\")\nM blue 7 tell hello\n+4 (goal gohome 1 2)\n"
                  "R answer 4,*\nT blue - hi\n");
    }
    return m;
}

static const char *mind_at(const char *robot, uint32_t step)
{
    begin();
    mind_json_write(&j, NULL, minds_make(), robot, step);
    return text.at;
}

static void test_a_mind_at_a_step(void)
{
    READS(mind_at("red", 2),
          "{\"robot\": \"red\", \"step\": 1, "
          "\"facts\": [[\"f-1\", \"(goal wander)\"], [\"f-2\", \"(position 1 2)\"]], "
          "\"agenda\": [[\"look\", \"2\"], [\"turn\", \"2,1\"]], "
          "\"fired\": [[1, \"see\", \"2,1\"]], \"mails\": []}\n");
    READS(mind_at("red", 3),
          "{\"robot\": \"red\", \"step\": 3, "
          "\"facts\": [[\"f-1\", \"(goal wander)\"], [\"f-3\", \"(said \\\"</b>\\\")\"], "
          "[\"f-4\", \"(goal gohome 1 2)\"]], \"agenda\": [], "
          "\"fired\": [[3, \"answer\", \"4,*\"], [1, \"see\", \"2,1\"]], "
          "\"mails\": [[3, \"blue - hi\", true], [3, \"blue 7 tell hello\", false]]}\n");
}

static void test_a_mind_that_nobody_knows(void)
{
    static const char *const none = "\"step\": -1, \"facts\": [], \"agenda\": [], "
                                    "\"fired\": [], \"mails\": []}\n";
    (void)mind_at("red", 0);
    has(none);
    (void)mind_at("<b>", 5);
    has(none);
    has("{\"robot\": \"<b>\"");
}

static void test_of_long_facts_the_beginning_is_shown(void)
{
    char diary[MIND_JSON_TEXT_MAX + 64];
    struct minds *m = minds_open(BYTES, 1);
    memset(diary, 'x', sizeof diary);
    memcpy(diary, "+5 (", 4);
    memcpy(diary + sizeof diary - 3, ")\n", 3);
    minds_add(m, "red", 0, diary);
    begin();
    mind_json_write(&j, NULL, m, "red", 0);
    const char *at = strstr(text.at, "\"(x");
    CU_ASSERT_PTR_NOT_NULL_FATAL(at);
    CU_ASSERT_EQUAL(strcspn(at + 1, "\""), MIND_JSON_TEXT_MAX);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a frame in thousandths", test_a_frame_in_thousandths},
        {"totals", test_totals},
        {"beams are centimetres", test_beams_are_centimetres},
        {"of many beams some are shown", test_of_many_beams_some_are_shown},
        {"a frame says whose beams they are", test_a_frame_says_whose_beams_they_are},
        {"names from hell stay text", test_names_from_hell_stay_text},
        {"a character that is cut is no broken json",
         test_a_character_that_is_cut_is_no_broken_json},
        {"of many mails some are shown, people's first",
         test_of_many_mails_some_are_shown_people_s_first},
        {"rules and orders", test_rules_and_orders},
        {"a scene", test_a_scene},
        {"a run", test_a_run},
        {"which simulator is gone", test_which_simulator_is_gone},
        {"mails are those of all brokers", test_mails_are_those_of_all_brokers},
        {"limit: brokers", test_limit_brokers},
        {"a lean frame has no beams", test_a_lean_frame_has_no_beams},
        {"what robots want", test_what_robots_want},
        {"a mind at a step", test_a_mind_at_a_step},
        {"a mind that nobody knows", test_a_mind_that_nobody_knows},
        {"of long facts the beginning is shown", test_of_long_facts_the_beginning_is_shown},
        CU_TEST_INFO_NULL,
    };
    return suite_run("web/json", tests);
}
