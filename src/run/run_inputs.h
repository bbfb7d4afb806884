/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file run_inputs.h
 * What came into a recorded run from outside, for a run that is to go the same way.
 */
#ifndef MUSTER_RUN_RUN_INPUTS_H
#define MUSTER_RUN_RUN_INPUTS_H

#include "bus/bus.h"
#include "muster/agent.h"
#include "story/story.h"

struct run_inputs;

/** Opens a recording, at start-up.  @return NULL: fault says why */
struct run_inputs *run_inputs_open(const char *path, struct mu_fault *fault);

/**
 * Names the process that hands it over.
 *
 * @param observer  registered; what it says itself must be answered for before the first call
 * @param orders    a writer of RunCommand
 */
void run_inputs_join(struct run_inputs *in, mu_process *process, mu_agent *observer,
                     struct bus_writer *orders, const char *simulator);

/** Takes a name of the recorded run, even of an agent that said nothing: it is in the white
 * pages, which rules can look at. */
void run_inputs_seat(struct run_inputs *in, const char *name);

/**
 * Hands over as much as can be under way; the next time more.
 *
 * @return whether the broker has answered for all of it
 */
bool run_inputs_tell(struct run_inputs *in);

/** @return whether a name was refused, or a mail was: the run will go another way */
bool run_inputs_refused(const struct run_inputs *in);

#endif
