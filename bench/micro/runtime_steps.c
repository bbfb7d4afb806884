/* SPDX-License-Identifier: Apache-2.0 */
/*
 * How long the steps of a lock step take: a process that watches notes when each begins.
 *
 *   runtime_steps DOMAIN STEPS     prints median, 99th percentile and worst, in microseconds
 *
 * Start muster-sim with --watchers 1, so that it is there from the first step on.  It joins the
 * lock step, so that what it takes is in what it measures.
 */
#include "core/clock.h"
#include "muster/muster.h"

#include <stdio.h>
#include <stdlib.h>

enum { STEPS_MAX = 100000, WARM_UP = 50 };

static uint64_t intervals_ns[STEPS_MAX], last_ns;
static size_t wanted, seen, count;
static mu_process *process;

static void on_world(void *self, mu_agent *a, const struct mu_percept *bodies, size_t bodies_count)
{
    (void)self;
    (void)a;
    (void)bodies;
    (void)bodies_count;
    uint64_t now_ns = mu_clock_ns();
    if (++seen > WARM_UP && count < wanted) {
        intervals_ns[count++] = now_ns - last_ns;
    }
    if (count == wanted) {
        mu_process_stop(process);
    }
    last_ns = now_ns;
}

static int compare(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: runtime_steps DOMAIN STEPS\n");
        return EXIT_FAILURE;
    }
    wanted = (size_t)strtoul(argv[2], NULL, 10);
    wanted = wanted < STEPS_MAX ? wanted : STEPS_MAX;
    struct mu_process_options options = {
        .domain = (int)strtol(argv[1], NULL, 10), .name = "stopwatch", .watches = true};
    struct mu_handlers handlers = {.on_world = on_world};
    mu_agent *agent;
    if (mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &agent, "stopwatch", MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_agent_decline_broadcasts(agent);
    mu_result ran = mu_process_run(process);
    mu_process_close(process);
    if (ran != MU_OK || count < wanted) {
        fprintf(stderr, "runtime_steps: %zu of %zu steps\n", count, wanted);
        return EXIT_FAILURE;
    }
    qsort(intervals_ns, count, sizeof intervals_ns[0], compare);
    printf("%.1f %.1f %.1f\n", (double)intervals_ns[count / 2] / 1e3,
           (double)intervals_ns[count * 99 / 100] / 1e3, (double)intervals_ns[count - 1] / 1e3);
    return EXIT_SUCCESS;
}
