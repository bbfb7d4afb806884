/* SPDX-License-Identifier: Apache-2.0 */
/* Robots drive in worlds that were not made for this test: muster's own, and Stage's. */
#include "../support/suite.h"
#include "sim/engine.h"

#include <CUnit/Basic.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 100 };

static struct world world;
static bool world_is_open;

/* Opens the first world, and reads each further one in its memory. */
static mu_result next_world(const char *path)
{
    struct mu_fault fault;
    const struct world_options options = {.quiet = true, .seed = 1};
    mu_result r = world_is_open ? world_read(&world, path, &options, &fault)
                                : world_open(&world, path, &options, &fault);
    world_is_open = true;
    r = r == MU_OK ? world_check_places(&world, &fault) : r;
    if (r != MU_OK) {
        printf("%s:%d: %s ", fault.file, fault.line, fault.text);
    }
    return r;
}

/*
 * Drives all robots in a circle for 10 s, 3 m in all: Stage's floor plans stop nobody.
 *
 * @return how far the one came that came farthest
 */
static double drive_all(struct engine *e)
{
    double farthest_m = 0;
    for (int step = 0; step < STEPS; step++) {
        for (size_t i = 0; i < world.robot_count; i++) {
            double forward_m_s = 0.3;
            double turn_rad_s = 0.3;
            CU_ASSERT_EQUAL(engine_command(e, i, &forward_m_s, &turn_rad_s), MU_OK);
        }
        engine_step(e);
    }
    for (size_t i = 0; i < world.robot_count; i++) {
        double state[ENGINE_STATE_DOUBLES];
        engine_state(e, i, state);
        CU_ASSERT(isfinite(state[0]) && isfinite(state[1]));
        CU_ASSERT(state[0] > world.min_x_m - 4 && state[0] < world.max_x_m + 4);
        CU_ASSERT(state[1] > world.min_y_m - 4 && state[1] < world.max_y_m + 4);
        const struct world_pose *start = &world.robots[i].pose;
        farthest_m = fmax(farthest_m, hypot(state[0] - start->x_m, state[1] - start->y_m));
    }
    return farthest_m;
}

static void drive_in_each(const char *pattern)
{
    glob_t found = {0};
    CU_ASSERT_EQUAL_FATAL(glob(pattern, 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        CU_ASSERT_EQUAL_FATAL(next_world(found.gl_pathv[i]), MU_OK);
        CU_ASSERT_FATAL(world.robot_count >= 1);
        struct engine_options options = {.seed = 1, .step_ns = MU_STEP_NS};
        struct engine *e = engine_open(&world, &options);
        CU_ASSERT(drive_all(e) > 0.2);
        engine_close(e);
    }
    globfree(&found);
}

static void test_own_worlds(void)
{
    drive_in_each("worlds/*.world");
}

static void test_worlds_of_stage(void)
{
    const char *data = getenv("MUSTER_TEST_DATA");
    char pattern[512];
    snprintf(pattern, sizeof pattern, "%s/stage-worlds/*.world", data ? data : "");
    glob_t found = {0};
    if (!data || glob(pattern, 0, NULL, &found) != 0) {
        printf("(skipped: MUSTER_TEST_DATA holds no stage-worlds) ");
        return;
    }
    globfree(&found);
    drive_in_each(pattern);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"robots drive in muster's own worlds", test_own_worlds},
        {"robots drive in Stage's worlds", test_worlds_of_stage},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/worlds", tests);
}
