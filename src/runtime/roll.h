/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file roll.h
 * The registration of a process's agents: a part for each 64, written when it has changed.
 */
#ifndef MUSTER_RUNTIME_ROLL_H
#define MUSTER_RUNTIME_ROLL_H

#include "muster/agent.h"
#include "wire.h"

enum { ROLL_PARTS = MU_LOCAL_AGENTS_MAX / MU_PART_AGENTS };

struct roll {
    bool due[ROLL_PARTS]; /* not written as it is now */
    uint32_t due_count;
    muster_Entry entries[MU_PART_AGENTS]; /* of the part that is being written */
};

/** The agent's part is to be written. */
void roll_mark(struct mu_agent *a);

/** Every part is to be written: a process has not heard them. */
void roll_mark_all(mu_process *p);

/** Part 0 is to be written, so that the broker hears that the process lives, and what a full broker
 * has refused, which may have room now. */
void roll_refresh(mu_process *p);

/** Writes the parts that are due, when a broker is known; a part that the network refuses stays
 * due. */
void roll_write(mu_process *p);

/** Takes all parts back. */
void roll_end(mu_process *p);

#endif
