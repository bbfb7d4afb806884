/* SPDX-License-Identifier: Apache-2.0 */
#include "report/report.h"
#include "report/report_data.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define HEADER "time_s,robot,x_m,y_m,heading_rad,forward_m_s,turn_rad_s,stalled\n"

static char folder[] = "/tmp/muster-report-XXXXXX";
static char text[1 << 22]; /* of the file that was read last */
static struct mu_fault fault;
static struct report_result result;

/* A room of 4 m x 2 m of floor: 32 cells; the box around its walls is larger. */
#define STANDS .look = {.stops = true, .echoes = true}

static struct world_shape walls[] = {
    {STANDS, .kind = WORLD_BOX, .pose = {2, -0.05, 0}, .half_x_m = 2.1, .half_y_m = 0.05},
    {STANDS, .kind = WORLD_BOX, .pose = {2, 2.05, 0}, .half_x_m = 2.1, .half_y_m = 0.05},
    {STANDS, .kind = WORLD_BOX, .pose = {-0.05, 1, 0}, .half_x_m = 0.05, .half_y_m = 1.1},
    {STANDS, .kind = WORLD_BOX, .pose = {4.05, 1, 0}, .half_x_m = 0.05, .half_y_m = 1.1},
};
static struct world world = {.file = "room.world",
                             .min_x_m = 0,
                             .min_y_m = 0,
                             .max_x_m = 4,
                             .max_y_m = 2,
                             .shapes = walls,
                             .shape_count = 4};

static char red[] = "red", blue[] = "blue", line[] = "(follow <\"green\"> & co)", arena[] = "arena";
static char *targets[] = {red};
static struct experiment_command commands[] = {
    {.at = 0, .targets = targets, .targets_count = 1, .line = red},
    {.at = 1, .targets = targets, .targets_count = 1, .line = line},
};
static struct experiment_expectation expectations[] = {
    {.near_robot = red, .near_mate = blue, .within_m = 1, .from_s = 1, .to_s = 2, .share = 0.5},
    {.inside = arena},
    {.stall_max_s = 0.5},
    {.near_robot = red, .near_mate = blue, .within_m = 1, .from_s = 50, .to_s = 60, .share = 0.5},
};
static char name[] = "a test";
static struct experiment experiment = {.name = name,
                                       .duration = 3,
                                       .step_ms = 500,
                                       .observer = commands,
                                       .observer_count = 2,
                                       .expect = expectations,
                                       .expect_count = 4};
static struct report_robot robots[] = {{"red", 0xff0000, 1, 2, 3},
                                       {"blue", 0x0000ff, 4, 5, UINT64_MAX}};
static struct report_input input = {.experiment = &experiment,
                                    .world = &world,
                                    .seed = 7,
                                    .hash = "none",
                                    .sim_time_s = 3,
                                    .wall_time_s = 0.5,
                                    .command = "muster run a.yaml",
                                    .robots = robots,
                                    .robots_count = 2,
                                    .mail = {1, 2, 3, 4, 5, 6, 7}};

static const char *file_path(const char *file)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return path;
}

