/* SPDX-License-Identifier: Apache-2.0 */
/* How a watch meets a simulator and misses it: its writers become known one after the other. */
#include "bus/bus.h"
#include "rich.h"
#include "runtime/process.h"
#include "runtime/watch.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <unistd.h>

static unsigned scenes_seen, ends_seen;
static enum mu_run_end last_end;

static void on_scene(void *self, const struct mu_scene *scene)
{
    (void)self;
    (void)scene;
    scenes_seen++;
}

static void on_end(void *self, const struct mu_run_result *result)
{
    (void)self;
    ends_seen++;
    last_end = result->end;
}

/* Spins until something has been seen so often, or a hundred times. */
static void spin(mu_watch *w, const unsigned *seen, unsigned wanted)
{
    for (int i = 0; i < 100 && *seen < wanted; i++) {
        CU_ASSERT(mu_watch_spin(w, 10000000) >= 0);
    }
}

/* On a busy machine the Scene comes long before the writer of the Frames. */
static void test_a_scene_alone_is_no_end(void)
{
    struct mu_process_options process = {.domain = 100 + (int)(getpid() % 100), .name = "watcher"};
    struct mu_watch_options options = {.handlers = {.on_scene = on_scene, .on_end = on_end}};
    struct bus_writer scenes, frames;
    muster_Scene scene = rich_scene();
    mu_process *p;
    mu_watch *w;
    CU_ASSERT_EQUAL_FATAL(mu_process_open(&p, &process), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mu_watch_open(&w, p, &options), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&p->bus, BUS_SCENE, NULL, NULL, &scenes), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_write(&scenes, &scene), MU_OK);
    spin(w, &scenes_seen, 1);
    CU_ASSERT_EQUAL(scenes_seen, 1);
    spin(w, &ends_seen, 1);
    CU_ASSERT_EQUAL(ends_seen, 0);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&p->bus, BUS_FRAME, "every", NULL, &frames), MU_OK);
    CU_ASSERT_EQUAL(mu_watch_spin(w, 10000000), MU_OK);
    bus_writer_close(&frames);
    bus_writer_close(&scenes);
    spin(w, &ends_seen, 1);
    CU_ASSERT_EQUAL(ends_seen, 1);
    CU_ASSERT_EQUAL(last_end, MU_RUN_LOST);
    mu_watch_close(w);
    mu_process_close(p);
}

int main(void)
{
    unsetenv("CYCLONEDDS_URI");
    CU_TestInfo tests[] = {
        {"a scene alone is no end", test_a_scene_alone_is_no_end},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/watch", NULL, NULL, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
