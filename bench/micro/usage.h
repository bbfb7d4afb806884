/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file usage.h
 * What a benchmark has used: processor time, memory.
 */
#ifndef MUSTER_BENCH_USAGE_H
#define MUSTER_BENCH_USAGE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

/* Of this process alone: the machine may have other work. */
static inline uint64_t processor_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static inline double resident_kib(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    bool read = file && fscanf(file, "%*d %ld", &pages) == 1;
    if (file) {
        fclose(file);
    }
    return read ? (double)pages * (double)sysconf(_SC_PAGESIZE) / 1024 : 0.0;
}

#endif
