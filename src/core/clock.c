/* SPDX-License-Identifier: Apache-2.0 */
#include "core/clock.h"

uint64_t mu_clock_read(clockid_t clock)
{
    struct timespec t = {0};
    clock_gettime(clock, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

uint64_t mu_clock_ns(void)
{
    return mu_clock_read(CLOCK_MONOTONIC);
}

uint64_t mu_clock_wall_ns(void)
{
    return mu_clock_read(CLOCK_REALTIME);
}
