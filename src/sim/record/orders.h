/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file orders.h
 * Changes from outside that wait for the end of a step: in the order of source and sequence, so
 * that the order in which they arrive within a step does not show.
 */
#ifndef MUSTER_SIM_ORDERS_H
#define MUSTER_SIM_ORDERS_H

#include "muster/limits.h"
#include "muster/result.h"
#include "wire.h"

#include <stddef.h>

enum { ORDERS_FILE_MAX = 1023 };

/* A command with strings of its own. */
struct order {
    muster_RunCommand command; /* its strings are those below; simulator is not set */
    char source[MU_PROCESS_MAX + 1], name[MU_FIELD_MAX + 1], file[ORDERS_FILE_MAX + 1];
    char when[MU_CONDITION_MAX + 1];
    bool taken;
};

struct orders {
    struct order at[MU_ORDERS_MAX];
    size_t count;
};

/** Copies a command with its strings; to must stay where it is. */
void orders_copy(struct order *to, const muster_RunCommand *command);

/** Keeps a copy of a command that the border has let through.  @return MU_OK, or MU_FULL */
MU_MUST_USE mu_result orders_put(struct orders *o, const muster_RunCommand *command);

/** @return the next of those that wait, good until the next call; NULL: there is none, and there is
 *          room again */
const muster_RunCommand *orders_take(struct orders *o);

#endif
