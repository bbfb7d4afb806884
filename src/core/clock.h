/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clock.h
 * The clocks of the machine; pure code gets its time as an argument instead.
 */
#ifndef MUSTER_CORE_CLOCK_H
#define MUSTER_CORE_CLOCK_H

#include <stdint.h>
#include <time.h>

/** @return nanoseconds that only go up, from some moment on */
uint64_t mu_clock_ns(void);

/** @return nanoseconds since 1970 */
uint64_t mu_clock_wall_ns(void);

/** @return nanoseconds of any clock, such as of the processor time of a process; 0: there is none
 */
uint64_t mu_clock_read(clockid_t clock);

#endif