static void write_csv(const char *rows)
{
    FILE *file = fopen(file_path("run.csv"), "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fputs(rows, file);
    CU_ASSERT_EQUAL(fclose(file), 0);
}

static bool file_has(const char *file, const char *words)
{
    FILE *in = fopen(file_path(file), "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(in);
    text[fread(text, 1, sizeof text - 1, in)] = '\0';
    fclose(in);
    return strstr(text, words) != NULL;
}

static mu_result write_report(const char *rows)
{
    write_csv(rows);
    return report_write(folder, &input, &result, &fault);
}

/* red runs 3 m along +x and is stalled twice; blue stands. */
static const char two_robots[] = HEADER "0.5,red,0.25,0.25,0,1,0,0\n0.5,blue,2.25,0.25,1,0,0,0\n"
                                        "1,red,1.25,0.25,0,1,0,1\n1,blue,2.25,0.25,1,0,0,0\n"
                                        "1.5,red,1.75,0.25,0,1,0,0\n1.5,blue,2.25,0.25,1,0,0,0\n"
                                        "2,red,2.25,0.25,0,1,0,0\n2,blue,2.25,0.25,1,0,0,0\n"
                                        "2.5,red,3.25,0.25,0,1,0,1\n2.5,blue,2.25,0.25,1,0,0,0\n"
                                        "3,red,3.25,0.25,3.5,1,0,1\n3,blue,2.25,0.25,1,0,0,0\n";

static void test_statistics(void)
{
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    const struct report_robot_result *r = &result.robots[0];
    CU_ASSERT_DOUBLE_EQUAL(r->distance_m, 3, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(r->mean_speed_m_s, 3 / 2.5, 1e-12);
    CU_ASSERT_EQUAL(r->stalls, 2);
    CU_ASSERT_DOUBLE_EQUAL(r->stalled_s, 1.5, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(r->longest_stall_s, 1, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(r->final_x_m, 3.25, 0);
    CU_ASSERT_DOUBLE_EQUAL(r->final_heading_rad, 3.5, 0);
    CU_ASSERT_DOUBLE_EQUAL(result.robots[1].distance_m, 0, 0);
    CU_ASSERT_PTR_NULL(result.most_efficient); /* red was stalled for most of the time */
    CU_ASSERT_DOUBLE_EQUAL(result.explored_fraction, 7.0 / 32, 1e-12);
}

/* red goes farther, blue gets farther in the time in which nothing stops it. */
static void test_the_most_efficient(void)
{
    CU_ASSERT_EQUAL_FATAL(write_report(HEADER
                                       "0,red,0.25,0.25,0,1,0,0\n0,blue,0.25,1.25,0,1,0,0\n"
                                       "1,red,1.25,0.25,0,1,0,0\n1,blue,2.25,1.25,0,1,0,0\n"
                                       "2,red,2.25,0.25,0,1,0,0\n2,blue,3.25,1.25,0,1,0,0\n"
                                       "3,red,3.25,0.25,0,1,0,0\n3,blue,3.25,1.25,0,1,0,1\n"),
                          MU_OK);
    CU_ASSERT_STRING_EQUAL(result.most_efficient, "blue");
    CU_ASSERT_DOUBLE_EQUAL(result.efficiency_m_s, 1.5, 1e-6);
}

static void test_expectations(void)
{
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT_STRING_EQUAL(result.texts[0], "red within 1 m of blue for at least 50 % of 1 to 2 s");
    CU_ASSERT_STRING_EQUAL(result.measured[0], "100.0 %");
    CU_ASSERT(result.judged[0] && result.met[0]);
    CU_ASSERT(result.judged[1] && result.met[1]);
    CU_ASSERT(result.judged[2] && !result.met[2]);
    CU_ASSERT_STRING_EQUAL(result.measured[2], "red, 1.0 s");
    CU_ASSERT(!result.judged[3] && result.met[3]);
    CU_ASSERT_FALSE(result.all_met);

    expectations[0].share = 0.9;
    expectations[0].from_s = 0.5;
    expectations[2].stall_max_s = 1;
    world.max_x_m = 3;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT_STRING_EQUAL(result.measured[0], "75.0 %");
    CU_ASSERT_FALSE(result.met[0]);
    CU_ASSERT_FALSE(result.met[1]);
    CU_ASSERT_STRING_EQUAL(result.measured[1], "red was outside at 2.5 s");
    CU_ASSERT(result.met[2]);
    world.max_x_m = 4;
    expectations[0].share = 0.5;
    expectations[0].from_s = 1;

    /* A run that ended too soon, other than by plan, has met nothing that comes later. */
    experiment.duration = 55;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(result.judged[3] && !result.met[3] && !result.all_met);
    experiment.duration = 3;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(result.all_met);
    expectations[2].stall_max_s = 0.5;
}

static void events_write(const char *rows)
{
    FILE *file = fopen(file_path("events.csv"), "w");
    CU_ASSERT_FATAL(file && fputs(rows, file) >= 0 && fclose(file) == 0);
}

static char distance[] = "red.distance_m", mean[] = "robots.distance_m", sent[] = "mail.sent";
static char begins[] = "red stalled", says[] = "red told </svg>", ends[] = "red not stalled";

static void test_statistics_and_events(void)
{
    static char *ordered[] = {begins, says, ends}, *again[] = {begins, begins};
    static const char *events[] = {begins, says, ends};
    static struct experiment_robot team[] = {{.name = red}, {.name = blue}};
    static struct experiment_expectation wanted[] = {
        {.statistic = distance, .at_least = 3, .at_most = INFINITY},
        {.statistic = mean, .at_least = -INFINITY, .at_most = 1.4},
        {.statistic = sent, .at_least = 1, .at_most = 1},
        {.sequence = ordered, .sequence_count = 3, .within_s = 1},
        {.sequence = ordered, .sequence_count = 3, .within_s = 0.9},
        {.sequence = again, .sequence_count = 2},
        {.sequence = again, .sequence_count = 2, .from_s = 1.5},
        {.never = says},
        {.never = says, .from_s = 1.6},
        {.never = says, .from_s = 9},
    };
    static const bool met[] = {true, false, true, true, false, true, false, false, true, true};
    static const char *const measured[] = {"3",
                                           "1.5",
                                           "1",
                                           "at 1.0, 1.5, 2.0 s",
                                           "never so soon",
                                           "at 1.0, 2.5 s",
                                           "no: red stalled",
                                           "1 times, first at 1.5 s",
                                           "it never was",
                                           "not reached: the run was cut short"};
    struct experiment before = experiment;
    experiment.expect = wanted;
    experiment.expect_count = sizeof wanted / sizeof wanted[0];
    experiment.robots = team;
    experiment.robots_count = 2;
    experiment.events = events;
    experiment.events_count = 3;
    events_write("time_s,event\n0.500,red not stalled\n1.000,red stalled\n1.500,red told </svg>\n"
                 "2.000,red not stalled\n2.500,red stalled\n");
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    for (unsigned i = 0; i < experiment.expect_count; i++) {
        CU_ASSERT_EQUAL(result.met[i], met[i]);
        READS(result.measured[i], measured[i]);
        CU_ASSERT_EQUAL(result.judged[i], i < 9);
    }
    READS(result.texts[0], "red.distance_m at least 3");
    READS(result.texts[2], "mail.sent at least 1 and at most 1");
    READS(result.texts[3], "red stalled, then red told </svg>, then red not stalled, within 1 s");
    CU_ASSERT(file_has("report.html", "red told &lt;/svg&gt;"));
    CU_ASSERT_FALSE(file_has("report.html", "told </svg>"));
    FILE *many = fopen(file_path("events.csv"), "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(many);
    fputs("time_s,event\n", many);
    for (size_t i = 0; i < REPORT_EVENTS_MAX + 3; i++) {
        fputs("1,red stalled\n", many);
    }
    CU_ASSERT_EQUAL(fclose(many), 0);
    CU_ASSERT_EQUAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("report.html", "262144; 3 that came later are not judged"));
    events_write("time_s,event\n1,blue sings\n");
    CU_ASSERT_EQUAL(write_report(two_robots), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(fault.line, 2);
    unlink(file_path("events.csv"));
    CU_ASSERT_EQUAL(write_report(two_robots), MU_FAULT_OS);
    experiment = before;
}

static void test_chaos(void)
{
    static struct experiment_chaos chaos[] = {
        {.at = 1, .kind = CHAOS_PUSH, .who = red, .for_s = 1, .text = "push red <hard>"},
        {.kind = CHAOS_KILL, .when = begins, .who = red, .text = "kill red"}};
    static const struct report_chaos fates[] = {{true, 1.5, ""}, {false, 0, "it is <gone>"}};
    experiment.chaos = chaos;
    experiment.chaos_count = 2;
    input.chaos = fates;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("summary.json", "\"at_s\": 1.5,\n      \"text\": \"push red <hard>\","));
    CU_ASSERT(file_has("summary.json", "\"at_s\": null,\n      \"text\": \"kill red\",\n      "
                                       "\"done\": false,\n      \"reason\": \"it is <gone>\""));
    CU_ASSERT(file_has("report.html", "push red &lt;hard&gt;"));
    CU_ASSERT_FALSE(file_has("report.html", "<hard>"));
    CU_ASSERT_FALSE(file_has("report.html", "<gone>"));
    experiment.chaos_count = 0;
    input.chaos = NULL;
}

static void test_things_at_the_end(void)
{
    static char some[] = "puck*", one[] = "puck_b", none[] = "crate*";
    static struct experiment_place here = {1, 1};
    static struct experiment_expectation wanted[] = {
        {.objects = some, .at = &here, .within_m = 0.5},
        {.objects = some, .at = &here, .within_m = 0.5, .count = 2},
        {.objects = one, .at = &here, .within_m = 0.5},
        {.objects = none, .at = &here, .within_m = 0.5},
    };
    static const struct report_object objects[] = {
        {"puck_a", {1.5, 1, 0}}, {"puck_b", {1, 0.5, 2}}, {"puck_c", {1, 1.6, 0}}};
    input.objects = objects;
    input.objects_count = 3;
    experiment.expect = wanted;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT_STRING_EQUAL(result.texts[0], "3 of puck* within 0.5 m of 1, 1 at the end");
    CU_ASSERT_STRING_EQUAL(result.measured[0], "2 of 3");
    CU_ASSERT(result.judged[0] && !result.met[0]);
    CU_ASSERT(result.judged[1] && result.met[1]);
    CU_ASSERT(result.judged[2] && result.met[2]);
    CU_ASSERT(result.judged[3] && !result.met[3]); /* there is no such thing */
    CU_ASSERT_FALSE(result.all_met);
    CU_ASSERT(file_has("summary.json", "\"name\": \"puck_b\",\n      \"x_m\": 1,"));
    wanted[0].from_s = wanted[3].from_s = 3; /* the duration */
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(!result.judged[0] && !result.judged[3] && result.all_met);
    input.objects_count = 0;
    experiment.expect = expectations;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT_FALSE(file_has("summary.json", "objects"));
}

static void test_restarts(void)
{
    static const struct report_restarts restarts[] = {{"red", 2}};
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT_FALSE(file_has("summary.json", "restarts"));
    input.restarts = restarts;
    input.restarts_count = 1;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("summary.json", "\"process\": \"red\",\n      \"count\": 2\n"));
    input.restarts_count = 0;
}

static void test_monitors(void)
{
    static const struct report_monitor monitors[] = {
        {.name = "watch", .rules = "/r/<watch>.clp"},
        {.name = "mine", .program = "/p/mine", .fate = "was killed by signal 9 (Killed)"}};
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT_FALSE(file_has("summary.json", "monitors"));
    CU_ASSERT_FALSE(file_has("report.html", "Monitors"));
    input.monitors = monitors;
    input.monitors_count = 2;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("summary.json", "\"rules\": \"/r/<watch>.clp\",\n      \"log\": "
                                       "\"watch.log\",\n      \"ended\": \"with the run\""));
    CU_ASSERT(file_has("summary.json", "\"program\": \"/p/mine\""));
    CU_ASSERT(file_has("report.html", "/r/&lt;watch&gt;.clp"));
    CU_ASSERT(file_has("report.html", "<a href=\"mine.log\">mine.log</a>"));
    CU_ASSERT(file_has("report.html", "was killed by signal 9 (Killed)"));
    input.monitors_count = 0;
}

static void test_words_of_the_page(void)
{
    static char south[] = "south", any[] = "*";
    static struct experiment_place home = {0, 0};
    static struct experiment_expectation things = {.objects = any, .at = &home, .within_m = 1};
    const struct experiment before = experiment;
    struct experiment_command moves = {
        .at = 1, .targets = targets, .targets_count = 1, .move = south};
    experiment.observer = &moves;
    experiment.observer_count = 1;
    experiment.expect_count = 0;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("report.html", "red: move to south"));
    CU_ASSERT_FALSE(file_has("report.html", "(null)"));
    CU_ASSERT(file_has("report.html", "nothing was expected of it"));
    CU_ASSERT(file_has("report.html", "This run has no hash"));
    experiment.expect = &things;
    experiment.expect_count = 1;
    input.hash = "0123";
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("report.html", "not everything as expected"));
    CU_ASSERT(file_has("report.html", "The same seed gives the same hash, on every"));
    CU_ASSERT_STRING_EQUAL(result.texts[0], "0 of all things within 1 m of 0, 0 at the end");
    input.hash = "none";
    experiment = before;
}

static void test_a_run_that_broke_off(void)
{
    static char statistic[] = "mail.lost";
    static struct experiment_expectation lost = {.statistic = statistic, .at_least = -INFINITY};
    struct experiment_expectation *before = experiment.expect;
    unsigned count = experiment.expect_count;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT_FALSE(file_has("summary.json", "broke_off"));
    CU_ASSERT_FALSE(file_has("report.html", "broke off"));
    experiment.expect = &lost;
    experiment.expect_count = 1;
    input.broke_off = input.mail_unknown = true;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("summary.json", "\"broke_off\": true"));
    CU_ASSERT(file_has("summary.json", "\"lost\": null"));
    CU_ASSERT(file_has("report.html", "where it broke off"));
    CU_ASSERT(!result.judged[0] && result.met[0]);
    CU_ASSERT_STRING_EQUAL(result.measured[0], "not known: the brokers' counters are lost");
    input.broke_off = input.mail_unknown = false;
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(result.judged[0] && result.met[0] == (input.mail.lost == 0));
    experiment.expect = before;
    experiment.expect_count = count;
}

