/* SPDX-License-Identifier: Apache-2.0 */
/* How things end and what is said about it: exit codes, words for results, faults, log, memory. */
#include "core/exits.h"
#include "capture.h"
#include "core/clock.h"
#include "core/fault.h"
#include "core/log.h"
#include "muster/memory.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* Scripts rely on the numbers. */
static void test_every_result_has_its_exit_code(void)
{
    static const struct {
        mu_result result;
        int code;
    } table[] = {
        {MU_OK, 0},         {MU_DONE, 0},       {MU_FAULT_USAGE, 2}, {MU_FAULT_FILE, 3},
        {MU_MALFORMED, 3},  {MU_FAULT_DDS, 11}, {MU_BUSY, 4},        {MU_TIMEOUT, 4},
        {MU_NAME_HELD, 4},  {MU_REFUSED, 6},    {MU_ABSENT, 7},      {MU_EXISTS, 8},
        {MU_FULL, 8},       {MU_DUPLICATE, 8},  {MU_FAULT_OS, 9},    {(mu_result)-99, 5},
        {(mu_result)99, 5},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        CU_ASSERT_EQUAL(mu_exit_for(table[i].result), table[i].code);
    }
}

static void test_every_result_has_its_word(void)
{
    static const struct {
        mu_result result;
        const char *text;
    } table[] = {
#define X(name, value, text) {MU_##name, text},
        MU_RESULTS(X)
#undef X
    };
    enum { COUNT = sizeof table / sizeof table[0] };
    for (size_t i = 0; i < COUNT; i++) {
        CU_ASSERT_STRING_EQUAL(mu_result_text(table[i].result), table[i].text);
        for (size_t k = 0; k < i; k++) {
            CU_ASSERT_STRING_NOT_EQUAL(table[i].text, table[k].text);
        }
    }
    CU_ASSERT_STRING_EQUAL(mu_result_text((mu_result)99), "unknown-result");
}

static mu_result passed_up(mu_result r)
{
    MU_TRY(r);
    return MU_DONE;
}

static void test_faults_are_passed_up_and_outcomes_are_not(void)
{
    capture_begin();
    mu_result fault = passed_up(MU_FAULT_DDS);
    capture_end();
    CU_ASSERT_EQUAL(fault, MU_FAULT_DDS);
    CU_ASSERT(said("fault dds-failure: passed_up ("));
    capture_begin();
    CU_ASSERT_EQUAL(passed_up(MU_OK), MU_DONE);
    CU_ASSERT_EQUAL(passed_up(MU_FULL), MU_DONE);
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured, "");
}

static void test_fault_says_where(void)
{
    static struct mu_fault fault;
    static const struct {
        int line, column;
        const char *want;
    } cases[] = {{3, 7, "a.yaml:3:7: no robot 7\n"},
                 {3, 0, "a.yaml:3: no robot 7\n"},
                 {0, 7, "a.yaml: no robot 7\n"}};
    for (size_t i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(
            mu_fault_at(&fault, "a.yaml", cases[i].line, cases[i].column, "no robot %d", 7),
            MU_FAULT_FILE);
        capture_begin();
        mu_fault_print(&fault);
        capture_end();
        CU_ASSERT_STRING_EQUAL(captured, cases[i].want);
    }
}

static void test_limit_fault_is_cut(void)
{
    static struct mu_fault fault;
    static char file[2 * MU_FAULT_FILE_MAX];
    static char text[2 * MU_FAULT_TEXT_MAX];
    memset(file, 'f', sizeof file - 1);
    memset(text, 't', sizeof text - 1);
    mu_fault_at(&fault, file, 1, 1, "%s", text);
    CU_ASSERT_EQUAL(strlen(fault.file), MU_FAULT_FILE_MAX);
    CU_ASSERT_EQUAL(strlen(fault.text), MU_FAULT_TEXT_MAX);
    mu_fault_at(&fault, NULL, 1, 1, "x");
    CU_ASSERT_STRING_EQUAL(fault.file, "");
}

