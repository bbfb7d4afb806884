/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file interventions.h
 * Who had a hand in a recorded robot: pushes, placements, resets, sensors switched on and off.
 *
 * Pure: orders are added in the order of steps, then anything can be asked of any step.  The last
 * INTERVENTIONS_MAX are kept.
 */
#ifndef MUSTER_STORY_INTERVENTIONS_H
#define MUSTER_STORY_INTERVENTIONS_H

#include "core/text.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { INTERVENTIONS_MAX = 4096 };

struct intervention {
    uint32_t step; /* it was carried out at the end of this one */
    muster_RunOrder order;
    char robot[MU_NAME_MAX + 1]; /* "": every one */
    char source[MU_NAME_MAX + 1];
    double x_m, y_m, force_x_n, force_y_n, torque_nm, time_s; /* as in RunCommand */
    uint32_t senses;
    bool on;
};

struct interventions {
    size_t count; /* so far; the ring holds the last INTERVENTIONS_MAX */
    struct intervention at[INTERVENTIONS_MAX];
};

/** Adds what an order of a step did to a body; other orders are passed over. */
void interventions_add(struct interventions *h, uint32_t step, const muster_RunCommand *order);

/* Which are asked for. */
struct interventions_asked {
    const char *robot;
    uint32_t since, step; /* what was done to it from the end of one on, and before another */
    bool sensed;          /* also what of its sensors is off then */
    double step_s;        /* simulated time of a step */
};

/**
 * Adds a line for each: placements, and pushes that were under way or ended at most a second
 * before.
 *
 * @param before  what each line begins with
 * @return how many lines
 */
size_t interventions_tell(const struct interventions *h, const struct interventions_asked *on,
                          const char *before, struct mu_text *out);

#endif