static void test_files(void)
{
    CU_ASSERT_EQUAL_FATAL(write_report(two_robots), MU_OK);
    CU_ASSERT(file_has("summary.json", "\"experiment\": \"a test\",\n  \"seed\": 7,"));
    CU_ASSERT(strstr(text, "\"real_time_factor\": 6,") != NULL);
    CU_ASSERT(strstr(text, "\"stalls\": 2,\n      \"stalled_s\": 1.5,") != NULL);
    CU_ASSERT(strstr(text, "\"rule_firings\": 18446744073709551615") != NULL);
    CU_ASSERT(strstr(text, "\"heading_rad\": 3.5") != NULL);
    CU_ASSERT(strstr(text, "\"duplicated\": 7") != NULL);
    CU_ASSERT(strstr(text, "50 % of 1 to 2 s\",\n      \"met\": true") != NULL);
    CU_ASSERT_PTR_NULL(strstr(text, "50 s on"));
    CU_ASSERT(file_has("tracks.svg", "stroke=\"#e70c44\""));
    CU_ASSERT(strstr(text, "stroke=\"#0179d0\"") != NULL);
    CU_ASSERT(file_has("bearing.svg", "stroke-dasharray"));
    CU_ASSERT(strstr(text, "red: (follow &lt;&quot;green&quot;&gt; &amp; co)") != NULL);
    CU_ASSERT_PTR_NULL(strstr(text, "red: red")); /* what was commanded at 0 */
    CU_ASSERT(file_has("report.html", "<!DOCTYPE html>"));
    CU_ASSERT(strstr(text, "muster run a.yaml") != NULL);
    CU_ASSERT(strstr(text, "</figure>") != NULL);
    CU_ASSERT(access(file_path(".report.html.new"), F_OK) != 0);
}

