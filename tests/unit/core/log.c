/* SPDX-License-Identifier: Apache-2.0 */
#include "core/log.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>
#include <unistd.h>

/* What one line of the log is, behind its time. */
static void log_catch(char *out, size_t size, const char *details)
{
    int ends[2], before = dup(STDERR_FILENO);
    CU_ASSERT_EQUAL_FATAL(pipe(ends), 0);
    dup2(ends[1], STDERR_FILENO);
    mu_log_open("red", MU_LOG_WARNING);
    mu_log(MU_LOG_WARNING, "line-refused", "%s", details);
    dup2(before, STDERR_FILENO);
    char line[2048];
    ssize_t len = read(ends[0], line, sizeof line - 1);
    close(before);
    close(ends[0]);
    close(ends[1]);
    line[len > 0 ? len : 0] = '\0';
    const char *space = strchr(line, ' ');
    CU_ASSERT_PTR_NOT_NULL_FATAL(space);
    CU_ASSERT_TRUE(strlen(space) < size);
    strncpy(out, space + 1, size - 1);
    out[size - 1] = '\0';
}

static void test_log_of_strange_words_is_one_plain_line(void)
{
    char line[2048];
    log_catch(line, sizeof line, "answer=no\n");
    CU_ASSERT_STRING_EQUAL(line, "warning red line-refused answer=no\n");
    log_catch(line, sizeof line, "a\nb\x1b[31m caf\xc3\xa9\n\r\n");
    CU_ASSERT_STRING_EQUAL(line, "warning red line-refused a b?[31m caf\xc3\xa9\n");
    log_catch(line, sizeof line, "\n");
    CU_ASSERT_STRING_EQUAL(line, "warning red line-refused \n");
}

static void test_limit_log_line_is_cut(void)
{
    char line[2048], details[1500];
    memset(details, 'x', sizeof details - 1);
    details[sizeof details - 1] = '\0';
    log_catch(line, sizeof line, details);
    CU_ASSERT_TRUE(strlen(line) < 1200);
    CU_ASSERT_EQUAL(line[strlen(line) - 1], '\n');
}

int main(void)
{
    static CU_TestInfo tests[] = {
        {"strange words are one plain line", test_log_of_strange_words_is_one_plain_line},
        {"a long line is cut", test_limit_log_line_is_cut},
        CU_TEST_INFO_NULL};
    return suite_run("core/log", tests);
}
