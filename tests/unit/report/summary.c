/* SPDX-License-Identifier: Apache-2.0 */
#include "core/json.h"
#include "core/text.h"
#include "report/report.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/muster-summary-XXXXXX";
static char path[64];
static struct mu_fault fault;
static struct summary s;
static char bytes[SUMMARY_BYTES_MAX + 64];

static mu_result read_bytes(const char *content, size_t len)
{
    FILE *file = fopen(path, "w");
    CU_ASSERT_FATAL(file && fwrite(content, 1, len, file) == len && fclose(file) == 0);
    summary_close(&s);
    return summary_read(&s, folder, &fault);
}

static mu_result read_text(const char *text)
{
    return read_bytes(text, strlen(text));
}

/* The summary of a run, with a member more. */
static mu_result read_member(const char *member)
{
    snprintf(bytes, sizeof bytes, "{\"experiment\": \"x\", \"hash\": \"aa\", %s}", member);
    return read_text(bytes);
}

static void test_a_run(void)
{
    CU_ASSERT_EQUAL_FATAL(
        read_member("\"seed\": 7, \"command\": \"muster run\", \"file\": \"x.yaml\",\n"
                    "\"duration_s\": 60, \"free\": true, \"broke_off\": true,\n"
                    "\"overrides\": [\"speed=2\"], \"undone\": [\"red has not moved.\"],\n"
                    "\"made_of\": [{\"file\": \"a/red.clp\", \"hash\": \"00ff\"}],\n"
                    "\"robots\": [{\"name\": \"red\", \"mail_sent\": 2, \"rule_firings\": 3}],\n"
                    "\"objects\": [{\"name\": \"puck\", \"x_m\": 1, \"y_m\": -2.5}],\n"
                    "\"mail\": {\"sent\": 5, \"duplicated\": 1},\n"
                    "\"restarts\": [{\"process\": \"red\", \"count\": 2}],\n"
                    "\"monitors\": [{\"name\": \"a\", \"rules\": \"a.clp\", \"ended\": \"with the "
                    "run\"}, {\"name\": \"b\", \"program\": \"/b\", \"ended\": \"killed\"}],\n"
                    "\"chaos\": [{\"done\": true, \"at_s\": 3}, {\"reason\": \"why\"}],\n"
                    "\"expectations\": [{\"met\": true}, {\"met\": false}, null]"),
        MU_OK);
    CU_ASSERT(s.seed == 7 && s.free && s.broke_off && s.duration_s == 60);
    READS(s.command, "muster run");
    READS(s.file, "x.yaml");
    READS(s.made_with, "");
    CU_ASSERT(s.overrides_count == 1 && s.undone_count == 1 && s.files_count == 1);
    READS(s.overrides[0], "speed=2");
    READS(s.undone[0], "red has not moved.");
    READS(s.files[0].name, "a/red.clp");
    CU_ASSERT_EQUAL(s.files[0].hash, 255);
    CU_ASSERT(s.robots_count == 1 && s.robots[0].mail_sent == 2 && s.robots[0].rule_firings == 3);
    CU_ASSERT(s.objects_count == 1 && s.objects[0].pose.y_m == -2.5);
    CU_ASSERT(s.mail.sent == 5 && s.mail.duplicated == 1 && !s.mail_unknown);
    CU_ASSERT(s.restarts_count == 1 && s.restarts[0].count == 2);
    CU_ASSERT_EQUAL_FATAL(s.monitors_count, 2);
    CU_ASSERT(s.monitors[0].fate == NULL && s.monitors[0].program == NULL);
    CU_ASSERT(s.monitors[1].rules == NULL);
    READS(s.monitors[1].fate, "killed");
    CU_ASSERT(s.chaos[0].done && s.chaos[0].at_s == 3 && !s.chaos[1].done);
    READS(s.chaos[1].reason, "why");
    READS(s.chaos[2].reason, "");
    CU_ASSERT(s.expected == 2 && s.met == 1);
}

