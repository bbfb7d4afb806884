/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file tally.h
 * What a robot has come to since the run began: how far it went, how often and how long it was
 * stalled.
 *
 * It is counted as the report counts it from run.csv, from the same rounded numbers, so that both
 * say the same.
 */
#ifndef MUSTER_SIM_TALLY_H
#define MUSTER_SIM_TALLY_H

#include "sim/engine/engine.h"

/* Zero before the first step. */
struct tally {
    double distance_m, stalled_s;
    uint32_t stalls; /* how often it began to be stalled */
    bool seen, stalled;
    double x_m, y_m, time_s; /* of the step before, as in run.csv */
};

/**
 * Takes in one more step.
 *
 * @param time_ns  simulated, of this step
 * @param step_ns  what a stall counts that is there in the very first step
 */
void tally_take(struct tally *t, uint64_t time_ns, uint64_t step_ns,
                const struct engine_percept *percept);

#endif
