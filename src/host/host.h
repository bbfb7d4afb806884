/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file host.h
 * A platform: a group process whose robots come and go.
 *
 * accept.c takes agents in, arrival.c collects pieces, native.c begins the robots of the command
 * line, host.c is the platform itself.
 */
#ifndef MUSTER_HOST_HOST_H
#define MUSTER_HOST_HOST_H

#include "agent/robot.h"
#include "host/host_options.h"

#include <limits.h>

enum { HOST_ARRIVALS = MU_CAPSULES_MAX };

/* An agent that comes in pieces, or that has arrived and waits for its name. */
struct arrival {
    bool used;
    bool deposited;             /* in lock step: it is whole, and the broker keeps it ... */
    char name[MU_NAME_MAX + 1]; /* ... under this name */
    char src[MU_NAME_MAX + 1], id[MU_FIELD_MAX + 1], reply_with[MU_FIELD_MAX + 1];
    bool directive;                     /* the sender may direct this host */
    uint32_t pieces;                    /* that are there */
    size_t total;                       /* bytes that there are to be */
    uint64_t until_ns;                  /* the next one must come before */
    struct mu_text text;                /* MIGRATION_SNAPSHOT_MAX */
    const struct checkpoint_head *head; /* of one from a checkpoint; else NULL */
};

struct host {
    struct group_process group; /* first: the group of a robot is the host */
    const struct host_options *set;
    char folder[PATH_MAX]; /* of the shared rules */
    mu_agent *agent;
    struct arrival arrivals[HOST_ARRIVALS];
    struct arrival *waiting; /* of each robot, until it has its name; used: a sender waits */
    uint64_t asked_ns;       /* last time, for agents without a process */
};

/* host.c */

/** Takes the memory of a host. */
struct host *host_make(const struct host_options *set);

/** Lets the host join its process.  @return as mu_agent_join */
MU_MUST_USE mu_result host_join(struct host *h);

/** Takes a word of the broker about an agent that arrives or leaves. */
void host_hear(void *self, const muster_Trip *word);

/** Takes in all agents with a checkpoint.  @return how many */
uint32_t host_restore(struct host *h);

/* accept.c */

/** Answers the sender of an agent. */
void host_answer(struct host *h, const struct arrival *a, const char *performative,
                 const char *text);

/** @return the arrival of that name that the broker has, or NULL */
struct arrival *host_find_deposited(struct host *h, const char *name);

/**
 * Makes an agent of a whole snapshot, and lets it ask for its name.
 *
 * @param why  out: the reason of a refusal, MU_FAULT_TEXT_MAX + 1 bytes
 * @return the agent, whose on_registered says whether it gets its name; NULL: it is refused
 */
struct robot *host_take_in(struct host *h, const struct arrival *a,
                           char why[MU_FAULT_TEXT_MAX + 1]);

/**
 * Gives a launched agent to the broker, which says in lock step when it begins, and gives it back.
 *
 * @param why  out: the reason of a refusal, MU_FAULT_TEXT_MAX + 1 bytes
 * @return whether the broker has it
 */
bool host_deposit(struct host *h, struct arrival *a, char why[MU_FAULT_TEXT_MAX + 1]);

/* launch.c */

/** @return the rules, behind the globals and groups of an agent that is launched */
const char *launch_rules(const char *rest);

/** Sets its globals.  @return MU_OK; MU_FAULT_FILE: fault says which cannot be set */
MU_MUST_USE mu_result launch_set_globals(struct robot *r, const char *rest, struct mu_fault *fault);

/** Lets it join its groups.  @return as mu_agent_group_join */
MU_MUST_USE mu_result launch_join_groups(struct robot *r, const char *rest);

/* native.c */

/** @return whether the command line says that a robot of that name begins here */
bool natives_have(const struct host *h, const char *name);

/**
 * Makes the robots that begin here, without those that come back or have ended before.
 *
 * @return MU_OK; MU_FAULT_USAGE, MU_FAULT_FILE: the mistake was printed; or as mu_agent_join
 */
MU_MUST_USE mu_result natives_begin(struct host *h);

/* arrival.c */

/** Takes the memory for arrivals. */
void arrivals_reserve(struct host *h);

/** Takes a piece; the last one brings the agent. */
void arrival_take(struct host *h, const struct mu_mail *mail);

#endif
