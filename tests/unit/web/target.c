/* SPDX-License-Identifier: Apache-2.0 */
/* What paths ask for. */
#include "suite.h"
#include "web/web.h"

#include <CUnit/Basic.h>

static const struct {
    const char *path;
    enum route route;
    enum guard_use use;
    const char *name;
    int64_t step;
} cases[] = {
    {"/", ROUTE_ASSET, GUARD_LOOK, "", 0},
    {"/main.js", ROUTE_ASSET, GUARD_LOOK, "", 0},
    {"/events", ROUTE_EVENTS, GUARD_LOOK, "", 0},
    {"/scene", ROUTE_SCENE, GUARD_LOOK, "", 0},
    {"/moments/12", ROUTE_MOMENTS, GUARD_LOOK, "", 12},
    {"/moments/12/red", ROUTE_MOMENTS, GUARD_LOOK, "red", 12},
    {"/why/0/", ROUTE_WHY, GUARD_LOOK, "", 0},
    {"/lines/red", ROUTE_LINES, GUARD_ACT, "red", 0},
    {"/lines/", ROUTE_LINES, GUARD_ACT, "", 0},
    {"/lines/../main.js", ROUTE_LINES, GUARD_ACT, "../main.js", 0},
    {"/words/observer", ROUTE_WORDS, GUARD_ACT, "observer", 0},
    {"/world", ROUTE_WORLD, GUARD_ACT, "", 0},
    {"/worlds", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"/events/", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"/moments/", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"/moments/-1", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"/moments/1x", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"/lines", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"//", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"/../main.js", ROUTE_NONE, GUARD_NOTHING, "", 0},
    {"", ROUTE_NONE, GUARD_NOTHING, "", 0},
};

static void test_paths(void)
{
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct target t = target_find(cases[i].path);
        CU_ASSERT_EQUAL(t.route, cases[i].route);
        CU_ASSERT_EQUAL(t.use, cases[i].use);
        if (t.route != ROUTE_NONE) {
            READS(t.name, cases[i].name);
            CU_ASSERT_EQUAL(t.step, cases[i].step);
        }
    }
}

static void test_a_step_that_no_number_holds(void)
{
    CU_ASSERT(target_find("/moments/99999999999999999999").step > 0);
}

int main(void)
{
    CU_TestInfo tests[] = {{"paths", test_paths},
                           {"a step that no number holds", test_a_step_that_no_number_holds},
                           CU_TEST_INFO_NULL};
    return suite_run("web/target", tests);
}
