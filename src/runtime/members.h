/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file members.h
 * A process's copy of the white pages, which the broker keeps up to date.
 */
#ifndef MUSTER_RUNTIME_MEMBERS_H
#define MUSTER_RUNTIME_MEMBERS_H

#include "muster/agent.h"
#include "wire.h"

/* Lines that a copy can hold: agents, a broker and its parts. */
enum { MEMBERS_MAX = MU_AGENTS_MAX + MU_BROKER_LINES };

struct members {
    struct mu_member *lines; /* MEMBERS_MAX of them, [0, count) in order of name */
    size_t count;
};

/** Takes memory at start-up. */
void members_init(struct members *m);

/** Forgets all: another broker has other pages. */
void members_clear(struct members *m);

/** Enters a line or changes it; a line too many is left out. */
void members_set(struct members *m, const muster_Member *line);

/** @return the line of a name, or NULL */
const struct mu_member *members_find(const struct members *m, const char *name);

#endif
