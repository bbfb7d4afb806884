/* SPDX-License-Identifier: Apache-2.0 */
#include "report/drawing/drawing.h"
#include "suite.h"

#include <CUnit/Basic.h>

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
        {"ticks", test_ticks},
        CU_TEST_INFO_NULL,
    };
    return suite_run("ticks of a report", tests);
}
