/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file step.h
 * The end of a step, in which all that was kept until then takes effect.
 */
#ifndef MUSTER_BROKER_STEP_H
#define MUSTER_BROKER_STEP_H

#include "broker/base/base.h"

struct broker;

/** All of a process's Up has been collected; the step may end with it. */
void step_answered(struct broker *b, uint32_t place);

/** Keeps an admitted mail of a recording until the step that ends when it is due; there it is one
 * from outside. */
void step_keep_replay(struct broker *b, struct mail *m);

#endif
