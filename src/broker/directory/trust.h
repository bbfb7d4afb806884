/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file trust.h
 * The trust policy: whose directives are carried out.
 *
 * A policy is a list of lines, and the last one that fits a sender and a receiver decides:
 *
 *     allow WHO direct WHOM        # a comment
 *     deny WHO direct WHOM
 *
 * WHO and WHOM are a name, all, robots, special, group:G or role:R.  When no line fits, the answer
 * is no.  The name operator also stands for special agents named operator-N, which are consoles.
 * Without a file it is as if there were these: allow observer direct all, allow operator
 * direct all.
 */
#ifndef MUSTER_BROKER_TRUST_H
#define MUSTER_BROKER_TRUST_H

#include "core/fault.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum trust_party_kind {
    TRUST_NAME,
    TRUST_ALL,
    TRUST_ROBOTS,
    TRUST_SPECIAL,
    TRUST_GROUP,
    TRUST_ROLE
};

/* One side of a line. */
struct trust_party {
    enum trust_party_kind kind;
    char name[MU_NAME_MAX + 1]; /* of the agent, group or role */
};

struct trust_line {
    bool allow;
    struct trust_party who, whom;
};

/* What a line needs to know of others: asked when a directive comes, not when the file is read.  A
 * question that is NULL is answered with no. */
struct trust_pages {
    void *self;
    bool (*in_group)(void *self, const char *group, const char *agent);
    bool (*has_role)(void *self, const char *role, const char *agent);
};

struct trust {
    struct trust_line *lines; /* MU_TRUST_LINES_MAX of them */
    uint32_t lines_count;
    struct trust_pages pages;
};

/* An agent as a policy sees it. */
struct trust_agent {
    const char *name;
    muster_Kind kind;
};

/** The policy that holds without a file. */
void trust_init(struct trust *t);

/**
 * Replaces the policy by that of a file.
 *
 * @param text  the whole file, zero-terminated
 * @param file  its name, for the fault
 * @return MU_OK; MU_FAULT_FILE with line, column and what was expected: the policy is of no use
 * then
 */
MU_MUST_USE mu_result trust_read(struct trust *t, const char *text, const char *file,
                                 struct mu_fault *fault);

/** @return whether a directive of who to whom is carried out */
bool trust_allows(const struct trust *t, const struct trust_agent *who,
                  const struct trust_agent *whom);

/** @return whether some line lets who direct somebody: for a directive that nobody is there for */
bool trust_allows_some(const struct trust *t, const struct trust_agent *who);

#endif
