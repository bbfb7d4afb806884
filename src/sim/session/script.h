/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file script.h
 * What waits for its time: orders for later, and conditions whose coming true is written down.
 *
 * Conditions are looked at once a step, at its end and before anything is done to the world, so
 * that what they bring about is the same in every run.
 */
#ifndef MUSTER_SIM_SCRIPT_H
#define MUSTER_SIM_SCRIPT_H

#include "sim/record/record.h"
#include "world/condition/condition.h"

struct script;

/** Takes memory at start-up.  names must live as long. */
struct script *script_open(const struct condition_names *names);

/**
 * Writes the times at which events come true into a CSV file: a state when it begins, and a mail
 * or a rule in every step that has one.
 *
 * @return MU_OK; MU_FAULT_USAGE: an event is no condition; MU_FAULT_OS: the file cannot be made;
 *         both explained
 */
MU_MUST_USE mu_result script_record(struct script *s, const char *path, const char *const *events,
                                    size_t count);

/**
 * Keeps an order with a time or a condition.
 *
 * @param why  CONDITION_WHY_MAX bytes, filled when the condition is none
 * @return MU_OK, MU_FULL or MU_MALFORMED
 */
MU_MUST_USE mu_result script_put(struct script *s, const muster_RunCommand *command, char *why);

/** Notes what an agent did in this step. */
void script_act(struct script *s, int robot, const muster_Act *act);

/**
 * Looks at all conditions at the end of a step, and begins the next one.
 *
 * @param time_ns  of the step
 */
void script_look(struct script *s, uint64_t time_ns, const struct condition_view *view);

/** @return an order whose time has come, good until the next call; NULL: none, for now */
const muster_RunCommand *script_next(struct script *s);

/** Ends the record.  @return MU_OK or MU_FAULT_OS, explained */
MU_MUST_USE mu_result script_close(struct script *s);

#endif