static void test_statistics(void)
{
    CU_ASSERT_EQUAL_FATAL(
        read_member("\"robots\": [{\"name\": \"red\", \"final\": {\"x_m\": 2}, \"a\": 1},"
                    " {\"name\": \"red.2\", \"a\": 3}, {\"a\": \"b\"}],"
                    " \"mail\": {\"sent\": 4}, \"restarts\": [{\"count\": 5}], \"free\": true"),
        MU_OK);
    CU_ASSERT_EQUAL(summary_statistic(&s, "red.final.x_m"), 2);
    CU_ASSERT_EQUAL(summary_statistic(&s, "red.2.a"), 3);
    CU_ASSERT_EQUAL(summary_statistic(&s, "robots.a"), 2);
    CU_ASSERT_EQUAL(summary_statistic(&s, "mail.sent"), 4);
    CU_ASSERT_EQUAL(summary_statistic(&s, "restarts.0.count"), 5);
    static const char *const none[] = {
        "free",       "mail",       "red",        "red.final",
        "robots.b",   "blue.a",     "restarts.1", "restarts.x.count",
        "mail..sent", "robots.0.a", "",           "expectations.met"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        CU_ASSERT(isnan(summary_statistic(&s, none[i])));
    }
}

static void test_absent(void)
{
    summary_close(&s);
    CU_ASSERT_EQUAL(summary_read(&s, "/nowhere", &fault), MU_ABSENT);
    READS(fault.file, "/nowhere/summary.json");
    CU_ASSERT_PTR_NULL(s.document);
    READS(s.hash, "");
    READS(s.chaos[EXPERIMENT_CHAOS_MAX - 1].reason, "");
    CU_ASSERT_EQUAL(summary_read(&s, "/dev/null", &fault), MU_FAULT_FILE);
}

static void test_strings(void)
{
    CU_ASSERT_EQUAL(
        read_member("\"file\": \"a\\\"\\\\\\/\\n\\u00e9\\u20AC\\ud83d\\ude00\xc3\xa9\""), MU_OK);
    READS(s.file, "a\"\\/\n\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\xc3\xa9");
    static const char *const wrong[] = {"\"a\": \"\xff\"",    "\"a\": \"\xc3(\"",
                                        "\"\xff\": 1",        "\"a\": \"\xed\xa0\x80\"",
                                        "\"a\": \"\\ud83d\"", "\"a\": \"\\u0000\""};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CU_ASSERT_EQUAL(read_member(wrong[i]), MU_FAULT_FILE);
        CU_ASSERT_EQUAL(fault.line, 1);
        CU_ASSERT_PTR_NULL(s.document);
    }
}

