/* SPDX-License-Identifier: Apache-2.0 */
#include "run/run.h"
#include "suite.h"

#include <CUnit/Basic.h>

static uint64_t seeds[SERIES_RUNS_MAX];

static void test_ranges_and_lists(void)
{
    CU_ASSERT_EQUAL(series_seeds("4", seeds), 1);
    CU_ASSERT_EQUAL(seeds[0], 4);
    CU_ASSERT_EQUAL(series_seeds("1..30", seeds), 30);
    CU_ASSERT(seeds[0] == 1 && seeds[29] == 30);
    CU_ASSERT_EQUAL(series_seeds("9,0..2,7", seeds), 5);
    CU_ASSERT(seeds[0] == 9 && seeds[1] == 0 && seeds[3] == 2 && seeds[4] == 7);
    CU_ASSERT_EQUAL(series_seeds("5..5", seeds), 1);
    CU_ASSERT_EQUAL(series_seeds("999999999999990..1000000000000000", seeds), 11);
}

static void test_what_is_no_list(void)
{
    static const char *const wrong[] = {"",
                                        ",",
                                        "1,",
                                        "1..",
                                        "..3",
                                        "3..1",
                                        "1...3",
                                        "1-3",
                                        " 1",
                                        "1 ",
                                        "-1",
                                        "+1",
                                        "1.5",
                                        "1,1",
                                        "1..3,2",
                                        "x",
                                        "1x",
                                        "1e3",
                                        "0x1",
                                        "1000000000000001",
                                        "99999999999999999999999"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CU_ASSERT_EQUAL(series_seeds(wrong[i], seeds), 0);
    }
}

static void test_limit_runs(void)
{
    CU_ASSERT_EQUAL(series_seeds("1..1000", seeds), SERIES_RUNS_MAX);
    CU_ASSERT_EQUAL(series_seeds("1..1001", seeds), 0);
    CU_ASSERT_EQUAL(series_seeds("0..999999999999999", seeds), 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"ranges and lists", test_ranges_and_lists},
        {"what is no list", test_what_is_no_list},
        {"limit: runs", test_limit_runs},
        CU_TEST_INFO_NULL,
    };
    return suite_run("run/series", tests);
}
