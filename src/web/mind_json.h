/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mind_json.h
 * What was in a robot's mind at a step of a recording, as the page reads it:
 *
 *     robot     its name
 *     step      of the last line of its diary up to then; -1: there is none
 *     facts     ["f-12", "(goal wander)"], ...    those that stood, the oldest first
 *     agenda    ["see", "12,9"], ...              rule, and the facts that it would fire on
 *     fired     [step, "see", "12,9"], ...        the last ones, the latest first
 *     mails     [step, "blue tell near 2000.0", sent], ...    likewise; sent: else it came
 *
 * Pure.
 */
#ifndef MUSTER_WEB_MIND_JSON_H
#define MUSTER_WEB_MIND_JSON_H

#include "core/json.h"
#include "story/minds.h"

enum {
    MIND_JSON_FACTS_MAX = 1000,
    MIND_JSON_FIRED_MAX = 20,
    MIND_JSON_MAILS_MAX = 20,
    MIND_JSON_TEXT_MAX = 400 /* bytes of a fact or mail that are shown */
};

/** Writes one object. */
void mind_json_write(struct mu_json *j, const char *key, const struct minds *minds,
                     const char *robot, uint32_t step);

#endif