static void test_numbers(void)
{
    CU_ASSERT_EQUAL(read_member("\"seed\": 18446744073709549568, \"wall_time_s\": 1e300, "
                                "\"sim_time_s\": 1e300, \"duration_s\": -1"),
                    MU_OK);
    CU_ASSERT(s.seed == 18446744073709549568u || s.seed == 0);
    CU_ASSERT_EQUAL(s.sim_time_s, SUMMARY_TIME_MAX_S);
    CU_ASSERT_EQUAL(s.duration_s, 0);
    CU_ASSERT_EQUAL(read_member("\"seed\": 9223372036854775808"), MU_OK);
    CU_ASSERT_EQUAL(s.seed, 9223372036854775808u);
    CU_ASSERT_EQUAL(read_member("\"seed\": -1, \"mail\": {\"sent\": 1e30}"), MU_OK);
    CU_ASSERT(s.seed == 0 && s.mail.sent == 0);
    CU_ASSERT_EQUAL(read_member("\"seed\": 1e999"), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(read_member("\"seed\": \"7\", \"robots\": 3, \"mail\": [], \"made_of\": {}, "
                                "\"objects\": [1, null], \"overrides\": [{}]"),
                    MU_OK);
    CU_ASSERT(s.seed == 0 && s.robots_count == 0 && s.files_count == 0);
    READS(s.objects[1].name, "");
    READS(s.overrides[0], "");
}

static void test_faults(void)
{
    static const struct {
        const char *text;
        int line, column;
        const char *expected;
    } rows[] = {
        {"{\"a\": 1,\n \"b\" 2}", 2, 6, "':' expected near '2'"},
        {"{\"a\": 1 \"b\": 2}", 1, 11, "'}' expected near '\"b\"'"},
        {"[1, 2", 1, 5, "']' expected near end of file"},
        {"[nan]", 1, 4, NULL},
        {"[0x10]", 1, 3, NULL},
        {"[01]", 1, 2, NULL},
        {"[1,]", 1, 4, NULL},
        {"[1-2]", 1, 4, NULL},
        {"[+1]", 1, 2, NULL},
        {"[\"\\x\"]", 1, 4, NULL},
        {"[\"a\nb\"]", 1, 3, NULL},
        {"{} 2", 1, 4, "end of file expected near '2'"},
        {"1", 1, 1, "'[' or '{' expected near '1'"},
        {"", 1, 0, NULL},
        {"{\"experiment\": \"x\"}", 0, 0, "expected the summary of a run"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        CU_ASSERT_EQUAL(read_text(rows[i].text), MU_FAULT_FILE);
        if (rows[i].expected) {
            READS(fault.text, rows[i].expected);
        }
        CU_ASSERT_EQUAL(fault.line, rows[i].line);
        CU_ASSERT_EQUAL(fault.column, rows[i].column);
        CU_ASSERT_PTR_NULL(s.document);
    }
    CU_ASSERT_EQUAL(read_bytes("{}\0 ", 4), MU_FAULT_FILE);
}

static void test_limits(void)
{
    static char deep[1 << 17];
    memset(deep, '[', sizeof deep);
    CU_ASSERT_EQUAL(read_bytes(deep, sizeof deep), MU_FAULT_FILE);
    memset(deep + sizeof deep / 2, ']', sizeof deep / 2);
    CU_ASSERT_EQUAL(read_bytes(deep, sizeof deep), MU_FAULT_FILE);
    READS(fault.text, "maximum parsing depth reached near '['");
    memset(bytes, ' ', sizeof bytes);
    CU_ASSERT_EQUAL(read_bytes(bytes, SUMMARY_BYTES_MAX + 1), MU_FAULT_FILE);
    READS(fault.text, "expected a summary of at most 4194304 bytes");

    struct mu_text text;
    mu_text_init(&text, deep, sizeof deep);
    for (int i = 0; i < 2 * SUMMARY_LIST_MAX; i++) {
        mu_text_add(&text, i > 0 ? ", {\"done\": true}" : "\"chaos\": [{\"done\": true}");
    }
    mu_text_add(&text, "], \"overrides\": [\"\"");
    for (int i = 0; i < 2 * SUMMARY_LIST_MAX; i++) {
        mu_text_add(&text, ", \"a\"");
    }
    mu_text_add(&text, "]");
    CU_ASSERT_EQUAL(read_member(deep), MU_OK);
    CU_ASSERT_EQUAL(s.overrides_count, SUMMARY_LIST_MAX);
    CU_ASSERT(s.chaos[EXPERIMENT_CHAOS_MAX - 1].done);
}

/* The reader reads what the writer writes. */
static void test_there_and_back(void)
{
    static char written[1024];
    struct mu_text text;
    struct mu_json j;
    mu_text_init(&text, written, sizeof written);
    mu_json_to_text(&j, &text, MU_JSON_INDENTED);
    mu_json_object(&j, NULL);
    mu_json_string(&j, "experiment", "</script>\x01\t\"\\\x7f\xff");
    mu_json_string(&j, "hash", "");
    mu_json_real(&j, "wall_time_s", 0.1);
    mu_json_string(&j, "file", NULL);
    mu_json_object(&j, "mail");
    mu_json_real(&j, "sent", (double)NAN);
    mu_json_end(&j);
    mu_json_end(&j);
    CU_ASSERT_EQUAL(read_text(written), MU_OK);
    READS(s.experiment, "</script>\x01\t\"\\\x7f\xef\xbf\xbd");
    READS(s.file, "");
    CU_ASSERT_EQUAL(s.wall_time_s, 0.1);
    CU_ASSERT(s.mail_unknown);
}

/* Each beginning of a document ends in a place that it has. */
static void test_cut_anywhere(void)
{
    static const char whole[] =
        "{\"experiment\": \"\\u00e9\\n\", \"hash\": \"\", \"c\": [1e3, {\"b\": true}, null]}";
    for (size_t len = 0; len < sizeof whole - 1; len++) {
        CU_ASSERT_EQUAL(read_bytes(whole, len), MU_FAULT_FILE);
        CU_ASSERT(fault.line == 1 && fault.column >= 0 && fault.column <= (int)len + 1);
    }
    CU_ASSERT_EQUAL(read_text(whole), MU_OK);
}

static int folder_make(void)
{
    int made = mkdtemp(folder) ? 0 : 1;
    snprintf(path, sizeof path, "%s/summary.json", folder);
    return made;
}

static int folder_remove(void)
{
    summary_close(&s);
    return unlink(path) == 0 && rmdir(folder) == 0 ? 0 : 1;
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a run", test_a_run},
        {"statistics", test_statistics},
        {"absent", test_absent},
        {"strings", test_strings},
        {"numbers", test_numbers},
        {"faults", test_faults},
        {"limits", test_limits},
        {"there and back", test_there_and_back},
        {"cut anywhere", test_cut_anywhere},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"report/summary", folder_make, folder_remove, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
