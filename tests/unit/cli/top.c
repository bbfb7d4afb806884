/* SPDX-License-Identifier: Apache-2.0 */
/* What `muster top` shows: order, columns, names that would do harm to a terminal. */
#include "cli/terminal/terminal.h"
#include "muster/memory.h"
#include "suite.h"

#include <ctype.h>
#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 4, AGENTS = 2 };

static mu_stats *stats;
static struct top_line line;

static struct mu_figure figures[ROBOTS] = {{.name = "red", .controlled = true},
                                           {.name = "\x1b[2J\x07"
                                                    "evil\n",
                                            .controlled = true},
                                           {.name = "blue", .controlled = true},
                                           {.name = "ash", .controlled = true}};

static void robots_move(void)
{
    struct mu_scene scene = {.step_ns = MU_STEP_NS, .robot_count = ROBOTS, .robots = figures};
    struct mu_mail mails[2] = {{.performative = "tell"}, {.performative = "\x1b]0;x\x07"}};
    struct mu_act_view act = {.agent = "red", .mail_count = 2, .mails = mails, .diary = ""};
    struct mu_robot_view views[ROBOTS] = {
        {.name = "red", .state = MU_RUNNING, .distance_m = 2, .stalls = 3},
        {.name = "evil", .state = MU_SUSPENDED, .distance_m = 5, .x_m = 3},
        {.name = "blue", .state = MU_RUNNING, .distance_m = 2, .stalls = 9, .y_m = 40},
        {.name = "ash", .state = MU_STANDBY, .stalled = true, .x_m = 0.5}};
    struct mu_agent_view agents[AGENTS] = {{"clerk", MU_RUNNING, 7, 30, 9},
                                           {"boss", MU_STANDBY, 0, 2, 1}};
    struct mu_frame frame = {.step = 100,
                             .time_ns = 100 * MU_STEP_NS,
                             .robot_count = ROBOTS,
                             .robots = views,
                             .act_count = 1,
                             .acts = &act,
                             .agent_count = AGENTS,
                             .agents = agents};
    mu_stats_begin(stats, &scene);
    mu_stats_take(stats, &frame);
}

/* The first letters of the robots in order, and the numbers of the agents. */
static const char *sorted(const char *key)
{
    static char letters[ROBOTS + AGENTS + 1];
    size_t order[ROBOTS + AGENTS];
    top_table_sort(stats, top_table_key(key), order);
    for (size_t i = 0; i < ROBOTS + AGENTS; i++) {
        const struct mu_stats_robot *r = mu_stats_robot(stats, order[i]);
        letters[i] =
            r ? (char)(r->name[0] == '\x1b' ? 'E' : r->name[0]) : (char)('0' + order[i] - ROBOTS);
    }
    return letters;
}

static void test_order(void)
{
    robots_move();
    READS(sorted("name"), "Eab10r");
    READS(sorted("distance"), "Erba01"); /* equal ones as in the world */
    READS(sorted("stalls"), "brEa01");
    READS(sorted("state"), "a1rb0E");
    READS(sorted("sent"), "01rEba");
    READS(sorted("nearest"), "raEb01"); /* 0.5, 0.5, 2.5 and far away */
    CU_ASSERT_EQUAL(mu_stats_goal(stats, "blue", 50, 50, 1), MU_OK);
    READS(sorted("goal"), "brEa01"); /* who has none comes last */
}

static void test_keys(void)
{
    char keys[256];
    struct mu_text t;
    mu_text_init(&t, keys, sizeof keys);
    top_table_keys(&t);
    CU_ASSERT_FALSE(t.cut);
    CU_ASSERT_PTR_NOT_NULL(strstr(keys, "name, state, distance"));
    CU_ASSERT_EQUAL(top_table_key("distance"), 2);
    CU_ASSERT_EQUAL(top_table_key(""), -1);
    CU_ASSERT_EQUAL(top_table_key("DISTANCE"), -1);
    READS(top_table_key_of(-1), "y");
    READS(top_table_key_of(16), "name");
}

