/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file life.h
 * The life cycle of an agent: which directive leads from which state to which.
 */
#ifndef MUSTER_RUNTIME_LIFE_H
#define MUSTER_RUNTIME_LIFE_H

#include "muster/agent.h"

/* What can happen to an agent. */
enum life_event { LIFE_START, LIFE_SUSPEND, LIFE_RESUME, LIFE_DISPOSE, LIFE_EVENTS };

/** @return the state after an event; the same state when the event means nothing there */
enum mu_state life_next(enum mu_state state, enum life_event event);

/** @return the state that an event is for */
enum mu_state life_wanted(enum life_event event);

/** Finds the event that a directive's performative names.  @return MU_OK or MU_ABSENT */
MU_MUST_USE mu_result life_event_named(const char *performative, enum life_event *event);

#endif