static void test_lines_break_at_the_wrap(void)
{
    CU_ASSERT_EQUAL_FATAL(write_report(HEADER "0,red,1,1,3,0,0,0\n1,red,1,1,3.1,0,0,0\n"
                                              "2,red,1,1,-3.1,0,0,0\n3,red,1,1,-3,0,0,0\n"),
                          MU_OK);
    CU_ASSERT_FATAL(file_has("bearing.svg", "fill=\"none\" stroke=\"#e70c44\""));
    const char *path = strstr(strstr(text, "fill=\"none\" stroke=\"#e70c44\""), " d=\"");
    const char *end = strchr(path + 4, '"');
    size_t pens = 0;
    for (const char *c = path; c < end; c++) {
        pens += *c == 'M';
    }
    CU_ASSERT_EQUAL(pens, 2);
}

static void test_names_cannot_break_a_file(void)
{
    static char bad[] = "</text><script>\"'&\x01\xff";
    static char bad_blue[] = "x\"/><b>";
    struct report_robot kept = robots[0];
    experiment.name = bad;
    robots[0].name = bad_blue;
    CU_ASSERT_EQUAL_FATAL(write_report(HEADER "1,x\"/><b>,1,1,0,0,0,0\n"), MU_OK);
    static const char *const files[] = {"tracks.svg", "bearing.svg", "report.html"};
    for (size_t i = 0; i < 3; i++) {
        CU_ASSERT(file_has(files[i], "x&quot;/&gt;&lt;b&gt;"));
        CU_ASSERT_PTR_NULL(strstr(text, "<script"));
        CU_ASSERT_PTR_NULL(strchr(text, '\x01'));
        CU_ASSERT_PTR_NULL(strchr(text, '\xff'));
    }
    CU_ASSERT(file_has("summary.json", "\"</text><script>\\\"'&\\u0001\xef\xbf\xbd\""));
    experiment.name = name;
    robots[0] = kept;
}

