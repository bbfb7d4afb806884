/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file body.h
 * Between a mind and the runtime: what the body feels goes in, what the rules did goes out.
 */
#ifndef MUSTER_AGENT_BODY_H
#define MUSTER_AGENT_BODY_H

#include "mind/mind.h"
#include "muster/agent.h"

/** Hands on what the rules have the body do in this step. */
void body_act(mu_agent *a, const struct mind_act *act);

/** Asks for the sensors that the rules look at. */
void body_ask(mu_agent *a, const struct mind *mind);

#endif
