/* SPDX-License-Identifier: Apache-2.0 */
/* Robots drive in worlds that were not made for this test: muster's own, and Stage's. */
#include "garble.h"
#include "sim/engine/engine.h"
#include "suite.h"
#include "world/world_load.h"

#include <CUnit/Basic.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
    r = r == MU_OK ? world_check_places(&world, NULL, &fault) : r;
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

/* Drives at full speed for a few steps.  @return whether all is finite */
static bool survives(void)
{
    struct engine_options options = {.seed = 1, .step_ns = MU_STEP_NS};
    struct engine *e = engine_open(&world, &options);
    double sum = 0;
    for (int step = 0; step < 3; step++) {
        for (size_t i = 0; i < world.robot_count; i++) {
            double forward_m_s = 1e9;
            double turn_rad_s = 1e9;
            sum += engine_command(e, i, &forward_m_s, &turn_rad_s) == MU_OK ? 0 : (double)NAN;
        }
        engine_step(e);
    }
    for (size_t i = 0; i < world.robot_count; i++) {
        double state[ENGINE_STATE_DOUBLES];
        engine_state(e, i, state);
        sum += state[0] + state[1];
    }
    engine_close(e);
    return isfinite(sum);
}

/* What a world file may say, the physics must bear. */
static void test_unusual_numbers(void)
{
    enum { SEED = 43, ROUNDS = 400 };
    static const char *const files[] = {"tests/corpus/world/things.world",
                                        "tests/corpus/world/devices.world"};
    char path[] = "/tmp/muster-world-XXXXXX";
    int fd = mkstemp(path);
    CU_ASSERT_FATAL(fd >= 0);
    close(fd);
    struct mu_random random;
    mu_random_seed(&random, SEED, "unusual numbers");
    unsigned ran = 0;
    printf("seed %d ", SEED);
    for (int round = 0; round < ROUNDS; round++) {
        char sample[4096];
        char text[sizeof sample + 16];
        FILE *file = fopen(files[round % 2], "r");
        CU_ASSERT_PTR_NOT_NULL_FATAL(file);
        size_t len = fread(sample, 1, sizeof sample, file);
        fclose(file);
        len = garble_number(&random, text, sample, len);
        file = fopen(path, "w");
        CU_ASSERT_PTR_NOT_NULL_FATAL(file);
        CU_ASSERT_EQUAL(fwrite(text, 1, len, file), len);
        fclose(file);
        struct mu_fault fault;
        const struct world_options options = {.quiet = true, .seed = 1};
        if (world_read(&world, path, &options, &fault) == MU_OK &&
            world_check_places(&world, NULL, &fault) == MU_OK) {
            ran++;
            CU_ASSERT_TRUE(survives());
        }
    }
    unlink(path);
    CU_ASSERT(ran > ROUNDS / 4);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"robots drive in muster's own worlds", test_own_worlds},
        {"robots drive in Stage's worlds", test_worlds_of_stage},
        {"unusual numbers", test_unusual_numbers},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/worlds", tests);
}