static void test_bad_rows(void)
{
    static const struct {
        const char *rows;
        int line;
        const char *words;
    } cases[] = {
        {"", 1, "it is empty"},
        {"time_s,robot\n", 1, "expected the line 'time_s,robot"},
        {HEADER "1,red,1,1,0,0,0\n", 2, "expected 8 fields, not 7"},
        {HEADER "1,red,1,1,0,0,0,0,0\n", 2, "expected 8 fields, not 9"},
        {HEADER "1,red,1,1,0,0,0,0\n\n", 3, "expected 8 fields, not 1"},
        {HEADER "1,pink,1,1,0,0,0,0\n", 2, "no robot 'pink'"},
        {HEADER "1,red,x,1,0,0,0,0\n", 2, "expected a number, not 'x'"},
        {HEADER "1,red,1,nan,0,0,0,0\n", 2, "expected a number, not 'nan'"},
        {HEADER "1,red,1,1,0,,0,0\n", 2, "expected a number, not ''"},
        {HEADER "1,red,1,1,0,0,0,2\n", 2, "expected stalled 0 or 1"},
        {HEADER "2,red,1,1,0,0,0,0\n1,red,1,1,0,0,0,0\n", 3, "expected a time from 2 s on"},
        {HEADER "1,red,1,1,0,0,0,0", 2, "expected a whole line"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_EQUAL(write_report(cases[i].rows), MU_FAULT_FILE);
        CU_ASSERT_EQUAL(fault.line, cases[i].line);
        CU_ASSERT(strstr(fault.text, cases[i].words) != NULL);
        CU_ASSERT_STRING_EQUAL(fault.file, file_path("run.csv"));
    }
}

static void test_no_rows_and_no_file(void)
{
    CU_ASSERT_EQUAL(write_report(HEADER), MU_OK);
    CU_ASSERT_PTR_NULL(result.most_efficient);
    CU_ASSERT_FALSE(result.all_met);
    CU_ASSERT(file_has("summary.json", "\"most_efficient\": null"));
    CU_ASSERT_EQUAL(unlink(file_path("run.csv")), 0);
    CU_ASSERT_EQUAL(report_write(folder, &input, &result, &fault), MU_FAULT_OS);
    CU_ASSERT_STRING_EQUAL(fault.file, file_path("run.csv"));
}

/* A limit on the size of files does what a full disk does. */
static void test_full_disk(void)
{
    struct rlimit all, little;
    write_csv(two_robots);
    unlink(file_path("summary.json"));
    CU_ASSERT_EQUAL_FATAL(getrlimit(RLIMIT_FSIZE, &all), 0);
    little = all;
    little.rlim_cur = 100;
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &little);
    mu_result written = report_write(folder, &input, &result, &fault);
    setrlimit(RLIMIT_FSIZE, &all);
    CU_ASSERT_EQUAL(written, MU_FAULT_OS);
    CU_ASSERT_STRING_EQUAL(fault.file, file_path("summary.json"));
    CU_ASSERT(access(file_path("summary.json"), F_OK) != 0);
    CU_ASSERT(access(file_path(".summary.json.new"), F_OK) != 0);
}

