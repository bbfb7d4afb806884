/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file groups.h
 * Who is a member of what: a bounded table of lines, one for each group and each of its members.
 *
 * A line says what was said last, by stamp, then by the broker's name: lines of several brokers can
 * be merged in any order.  A line that says "no longer" stays, so that older word is known to be
 * older and every process is told, until the table needs its place.
 *
 * Every change moves its line to the end of `changes`: that is where whoever keeps lines elsewhere
 * (processes, a disk, other brokers) finds what is new, each by the version that it has had.
 *
 * In lock step there are two views.  What takes effect at the end of a step is seen by all; what
 * is said by the wall clock, outside the run, is not seen inside, where each line stays as it was.
 */
#ifndef MUSTER_BROKER_GROUPS_H
#define MUSTER_BROKER_GROUPS_H

#include "broker/base/changes.h"
#include "core/pairs.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>

/* When something was said, and to whom. */
struct said {
    uint64_t stamp_ns;  /* nanoseconds since 1970; in lock step, of the run */
    const char *origin; /* the broker; at most MU_NAME_MAX bytes */
    bool inside;        /* takes effect at the end of a step of the lock step */
};

struct group_line {
    bool joined;        /* of the group's own line: it is there, even without members */
    bool joined_inside; /* as it is seen in lock step */
    uint64_t stamp_ns;
    char origin[MU_NAME_MAX + 1];
};

struct groups {
    struct mu_pairs pairs; /* (group, agent); the group's own line has no agent */
    struct group_line *lines;
    struct changes changes;
    uint32_t count;                   /* groups that have lines */
    uint32_t groups_now, members_now; /* of whom it holds, outside; for the counters */
    uint64_t told; /* everybody has had the changes up to this version: see groups_full */
};

void groups_init(struct groups *g);

/* Changes.  Names are checked here.  @return NULL, or why not: one word */

const char *groups_create(struct groups *g, const char *group, const struct said *said);
const char *groups_join(struct groups *g, const char *group, const char *agent,
                        const struct said *said);
const char *groups_leave(struct groups *g, const char *group, const char *agent,
                         const struct said *said);

/**
 * Takes in a line of another broker, or one that was kept on a disk.
 *
 * @param inside  members of the lock step are to see it
 * @return MU_OK; MU_EXISTS: a younger one, or this one, is there; MU_FULL; MU_MALFORMED
 */
mu_result groups_merge(struct groups *g, const muster_Membership *line, bool inside);

/** @return whether a line may have to make room: set `told` before the next change */
bool groups_full(const struct groups *g);

/** A lock step begins: inside, everything is seen as it is now. */
void groups_freeze(struct groups *g);

/** An agent enters the lock step: its lines are seen there as they are now. */
void groups_enter(struct groups *g, const char *agent);

/** @return whether there is such a group */
bool groups_exists(const struct groups *g, const char *group, bool inside);

/** @return whether the agent is a member of the group */
bool groups_has(const struct groups *g, const char *group, const char *agent, bool inside);

/**
 * Goes through the members of a group in order of name.
 *
 * @param place  0 at first; kept up to date
 * @return the next member's name, or NULL
 */
const char *groups_member(const struct groups *g, const char *group, bool inside, uint32_t *place);

/** Goes through the groups in order of name, likewise. */
const char *groups_name(const struct groups *g, bool inside, uint32_t *place);

/** Fills a line with pointers into the table. */
void groups_line(const struct groups *g, uint32_t line, bool inside, muster_Membership *out);

#endif
