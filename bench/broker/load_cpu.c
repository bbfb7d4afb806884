/* SPDX-License-Identifier: Apache-2.0 */
/* Processor time while a load runs: of the broker and of all processes that take part.  LOAD_WATCH
 * has their ids, the broker's first; this process is always one of them. */
#include "load.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { WATCHED_MAX = 512 };

static struct {
    pid_t pids[WATCHED_MAX];
    uint32_t count;
    double broker_us, all_us; /* when it began */
} watched;

static double process_us(pid_t pid)
{
    clockid_t clock;
    struct timespec t;
    if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &t) != 0) {
        load_die("no processor time of %d", (int)pid);
    }
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static double all_us(void)
{
    double sum = process_us(getpid());
    for (uint32_t i = 0; i < watched.count; i++) {
        sum += process_us(watched.pids[i]);
    }
    return sum;
}

void load_cpu_watch(pid_t pid)
{
    if (watched.count == WATCHED_MAX) {
        load_die("more than %d processes", WATCHED_MAX);
    }
    watched.pids[watched.count++] = pid;
}

void load_cpu_begin(void)
{
    const char *at = getenv("LOAD_WATCH");
    uint32_t others = watched.count;
    char *end = NULL;
    for (; at && *at; at = end) {
        long pid = strtol(at, &end, 10);
        if (end == at) {
            load_die("LOAD_WATCH: %s", at);
        }
        load_cpu_watch((pid_t)pid);
    }
    if (watched.count > others) { /* the broker to the front */
        pid_t broker = watched.pids[others];
        watched.pids[others] = watched.pids[0];
        watched.pids[0] = broker;
        watched.broker_us = process_us(broker);
    }
    watched.all_us = all_us();
}

void load_cpu_print(uint64_t units)
{
    if (getenv("LOAD_WATCH")) {
        printf("\"cpu_us\": %.3f, \"all_cpu_us\": %.3f, ",
               (process_us(watched.pids[0]) - watched.broker_us) / (double)units,
               (all_us() - watched.all_us) / (double)units);
    }
}