static void test_log_line_and_level(void)
{
    mu_log_open("tester", MU_LOG_INFO);
    capture_begin();
    mu_log(MU_LOG_DEBUG, "not-said", "x=%d", 1);
    mu_log(MU_LOG_INFO, "agent-joined", "name=%s n=%d", "red", 3);
    mu_log(MU_LOG_ERROR, "broken", "why=%s", "that");
    capture_end();
    CU_ASSERT_FALSE(said("not-said"));
    CU_ASSERT(said(" info tester agent-joined name=red n=3\n"));
    CU_ASSERT(said(" error tester broken why=that\n"));
    double seconds = strtod(captured, NULL);
    double now_s = (double)mu_clock_wall_ns() * 1e-9;
    CU_ASSERT(seconds > now_s - 60.0 && seconds < now_s + 1.0);
}

static void test_limit_log_line_is_cut_and_ended(void)
{
    static char long_text[4000];
    memset(long_text, 'l', sizeof long_text - 1);
    mu_log_open(long_text, MU_LOG_WARNING);
    capture_begin();
    mu_log(MU_LOG_WARNING, "event", "%s", long_text);
    mu_log_open("tester", MU_LOG_WARNING);
    mu_log(MU_LOG_WARNING, "event", "%s", long_text);
    capture_end();
    mu_log_open("muster", MU_LOG_WARNING);
    const char *end = strchr(captured, '\n');
    CU_ASSERT_PTR_NOT_NULL_FATAL(end);
    CU_ASSERT_EQUAL(end - captured, 1198);
    CU_ASSERT_EQUAL(captured[strlen(captured) - 1], '\n');
}

static void test_clocks(void)
{
    uint64_t before_ns = mu_clock_ns();
    CU_ASSERT(mu_clock_ns() >= before_ns);
    CU_ASSERT(mu_clock_wall_ns() > 1700000000ull * 1000000000u); /* some time after 2023 */
}

static void test_memory_is_zeroed_and_apart(void)
{
    unsigned char *a = mu_startup_array(10, 3);
    unsigned char *b = mu_startup_alloc(0);
    unsigned char *c = mu_startup_array(0, 7);
    CU_ASSERT(a && b && c && a != b && b != c);
    for (int i = 0; i < 30; i++) {
        CU_ASSERT_EQUAL(a[i], 0);
    }
    char *copy = mu_startup_string("red");
    CU_ASSERT_STRING_EQUAL(copy, "red");
    CU_ASSERT_STRING_EQUAL(mu_startup_string(""), "");
    CU_ASSERT_FALSE(mu_memory_sealed());
}

static void alloc_after_seal(void)
{
    mu_memory_seal();
    if (mu_memory_sealed()) {
        (void)mu_startup_alloc(1);
    }
}

static void alloc_too_much(void)
{
    (void)mu_startup_array(SIZE_MAX / 2, 3);
}

static void sums_wrong(void)
{
    MU_ASSERT(1 + 1 == 3);
}

/* @return whether this ends a process by SIGABRT */
static bool aborts(void (*act)(void))
{
    capture_begin();
    pid_t pid = fork();
    if (pid == 0) {
        act();
        _exit(0);
    }
    int status = 0;
    bool waited = waitpid(pid, &status, 0) == pid;
    capture_end();
    return waited && WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

static void test_bugs_abort(void)
{
    CU_ASSERT(aborts(alloc_after_seal));
    CU_ASSERT(said("assertion failed: !memory_sealed in mu_startup_array ("));
    CU_ASSERT(aborts(alloc_too_much));
    CU_ASSERT(aborts(sums_wrong));
    CU_ASSERT(said("assertion failed: 1 + 1 == 3 in sums_wrong ("));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"every result has its exit code", test_every_result_has_its_exit_code},
        {"every result has its word", test_every_result_has_its_word},
        {"faults are passed up, outcomes are not", test_faults_are_passed_up_and_outcomes_are_not},
        {"a fault says where", test_fault_says_where},
        {"limit: a fault's text", test_limit_fault_is_cut},
        {"log: line and level", test_log_line_and_level},
        {"limit: a log line", test_limit_log_line_is_cut_and_ended},
        {"clocks", test_clocks},
        {"memory", test_memory_is_zeroed_and_apart},
        {"bugs abort", test_bugs_abort},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/exits", tests);
}