static bool is_printable(const char *text)
{
    for (; *text; text++) {
        if (!isprint((unsigned char)*text)) {
            return false;
        }
    }
    return true;
}

static void test_lines_are_printable(void)
{
    robots_move();
    struct mu_run_result result = {.end = MU_RUN_FAULT, .hash = "none", .reason = "\x1b[31mred\n"};
    for (size_t i = 0; i < ROBOTS; i++) {
        top_table_row(&line, stats, i, top_table_columns(0));
        CU_ASSERT_TRUE(is_printable(line.bytes));
        CU_ASSERT(line.text.len > 100);
    }
    for (size_t i = 0; i < TOP_TEAM_LINES; i++) {
        top_table_team(&line, stats, i);
        CU_ASSERT_TRUE(is_printable(line.bytes));
    }
    top_table_end(&line, &result);
    READS(line.bytes, "fault at step 0, 0.0 s: ?[31mred?");
}

static void test_columns_by_width(void)
{
    robots_move();
    size_t all = top_table_columns(0);
    CU_ASSERT_EQUAL(top_table_columns(1), 1);
    CU_ASSERT_EQUAL(top_table_columns(10000), all);
    for (size_t wide = 17; wide < 200; wide++) {
        size_t columns = top_table_columns(wide);
        top_table_head(&line, columns, 2);
        size_t head = line.text.len;
        top_table_row(&line, stats, 0, columns);
        CU_ASSERT_EQUAL(line.text.len, head);
        CU_ASSERT(line.text.len <= wide);
    }
    top_table_head(&line, 3, 2);
    READS(line.bytes, "NAME             STATE       DIST m*");
    top_table_row(&line, stats, 3, 3);
    READS(line.bytes, "ash              stalled        0.00");
    top_table_row(&line, stats, ROBOTS, 3);
    READS(line.bytes, "clerk            running           -");
    top_table_team(&line, stats, 0);
    CU_ASSERT_PTR_NOT_NULL(strstr(line.bytes, "4 robots, 2 agents, step 100"));
    top_table_team(&line, stats, 2);
    CU_ASSERT_PTR_NOT_NULL(strstr(line.bytes, "mail 32 sent, 10 received"));
}

static const char *json_of(size_t robot)
{
    static char *bytes;
    static size_t len;
    free(bytes);
    FILE *to = open_memstream(&bytes, &len);
    top_table_json(to, stats, robot);
    fclose(to);
    return bytes;
}

static void test_json(void)
{
    robots_move();
    const char *json = json_of(0);
    CU_ASSERT_PTR_NOT_NULL(strstr(json, "{\"step\": 100, \"time_s\": 10, \"name\": \"red\""));
    CU_ASSERT_PTR_NOT_NULL(strstr(json, "\"nearest_m\": 0.5, \"nearest\": \"ash\""));
    CU_ASSERT_PTR_NOT_NULL(strstr(json, "\"explored_fraction\": null"));
    json = json_of(1);
    CU_ASSERT_PTR_NOT_NULL(strstr(json, "\"most_efficient\": true"));
    CU_ASSERT_PTR_NULL(strchr(json, '\x1b'));
    CU_ASSERT_PTR_EQUAL(strchr(json, '\n'), json + strlen(json) - 1);
    READS(json_of(ROBOTS), "{\"step\": 100, \"time_s\": 10, \"name\": \"clerk\", "
                           "\"kind\": \"agent\", \"state\": \"running\", \"mail_sent\": 30, "
                           "\"mail_received\": 9, \"rule_firings\": 7}\n");
}

int main(void)
{
    stats = mu_stats_open();
    mu_memory_seal();
    CU_TestInfo tests[] = {
        {"order", test_order},
        {"keys", test_keys},
        {"lines are printable", test_lines_are_printable},
        {"columns by width", test_columns_by_width},
        {"JSON", test_json},
        CU_TEST_INFO_NULL,
    };
    return suite_run("top", tests);
}
