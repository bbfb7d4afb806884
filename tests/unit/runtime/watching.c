/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A watch and a run that comes, goes on and ends, on loopback: the simulator's writers belong to
 * the watch's own process.
 */
#include "core/clock.h"
#include "muster/monitor.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;
static const int64_t WAIT_NS = 5000000;

static mu_process *process;
static mu_watch *watch;
static struct bus_writer scenes, frames, statuses;
static struct {
    unsigned scenes, frames, ends;
    int64_t step;
    uint64_t missed;
    enum mu_run_end end;
    char hash[MU_FIELD_MAX + 2];
} seen;
static bool stops; /* at the next Frame */

static void on_scene(void *self, const struct mu_scene *scene)
{
    CU_ASSERT_PTR_EQUAL(self, &seen);
    CU_ASSERT_STRING_EQUAL(scene->world, "arena.world");
    seen.scenes++;
}

static void on_step(void *self, const struct mu_frame *frame)
{
    (void)self;
    seen.frames++;
    seen.step = frame->step;
    seen.missed = frame->missed;
    CU_ASSERT_EQUAL(mu_watch_spin(watch, 0), MU_BUSY);
    if (stops) {
        mu_watch_stop(watch);
    }
}

static void on_end(void *self, const struct mu_run_result *result)
{
    (void)self;
    seen.ends++;
    seen.end = result->end;
    mu_text_copy(seen.hash, sizeof seen.hash, result->hash);
}

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    struct mu_process_options options = {.domain = 100 + (int)(getpid() % 100)};
    struct mu_watch_options wanted = {
        .handlers = {.self = &seen, .on_scene = on_scene, .on_step = on_step, .on_end = on_end}};
    return mu_process_open(&process, &options) != MU_OK ||
           mu_watch_open(&watch, process, &wanted) != MU_OK ||
           bus_writer_open(&process->bus, BUS_SCENE, NULL, NULL, &scenes) != MU_OK ||
           bus_writer_open(&process->bus, BUS_FRAME, "every", "latest", &frames) != MU_OK ||
           bus_writer_open(&process->bus, BUS_RUN_STATUS, NULL, NULL, &statuses) != MU_OK;
}

static int end(void)
{
    mu_process_close(process);
    return 0;
}

static void scene_say(void)
{
    muster_Scene s = {.simulator = words("sim"), .world = words("arena.world"), .step_ns = 100};
    CU_ASSERT_EQUAL(bus_write(&scenes, &s), MU_OK);
}

static void frame_say(int64_t step)
{
    muster_Frame f = {.simulator = words("sim"), .step = step};
    CU_ASSERT_EQUAL(bus_write(&frames, &f), MU_OK);
}

static void status_say(muster_RunState state, int64_t step)
{
    muster_RunStatus s = {.simulator = words("sim"),
                          .state = state,
                          .step = step,
                          .hash = words("abc"),
                          .waits_for = words("")};
    CU_ASSERT_EQUAL(bus_write(&statuses, &s), MU_OK);
}

/* Spins until a count has come, or for too long.  @return what the last spin said */
static mu_result spin_until(const unsigned *count, unsigned wanted)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    mu_result spun = MU_OK;
    while (*count < wanted && spun >= 0 && mu_clock_ns() < until_ns) {
        spun = mu_watch_spin(watch, WAIT_NS);
    }
    CU_ASSERT_EQUAL(*count, wanted);
    return spun;
}

static void test_a_run_comes_and_goes_on(void)
{
    scene_say();
    status_say(muster_RUN_RUNNING, 0);
    frame_say(0);
    frame_say(1);
    CU_ASSERT_EQUAL(spin_until(&seen.frames, 2), MU_OK);
    CU_ASSERT_EQUAL(seen.scenes, 1);
    CU_ASSERT_EQUAL(seen.step, 1);
    frame_say(5);
    frame_say(4); /* late: what it shows is known to be over */
    CU_ASSERT_EQUAL(spin_until(&seen.frames, 3), MU_OK);
    CU_ASSERT_EQUAL(seen.missed, 3);
    CU_ASSERT_EQUAL(mu_watch_missed(watch), 3);
    CU_ASSERT_EQUAL(mu_watch_refused(watch), 0);
    muster_Frame nobodys = {.simulator = words(""), .step = 6};
    CU_ASSERT_EQUAL(bus_write(&frames, &nobodys), MU_OK);
    frame_say(6);
    CU_ASSERT_EQUAL(spin_until(&seen.frames, 4), MU_OK);
    CU_ASSERT_EQUAL(mu_watch_refused(watch), 1);
}

