/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file lockstep_story.h
 * Rosters and answers for a broker of broker_story.h.
 */
#ifndef MUSTER_TESTS_LOCKSTEP_STORY_H
#define MUSTER_TESTS_LOCKSTEP_STORY_H

#include "broker_story.h"

static bool is_held; /* what the next rosters say */

/* @param names  processes, a space between them */
static inline void roster_say(bool lockstep, int64_t step, const char *names)
{
    static char text[256];
    char *processes[8], *save = NULL;
    muster_Roster roster = {.simulator = words("sim"),
                            .lockstep = lockstep,
                            .step = step,
                            .step_ns = 100 * MS,
                            .held = is_held};
    snprintf(text, sizeof text, "%s", names);
    for (char *word = strtok_r(text, " ", &save); word; word = strtok_r(NULL, " ", &save)) {
        processes[roster.processes._length++] = word;
    }
    roster.processes._buffer = processes;
    broker_roster(story.b, &roster, story.now_ns);
}

static inline void answer(const char *name, int64_t step)
{
    story_up(name, step, muster_STATE_RUNNING, NULL, 0, 0);
}

#endif
