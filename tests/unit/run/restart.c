/* SPDX-License-Identifier: Apache-2.0 */
/* What ends because the run is over is not started again. */
#include "core/clock.h"
#include "run/run.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>

static struct experiment experiment = {.on_crash = EXPERIMENT_RESTART, .restarts = 3};
static struct child child;
static struct run_part part;
static struct run r = {
    .experiment = &experiment, .parts = &part, .children = {.children = &child, .count = 1}};

static const struct child *look(enum run_kind kind, int status, double ago_s)
{
    part.kind = kind;
    child = (struct child){.name = "near",
                           .ended = true,
                           .ended_ns = mu_clock_ns() - (uint64_t)(ago_s * 1e9),
                           .status = status};
    return run_restart_look(&r);
}

static void test_ended_well(void)
{
    CU_ASSERT_PTR_NULL(look(RUN_RESOLVER, 0, 1.0));
    CU_ASSERT_EQUAL(child.restarts, 0);
    CU_ASSERT_PTR_NULL(look(RUN_RESOLVER, 0, 6.0));
    CU_ASSERT_EQUAL(child.restarts, 1);
}

static void test_killed(void)
{
    CU_ASSERT_PTR_NULL(look(RUN_RESOLVER, SIGKILL, 0.0));
    CU_ASSERT_EQUAL(child.restarts, 0);
    CU_ASSERT_PTR_NULL(look(RUN_RESOLVER, SIGKILL, 0.2));
    CU_ASSERT_EQUAL(child.restarts, 1);
    CU_ASSERT_EQUAL(child.restart_ns, child.ended_ns + 500000000);
}

static void test_not_started_again(void)
{
    CU_ASSERT_PTR_NULL(look(RUN_SIMULATOR, 0, 1.0));
    CU_ASSERT_PTR_EQUAL(look(RUN_SIMULATOR, 0, 6.0), &child);
    CU_ASSERT_PTR_EQUAL(look(RUN_BROKER, 0, 0.0), &child);
}

int main(void)
{
    CU_TestInfo tests[] = {{"ended well", test_ended_well},
                           {"killed", test_killed},
                           {"not started again", test_not_started_again},
                           CU_TEST_INFO_NULL};
    return suite_run("run/restart", tests);
}
