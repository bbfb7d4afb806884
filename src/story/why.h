/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file why.h
 * Why a robot did what it did: from a speed, a mail or a fact back to what was sensed, said or
 * commanded.  Pure.
 */
#ifndef MUSTER_STORY_WHY_H
#define MUSTER_STORY_WHY_H

#include "core/text.h"
#include "story/interventions.h"
#include "story/minds.h"

/* Where a chain ends. */
enum why_end {
    WHY_SENSED = 1,       /* a percept */
    WHY_MAIL = 2,         /* a mail of somebody without a diary */
    WHY_LINE = 4,         /* somebody's line */
    WHY_EVENT = 8,        /* something in the agent's life, such as on-run */
    WHY_RULES = 16,       /* what the rule file says at the start */
    WHY_UNKNOWN = 32,     /* the diary had no room for it */
    WHY_INTERVENTION = 64 /* a push, a placement, a sensor that was switched off */
};

struct why {
    const struct minds *minds;
    const struct interventions *interventions;
    double step_s; /* simulated time of a step */
    struct mu_text *out;
};

/**
 * Adds the chain of the speed that a robot's motors had at a step, an indented line each, and who
 * had a hand in the body since the speed was set.
 *
 * @return ends, bits of enum why_end; 0: no speed was ever set, and nobody had a hand in it
 */
uint32_t why_speed(const struct why *w, int32_t robot, uint32_t step);

/** The same of a fact that stood at the end of a step; 0: there was none of that index. */
uint32_t why_fact(const struct why *w, int32_t robot, uint32_t step, long long index);

#endif
