/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file chaos.h
 * What goes wrong on purpose in a run: pushes and blocked sensors, killed and stopped processes,
 * packets that are lost or late.
 *
 * All of it goes to the simulator before the first step, with its time or its condition.  What is
 * done to the world the simulator does.  For the rest it holds the lock step at that place, says
 * so, and goes on when it was done here: so all of it happens at the same step in every run.
 */
#ifndef MUSTER_RUN_CHAOS_H
#define MUSTER_RUN_CHAOS_H

#include "run/run.h"

/**
 * Checks what needs the world: things that are named; takes memory, and makes the table of traffic
 * if any is struck.
 *
 * @return MU_OK; MU_FAULT_FILE: no such thing; MU_FAULT_OS, explained
 */
MU_MUST_USE mu_result chaos_prepare(struct run *r, struct mu_fault *fault);

/**
 * Checks, in chaos_check.c, that all of it can be done as the run goes: in lock step, or free.
 *
 * @return MU_OK, or MU_FAULT_FILE with the place and the reason
 */
MU_MUST_USE mu_result chaos_check(const struct run *r, struct mu_fault *fault);

/** @return whether a process may be started again by it */
bool chaos_restarts_any(const struct run *r);

/** @return whether it starts what a kill of it strikes again, then or later */
bool chaos_restarts(const struct run *r, unsigned index);

/** Opens what the simulator answers by. */
MU_MUST_USE mu_result chaos_open(struct run *r);

/** Hands everything over, before the first step.  @return MU_OK or MU_FAULT_DDS */
MU_MUST_USE mu_result chaos_send(struct run *r);

/** Looks what is due, and does it. */
void chaos_look(struct run *r);

/** Says, once the run is over, what was done: for the report.  NULL: the experiment has none */
const struct report_chaos *chaos_fates(const struct run *r);

/** @return how many packets were lost or late by it */
uint64_t chaos_packets(const struct run *r);

#endif