static void test_explored_floor_ends_at_walls(void)
{
    /* A wall in the middle: what lies behind it is no floor. */
    static struct world_shape split[5];
    memcpy(split, walls, sizeof walls);
    split[4] = (struct world_shape){STANDS, .kind = WORLD_BOX, .pose = {1, 2, M_PI / 2},
                                    .half_x_m = 2, .half_y_m = 0.01};
    world.shapes = split;
    world.shape_count = 5;
    CU_ASSERT_EQUAL_FATAL(write_report(HEADER "1,red,0.25,0.25,0,0,0,0\n"), MU_OK);
    CU_ASSERT_DOUBLE_EQUAL(result.explored_fraction, 1.0 / 8, 1e-12);
    /* A cell that is mostly wall is none, unless a robot was in what is left of it. */
    split[4] = (struct world_shape){STANDS, .kind = WORLD_BOX, .pose = {0.175, 0.25, 0},
                                    .half_x_m = 0.175, .half_y_m = 0.25};
    CU_ASSERT_EQUAL_FATAL(write_report(HEADER "1,red,0.75,0.25,0,0,0,0\n"), MU_OK);
    CU_ASSERT_DOUBLE_EQUAL(result.explored_fraction, 1.0 / 31, 1e-12);
    CU_ASSERT_EQUAL_FATAL(write_report(HEADER "1,red,0.45,0.25,0,0,0,0\n"), MU_OK);
    CU_ASSERT_DOUBLE_EQUAL(result.explored_fraction, 1.0 / 32, 1e-12);
    split[4].look = (struct world_look){.shows = true}; /* a mark on the floor is no wall */
    CU_ASSERT_EQUAL_FATAL(write_report(HEADER "1,red,0.25,0.25,0,0,0,0\n"), MU_OK);
    CU_ASSERT(result.explored_fraction < 0.1);
    world.shapes = walls;
    world.shape_count = 4;
}

/* Takes a folder in the test's own and lets it go at once, as a run that is over. */
static mu_result folder_use(const char *file)
{
    char path[96], taken[128], lock[160];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    mu_result done = report_folder(path, false, taken, sizeof taken, &fault);
    if (done == MU_OK) {
        CU_ASSERT_EQUAL(strncmp(taken, path, strlen(taken)), 0);
        snprintf(lock, sizeof lock, "%s/.running", taken);
        CU_ASSERT_EQUAL(access(lock, F_OK), 0);
        report_folder_release(taken);
        CU_ASSERT_EQUAL(access(lock, F_OK), -1);
    }
    return done;
}

