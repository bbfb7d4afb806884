/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file step.h
 * What the files of control share: the end of a step, in which all that was kept until then takes
 * effect.
 */
#ifndef MUSTER_BROKER_STEP_H
#define MUSTER_BROKER_STEP_H

#include "broker/control/parts.h"

/** All of a process's Up has been collected; the step may end with it. */
void step_answered(struct broker *b, uint32_t place);

/** Those of a run that is over are dropped. */
void step_drop_replays(struct broker *b);

/** All that was kept of the step that ends takes effect, in a fixed order. */
void step_apply(struct broker *b);

#endif
