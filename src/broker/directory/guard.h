/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file guard.h
 * Whose directives go on to whom: asks the policy, counts, and keeps the audit.
 */
#ifndef MUSTER_BROKER_GUARD_H
#define MUSTER_BROKER_GUARD_H

#include "broker/base/store.h"

struct broker;

/**
 * Takes those out of a directive's receivers whom its sender may not direct.
 *
 * @param agents  whom it is for, count of them; those that stay keep their order
 * @return for how many it is refused; 1 when it is for nobody, and its sender may direct nobody
 */
uint32_t guard_sift(struct broker *b, const struct mail *m, uint32_t *agents, uint32_t *count);

/**
 * Asks whether the sender of a mail may speak in another agent's name: whom the policy lets direct
 * it may, and whoever lives in the same process.
 *
 * @param agent  MU_NONE: nobody whom the sender could know, who bears the name in receiver
 */
bool guard_speaks(struct broker *b, const struct mail *m, uint32_t agent, const char *receiver);

/**
 * Asks whether an agent may look at another one's mind: whom it may direct it may look at.
 *
 * @return false: nothing is counted or audited yet
 */
bool guard_glances(struct broker *b, uint32_t asker, uint32_t agent, const char *line);

#endif