static void file_make(const char *file)
{
    FILE *made = fopen(file_path(file), "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(made);
    fclose(made);
}

static void test_folders(void)
{
    static const char *const signs[] = {"run.csv", "summary.json", ".running"};
    char file[64];
    CU_ASSERT_EQUAL(folder_use("out/deep/run-1/"), MU_OK);
    for (size_t i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(folder_use("out/deep/run-1"), MU_OK); /* empty: used as it is */
        snprintf(file, sizeof file, "out/deep/run-1/%s", signs[i]);
        file_make(file);
        CU_ASSERT_EQUAL(folder_use("out/deep/run-1"), MU_OK);
        snprintf(file, sizeof file, "out/deep/run-1.%zu/%s", i + 1, signs[i]);
        CU_ASSERT_EQUAL(unlink(file_path(file)), 0); /* the first one is .1 */
    }
    static const char *const made[] = {"out/deep/run-1",   "out/deep/run-1.1", "out/deep/run-1.2",
                                       "out/deep/run-1.3", "out/deep",         "out"};
    for (size_t i = 0; i < sizeof made / sizeof made[0]; i++) {
        CU_ASSERT_EQUAL(rmdir(file_path(made[i])), 0);
    }
    write_csv(HEADER);
    CU_ASSERT_EQUAL(folder_use("run.csv/run"), MU_FAULT_OS);
    CU_ASSERT(strstr(fault.text, "Not a directory") != NULL || strstr(fault.text, "File exists"));
    char taken[8];
    CU_ASSERT_EQUAL(report_folder("", false, taken, sizeof taken, &fault), MU_FAULT_OS);
}

static void test_folders_of_others_stay(void)
{
    static const char words[] = "is there and is not a report of muster; choose another --out";
    file_make("plain");
    CU_ASSERT_EQUAL(mkdir(file_path("theirs"), 0700), 0);
    file_make("theirs/thesis.tex");
    CU_ASSERT_EQUAL(symlink("theirs", file_path("link")), 0);
    CU_ASSERT_EQUAL(symlink("nowhere", file_path("dangling")), 0);
    static const char *const there[] = {"plain", "theirs", "link", "dangling"};
    for (size_t i = 0; i < sizeof there / sizeof there[0]; i++) {
        CU_ASSERT_EQUAL(folder_use(there[i]), MU_FAULT_OS);
        CU_ASSERT(strstr(fault.text, words) && strstr(fault.text, there[i]));
    }
    CU_ASSERT_EQUAL(access(file_path("nowhere"), F_OK), -1);
    static const char *const made[] = {"dangling", "link", "plain", "theirs/thesis.tex"};
    for (size_t i = 0; i < sizeof made / sizeof made[0]; i++) {
        CU_ASSERT_EQUAL(unlink(file_path(made[i])), 0);
    }
    CU_ASSERT_EQUAL(rmdir(file_path("theirs")), 0);
}

/* Another process that takes the folder and lives until its pipe is closed. */
static pid_t holder_start(const char *path, int *leave)
{
    int gate[2], word[2];
    char c = 0;
    CU_ASSERT_EQUAL_FATAL(pipe(gate) | pipe(word), 0);
    pid_t holder = fork();
    if (holder == 0) {
        char taken[128];
        close(gate[1]);
        mu_result done = report_folder(path, false, taken, sizeof taken, &fault);
        ssize_t told = write(word[1], done == MU_OK ? "y" : "n", 1);
        ssize_t ended = read(gate[0], &c, 1);
        _exit(told == 1 && ended == 0 ? 0 : 1);
    }
    CU_ASSERT_EQUAL(read(word[0], &c, 1), 1);
    CU_ASSERT_EQUAL(c, 'y');
    close(gate[0]);
    close(word[0]);
    close(word[1]);
    *leave = gate[1];
    return holder;
}

static void test_two_runs_never_share_a_folder(void)
{
    char path[96], taken[128];
    int leave, status;
    snprintf(path, sizeof path, "%s/live", folder);
    pid_t holder = holder_start(path, &leave);
    CU_ASSERT_EQUAL(report_folder(path, false, taken, sizeof taken, &fault), MU_FAULT_OS);
    CU_ASSERT(strstr(fault.text, "another run is writing there") != NULL);
    CU_ASSERT_EQUAL(report_folder(path, true, taken, sizeof taken, &fault), MU_OK);
    CU_ASSERT_STRING_EQUAL(taken, file_path("live.1"));
    CU_ASSERT_EQUAL(report_folder(path, true, taken, sizeof taken, &fault), MU_OK);
    CU_ASSERT_STRING_EQUAL(taken, file_path("live.2"));
    CU_ASSERT_EQUAL(report_folder(path, true, taken, strlen(path) + 2, &fault), MU_FAULT_OS);
    close(leave);
    CU_ASSERT_EQUAL(waitpid(holder, &status, 0), holder);
    CU_ASSERT_EQUAL(status, 0);
    /* Who was killed has left a lock file that nobody holds. */
    CU_ASSERT_EQUAL(report_folder(path, true, taken, sizeof taken, &fault), MU_OK);
    CU_ASSERT_STRING_EQUAL(taken, path);
    static const char *const made[] = {"live", "live.1", "live.2", "live.3"};
    for (size_t i = 0; i < sizeof made / sizeof made[0]; i++) {
        snprintf(taken, sizeof taken, "%s/%s", folder, made[i]);
        CU_ASSERT_EQUAL(access(taken, F_OK), 0);
        report_folder_release(taken);
        CU_ASSERT_EQUAL(rmdir(taken), 0);
    }
}

/* Many at once: each gets a folder of its own. */
static void test_races_for_a_folder(void)
{
    enum { RUNNERS = 12 };
    char path[96], taken[128];
    pid_t runners[RUNNERS];
    int gate[2], status;
    snprintf(path, sizeof path, "%s/race", folder);
    CU_ASSERT_EQUAL(mkdir(path, 0777), 0);
    file_make("race/run.csv");
    CU_ASSERT_EQUAL_FATAL(pipe(gate), 0);
    int ready[2];
    CU_ASSERT_EQUAL_FATAL(pipe(ready), 0);
    for (size_t i = 0; i < RUNNERS; i++) {
        runners[i] = fork();
        if (runners[i] == 0) {
            char c;
            close(gate[1]);
            mu_result done = report_folder(path, true, taken, sizeof taken, &fault);
            ssize_t said = write(ready[1], "", 1);
            ssize_t ended = read(gate[0], &c, 1); /* all live until all have one */
            _exit(done == MU_OK && said == 1 && ended == 0 ? 0 : 1);
        }
    }
    close(ready[1]);
    for (size_t i = 0; i < RUNNERS; i++) {
        char c;
        CU_ASSERT_EQUAL(read(ready[0], &c, 1), 1); /* one that has its folder */
    }
    close(ready[0]);
    close(gate[1]);
    close(gate[0]);
    for (size_t i = 0; i < RUNNERS; i++) {
        CU_ASSERT_EQUAL(waitpid(runners[i], &status, 0), runners[i]);
        CU_ASSERT_EQUAL(status, 0);
    }
    unsigned earlier = 0, taken_count = 0;
    for (size_t i = 0; i <= RUNNERS; i++) {
        char file[64];
        snprintf(file, sizeof file, i ? "race.%zu/run.csv" : "race/run.csv", i);
        earlier += unlink(file_path(file)) == 0;
        snprintf(file, sizeof file, i ? "race.%zu/.running" : "race/.running", i);
        taken_count += unlink(file_path(file)) == 0;
        snprintf(file, sizeof file, i ? "race.%zu" : "race", i);
        CU_ASSERT_EQUAL(rmdir(file_path(file)), 0);
    }
    CU_ASSERT_EQUAL(earlier, 1);
    CU_ASSERT_EQUAL(taken_count, RUNNERS);
}

static void test_limit_samples_and_robots(void)
{
    static struct report_robot many[MU_ROBOTS_MAX];
    static char names[MU_ROBOTS_MAX][8];
    struct report_input full = input;
    full.robots = many;
    full.robots_count = MU_ROBOTS_MAX;
    FILE *file = fopen(file_path("run.csv"), "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fputs(HEADER, file);
    size_t steps = REPORT_SAMPLES_MAX / MU_ROBOTS_MAX + 2;
    for (size_t i = 0; i < MU_ROBOTS_MAX; i++) {
        snprintf(names[i], sizeof names[i], "r%zu", i);
        many[i].name = names[i];
    }
    for (size_t step = 0; step < steps; step++) {
        for (size_t i = 0; i < MU_ROBOTS_MAX; i++) {
            fprintf(file, "%zu,r%zu,%g,1,0,0,0,0\n", step, i, 0.01 * (double)step);
        }
    }
    fclose(file);
    CU_ASSERT_EQUAL(report_write(folder, &full, &result, &fault), MU_OK);
    double want_m = 0.01 * (double)(steps - 1);
    CU_ASSERT_DOUBLE_EQUAL(result.robots[MU_ROBOTS_MAX - 1].distance_m, want_m, 1e-9);
    CU_ASSERT(file_has("tracks.svg", "and 1000 more"));
}

static void test_limit_expectations(void)
{
    static struct experiment_expectation many[EXPERIMENT_EXPECTATIONS_MAX];
    for (size_t i = 0; i < EXPERIMENT_EXPECTATIONS_MAX; i++) {
        many[i].stall_max_s = 10;
    }
    experiment.expect = many;
    experiment.expect_count = EXPERIMENT_EXPECTATIONS_MAX;
    CU_ASSERT_EQUAL(write_report(two_robots), MU_OK);
    CU_ASSERT(result.all_met && result.judged[EXPERIMENT_EXPECTATIONS_MAX - 1]);
    experiment.expect = expectations;
    experiment.expect_count = 4;
}

static int folder_make(void)
{
    return mkdtemp(folder) ? 0 : 1;
}

static int folder_remove(void)
{
    static const char *const names[] = {"run.csv", "summary.json", "tracks.svg", "bearing.svg",
                                        "report.html"};
    int failed = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        failed |= unlink(file_path(names[i]));
    }
    return failed | rmdir(folder);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"statistics", test_statistics},
        {"the most efficient", test_the_most_efficient},
        {"expectations", test_expectations},
        {"statistics and events", test_statistics_and_events},
        {"chaos", test_chaos},
        {"things at the end", test_things_at_the_end},
        {"restarts", test_restarts},
        {"monitors", test_monitors},
        {"words of the page", test_words_of_the_page},
        {"a run that broke off", test_a_run_that_broke_off},
        {"files", test_files},
        {"lines break at the wrap", test_lines_break_at_the_wrap},
        {"names cannot break a file", test_names_cannot_break_a_file},
        {"bad rows", test_bad_rows},
        {"no rows, and no file", test_no_rows_and_no_file},
        {"a full disk", test_full_disk},
        {"explored floor ends at walls", test_explored_floor_ends_at_walls},
        {"folders", test_folders},
        {"folders of others stay", test_folders_of_others_stay},
        {"two runs never share a folder", test_two_runs_never_share_a_folder},
        {"races for a folder", test_races_for_a_folder},
        {"limit: samples and robots", test_limit_samples_and_robots},
        {"limit: expectations", test_limit_expectations},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"report/report", folder_make, folder_remove, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
