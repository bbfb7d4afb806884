/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file members.h
 * A process's copy of the white pages, which the broker keeps up to date.
 */
#ifndef MUSTER_RUNTIME_MEMBERS_H
#define MUSTER_RUNTIME_MEMBERS_H

#include "core/table.h"
#include "muster/agent.h"
#include "wire.h"

/* Lines that a copy can hold: agents, a broker and its parts. */
enum { MEMBERS_MAX = MU_AGENTS_MAX + MU_BROKER_LINES };

struct members {
    struct mu_member *lines; /* MEMBERS_MAX of them; a line stays where it is */
    uint64_t *absences;      /* of each line: 0, or the number of its agent's absence */
    uint32_t *order;         /* [0, count): lines in order of name */
    uint32_t *spare;         /* [0, spare_count): lines given back */
    size_t count;
    uint32_t spare_count;
    uint64_t absences_count; /* ever */
    struct mu_table names;
};

/** Takes memory at start-up; unused memory stays untouched. */
void members_init(struct members *m);

/** Forgets all: another broker has other pages. */
void members_clear(struct members *m);

/**
 * Enters a line or changes it.  When the copy is full, a new line takes the place of the agent that
 * is absent longest; if there is none, or the new one is absent itself, it is left out.
 */
void members_set(struct members *m, const muster_Member *line);

/** @return the line of a name, or NULL */
const struct mu_member *members_find(const struct members *m, const char *name);

/** @return the index-th line in order of name, or NULL */
const struct mu_member *members_at(const struct members *m, size_t index);

#endif
