/* SPDX-License-Identifier: Apache-2.0 */
#include "suite.h"
#include "report/color.h"
#include "report/svg.h"

#include <CUnit/Basic.h>

static void test_colors(void)
{
    CU_ASSERT_STRING_EQUAL(color_of_track("yellow", "r", 0), "#d4a900");
    CU_ASSERT_STRING_EQUAL(color_of_track(NULL, "green", 0), "#2ca02c");
    CU_ASSERT_STRING_EQUAL(color_of_track("DarkOliveGreen", "r", 0), "DarkOliveGreen");
    CU_ASSERT_STRING_EQUAL(color_of_track("#0a4", "r", 0), "#0a4");
    CU_ASSERT_STRING_EQUAL(color_of_track("DarkOliveGreen2", "blue", 0), "#1f77b4");
    CU_ASSERT_STRING_NOT_EQUAL(color_of_track("", "r1", 1), color_of_track(NULL, "r2", 2));
    CU_ASSERT_FALSE(color_is_css("#12345"));
    CU_ASSERT_FALSE(color_is_css("url(x)"));
    CU_ASSERT(color_is_css("aliceblue") && color_is_css("yellowgreen") && color_is_css("#ABCDEF"));
}

static void test_ticks(void)
{
    char label[SVG_TICK_MAX];
    CU_ASSERT_DOUBLE_EQUAL(svg_tick_step(16, 8), 2, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(svg_tick_step(120, 10), 10, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(svg_tick_step(0.4, 8), 0.05, 1e-12);
    svg_tick_label(label, -0.0);
    CU_ASSERT_STRING_EQUAL(label, "0");
    svg_tick_label(label, -2.5);
    CU_ASSERT_STRING_EQUAL(label, "\xe2\x88\x92"
                                  "2.5");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"colours", test_colors},
        {"ticks", test_ticks},
        CU_TEST_INFO_NULL,
    };
    return suite_run("colours and ticks of a report", tests);
}
