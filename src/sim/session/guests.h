/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file guests.h
 * Agents without a body that began while a lock step went on: clones, and those that were launched.
 *
 * They stand in order of name, so that nothing shows in which order they came.  Who comes, moves or
 * ends does so between two steps.
 */
#ifndef MUSTER_SIM_GUESTS_H
#define MUSTER_SIM_GUESTS_H

#include "muster/limits.h"
#include "muster/result.h"
#include "sim/record/record.h"

#include <stdbool.h>

struct guest {
    char name[MU_NAME_MAX + 1];
    int32_t process;                      /* index of the one that it lives in; -1: that has died */
    int32_t next_process;                 /* from the next step on; -1: the same */
    muster_State state;                   /* by its last word */
    unsigned char digest[RUN_HASH_BYTES]; /* of what it did in this step */
};

struct guests {
    struct guest *at; /* [0, count), in order of name */
    uint32_t count;
    struct guest *coming; /* MU_CAPSULES_MAX: they begin with the next step */
    uint32_t coming_count;
};

/** Takes memory at start-up. */
struct guests *guests_open(void);

/** @return the one of that name that lives in this step, or NULL */
struct guest *guests_find(const struct guests *g, const char *name);

/** From the next step on an agent lives in that process; who is not known begins there.
 *  @return MU_OK, or MU_FULL: more than MU_CAPSULES_MAX begin in one step, or too many live */
MU_MUST_USE mu_result guests_seat(struct guests *g, const char *name, int32_t process);

/** A process has another index now; -1: it is dead, and those who live there, or were to, have
 * none. */
void guests_renumber(struct guests *g, int32_t from, int32_t to);

/** Between two steps: who comes is in, who moves has moved, who has ended is out. */
void guests_settle(struct guests *g);

#endif
