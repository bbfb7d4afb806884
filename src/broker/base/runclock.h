/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file runclock.h
 * The two times that mail knows.
 *
 * The run's time counts from the start of a run; mail is due by it.  The mail clock never goes
 * back, whatever runs start and end; mail expires by it.  In lock step both move with the steps,
 * else with the broker's clock.
 */
#ifndef MUSTER_BROKER_RUNCLOCK_H
#define MUSTER_BROKER_RUNCLOCK_H

#include <stdbool.h>
#include <stdint.h>

struct runclock {
    uint64_t now_ns; /* the broker's clock, as last told */
    bool lockstep;
    bool runs;             /* a run has started */
    uint64_t run_ns;       /* the run's time at base_ns; in lock step: now */
    uint64_t base_ns;      /* of the broker's clock */
    uint64_t mail_lead_ns; /* the mail clock is so far ahead of the other one, modulo 2^64 */
};

/** Takes note of the broker's clock; an earlier time than the last one counts as the last one. */
void runclock_set_now(struct runclock *c, uint64_t now_ns);

/** A run is at this time now, and goes on in lock step or with the broker's clock. */
void runclock_start(struct runclock *c, bool lockstep, uint64_t run_ns);

/** In lock step: a step ends at this time. */
void runclock_step(struct runclock *c, uint64_t run_ns);

/** @return the run's time; 0 when none has started */
uint64_t runclock_run_ns(const struct runclock *c);

/** @return the mail clock's time */
uint64_t runclock_mail_ns(const struct runclock *c);

/** Out of lock step: when the broker's clock shows this time of the mail clock or of the run. */
uint64_t runclock_now_of_mail_ns(const struct runclock *c, uint64_t mail_ns);
uint64_t runclock_now_of_run_ns(const struct runclock *c, uint64_t run_ns);

#endif