static void test_a_poll_loop_is_woken(void)
{
    struct pollfd wake = {.fd = mu_watch_wake_fd(watch), .events = POLLIN};
    CU_ASSERT_TRUE_FATAL(wake.fd >= 0);
    CU_ASSERT_EQUAL(mu_watch_wake_fd(watch), wake.fd);
    for (int i = 0; i < 100 && poll(&wake, 1, 0) > 0; i++) { /* what came before */
        CU_ASSERT_EQUAL(mu_watch_spin(watch, 0), MU_OK);
    }
    frame_say(7);
    CU_ASSERT_EQUAL(poll(&wake, 1, (int)(PATIENCE_NS / 1000000)), 1);
    CU_ASSERT_EQUAL(spin_until(&seen.frames, 5), MU_OK);
}

static void test_a_handler_ends_it(void)
{
    stops = true;
    frame_say(8);
    CU_ASSERT_EQUAL(mu_watch_run(watch), MU_OK);
    CU_ASSERT_EQUAL(seen.step, 8);
    stops = false;
}

/* The last Frame may come behind the word that the run is over. */
static void test_the_end(void)
{
    status_say(muster_RUN_DONE, 9);
    frame_say(9);
    CU_ASSERT_EQUAL(spin_until(&seen.ends, 1), MU_DONE);
    CU_ASSERT_EQUAL(seen.step, 9);
    CU_ASSERT_EQUAL(seen.end, MU_RUN_DONE);
    CU_ASSERT_STRING_EQUAL(seen.hash, "abc");
    CU_ASSERT_EQUAL(mu_watch_missed(watch), 0); /* of the next run */
}

/* Another run, whose simulator goes without a word. */
static void test_a_simulator_that_is_lost(void)
{
    scene_say();
    frame_say(0);
    CU_ASSERT_EQUAL(spin_until(&seen.scenes, 2), MU_OK);
    bus_writer_close(&frames);
    bus_writer_close(&scenes);
    CU_ASSERT_EQUAL(spin_until(&seen.ends, 2), MU_DONE);
    CU_ASSERT_EQUAL(seen.end, MU_RUN_LOST);
    CU_ASSERT_STRING_EQUAL(seen.hash, "none");
    CU_ASSERT_EQUAL(seen.step, 0); /* what lay there was looked at first */
}

/* @return whether the process's descriptor says that there is something to do */
static bool is_woken(void)
{
    struct pollfd wake = {.fd = mu_process_wake_fd(process), .events = POLLIN};
    return poll(&wake, 1, 0) == 1;
}

/* What the watch would have looked at is no reason to wake its process for ever. */
static void test_a_closed_watch_leaves_its_process_alone(void)
{
    struct bus *bus = &process->bus;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_FRAME, "every", "latest", &frames), MU_OK);
    uint64_t before = bus->arrived;
    frame_say(0);
    frame_say(1);
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (bus->arrived == before && mu_clock_ns() < until_ns) {
        bus_wait(bus, 2, WAIT_NS);
    }
    mu_watch_close(watch);
    frame_say(2);
    CU_ASSERT_EQUAL(bus->arrived, bus->taken);
    CU_ASSERT_EQUAL(mu_process_spin(process, WAIT_NS), MU_OK);
    CU_ASSERT_FALSE(is_woken());
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a run comes and goes on", test_a_run_comes_and_goes_on},
        {"a poll loop is woken", test_a_poll_loop_is_woken},
        {"a handler ends it", test_a_handler_ends_it},
        {"the end", test_the_end},
        {"a simulator that is lost", test_a_simulator_that_is_lost},
        {"a closed watch leaves its process alone", test_a_closed_watch_leaves_its_process_alone},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/watching", begin, end, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
