/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"
#include "broker_story.h"
#include "core/random.h"

enum { LINES = 40 };

static struct changelog changes; /* static: leak checkers see its memory */

/* @return the lines that changed after a version, as text */
static const char *after(uint64_t version)
{
    static char buffer[512];
    struct mu_text t;
    mu_text_init(&t, buffer, sizeof buffer);
    for (uint32_t i = changelog_after(&changes, version); i != MU_NONE;
         i = changelog_next(&changes, i)) {
        mu_text_format(&t, " %u", i);
    }
    return buffer;
}

static void test_in_order_of_change(void)
{
    changelog_init(&changes, LINES);
    CU_ASSERT_STRING_EQUAL(after(0), "");
    for (uint32_t i = 0; i < 4; i++) {
        changelog_touch(&changes, i);
    }
    CU_ASSERT_STRING_EQUAL(after(0), " 0 1 2 3");
    CU_ASSERT_STRING_EQUAL(after(2), " 2 3");
    CU_ASSERT_STRING_EQUAL(after(4), "");
    changelog_touch(&changes, 0); /* the first */
    changelog_touch(&changes, 2); /* in the middle */
    changelog_touch(&changes, 2); /* the last */
    CU_ASSERT_STRING_EQUAL(after(0), " 1 3 0 2");
    CU_ASSERT_STRING_EQUAL(after(4), " 0 2");
    CU_ASSERT_STRING_EQUAL(after(5), " 2");
    CU_ASSERT_EQUAL(changelog_version(&changes, 2), 7);
    CU_ASSERT_EQUAL(changelog_version(&changes, 9), 0);
    CU_ASSERT_EQUAL(changes.version, 7);
}

static void test_one_line(void)
{
    changelog_init(&changes, 1);
    changelog_touch(&changes, 0);
    changelog_touch(&changes, 0);
    CU_ASSERT_STRING_EQUAL(after(0), " 0");
    CU_ASSERT_STRING_EQUAL(after(1), " 0");
    CU_ASSERT_STRING_EQUAL(after(2), "");
}

/* Whoever asks at any time is told each line that is newer than what it has, once, in order. */
static void test_against_versions(void)
{
    struct mu_random r;
    uint64_t versions[LINES] = {0};
    changelog_init(&changes, LINES);
    mu_random_seed(&r, 3, "changes");
    for (uint64_t version = 1; version <= 2000; version++) {
        uint32_t line = (uint32_t)mu_random_between(&r, 0, LINES - 1);
        changelog_touch(&changes, line);
        versions[line] = version;
        uint64_t had = (uint64_t)mu_random_between(&r, 0, (int64_t)version);
        uint32_t newer = 0, told = 0;
        for (uint32_t i = 0; i < LINES; i++) {
            newer += versions[i] > had;
        }
        uint64_t last = had;
        for (uint32_t i = changelog_after(&changes, had); i != MU_NONE;
             i = changelog_next(&changes, i)) {
            CU_ASSERT_FATAL(versions[i] > last);
            CU_ASSERT_EQUAL_FATAL(changelog_version(&changes, i), versions[i]);
            last = versions[i];
            told++;
        }
        CU_ASSERT_EQUAL_FATAL(told, newer);
    }
}

static void test_lines_that_are_no_more(void)
{
    changelog_init(&changes, LINES);
    CU_ASSERT_EQUAL(changelog_gone(&changes), MU_NONE);
    for (uint32_t i = 0; i < 4; i++) {
        changelog_touch(&changes, i);
    }
    changelog_remove(&changes, 1);
    changelog_remove(&changes, 3);
    CU_ASSERT_STRING_EQUAL(after(0), " 0 2");
    changelog_touch(&changes, 3); /* is used for something else at once, and goes, too */
    changelog_remove(&changes, 3);
    CU_ASSERT_EQUAL(changelog_gone(&changes), 3);
    CU_ASSERT_EQUAL(changelog_gone(&changes), 1);
    CU_ASSERT_EQUAL(changelog_gone(&changes), MU_NONE);
    changelog_touch(&changes, 1);
    changelog_remove(&changes, 1);
    CU_ASSERT_EQUAL(changelog_gone(&changes), 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"in order of change", test_in_order_of_change},
        {"one line", test_one_line},
        {"against versions", test_against_versions},
        {"lines that are no more", test_lines_that_are_no_more},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/changes", tests);
}
