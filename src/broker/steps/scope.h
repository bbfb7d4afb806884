/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file scope.h
 * The rules of isolation between a run that goes in lock step and everything else.
 */
#ifndef MUSTER_BROKER_SCOPE_H
#define MUSTER_BROKER_SCOPE_H

#include "broker/names/names.h"

/*
 * What is inside of a run that goes in lock step does not depend on the wall clock, and so not on
 * what is outside.  An agent, a process and a line of the broker's own each have a scope, a byte;
 * these rules are all that the broker asks of it.  To an agent outside all others are open.
 */

enum scope {
    SCOPE_OPEN,    /* outside of every lock step */
    SCOPE_AWAITED, /* an agent outside: the run is held, perhaps for it */
    SCOPE_BESIDE, /* an agent that looks on, in a process of the run: it speaks from outside, in its
                     turn; or the process of the simulator */
    SCOPE_RUN,    /* a member of the run */
    SCOPE_BROKER, /* the broker's own line */
    SCOPE_PART,   /* the line of one of its parts */
    SCOPES
};

/**
 * @param process   the scope of its process
 * @param looks_on  it is a special agent, in a process whose agents have no bodies
 * @param awaited   the run is held, and it is a robot, or its name was in the run before
 */
static inline enum scope scope_of_agent(enum scope process, bool looks_on, bool awaited)
{
    if (process == SCOPE_RUN) {
        return looks_on ? SCOPE_BESIDE : SCOPE_RUN;
    }
    return awaited ? SCOPE_AWAITED : SCOPE_OPEN;
}

static inline enum scope scope_of_line(bool is_part)
{
    return is_part ? SCOPE_PART : SCOPE_BROKER;
}

/** @return the scope of a word about a migration that came with an answer to a step, or without */
static inline enum scope scope_of_word(bool in_step)
{
    return in_step ? SCOPE_RUN : SCOPE_OPEN;
}

/** @return whether all that it does and learns is the same in every run */
static inline bool scope_is_inside(enum scope scope)
{
    return scope == SCOPE_RUN;
}

/** @return whether the steps of the run wait for it, and it for them */
static inline bool scope_is_paced(enum scope scope)
{
    return scope == SCOPE_RUN || scope == SCOPE_BESIDE;
}

/** @return whether its mail waits for its first step */
static inline bool scope_waits(enum scope scope)
{
    return scope == SCOPE_AWAITED;
}

/** @return whether it is told what other brokers and the disk say of its mail */
static inline bool scope_is_told(enum scope scope)
{
    return !scope_is_inside(scope);
}

/** @return whether a process is told of groups and services */
static inline bool scope_is_shown_lines(enum scope scope)
{
    return scope == SCOPE_RUN || scope == SCOPE_OPEN;
}

/** @return whether an answer may name the agent to the one that asks */
static inline bool scope_sees(enum scope asker, enum scope agent)
{
    return asker != SCOPE_RUN || agent == SCOPE_RUN || agent == SCOPE_BROKER;
}

/** @return whether mail reaches the agent by its name */
static inline bool scope_addresses(enum scope sender, enum scope agent)
{
    return sender != SCOPE_RUN || agent != SCOPE_PART;
}

/** @return whether mail leaves the run, so that its sender is not told what becomes of it */
static inline bool scope_crosses(enum scope sender, enum scope agent)
{
    return sender == SCOPE_RUN &&
           (agent == SCOPE_OPEN || agent == SCOPE_AWAITED || agent == SCOPE_BESIDE);
}

/** @return the account of the store on which mail goes */
static inline enum quota_side scope_account(enum scope payer)
{
    return scope_is_inside(payer) ? QUOTA_INSIDE : QUOTA_OUTSIDE;
}

/** @return why an agent cannot be handed from there to there, or NULL */
static inline const char *scope_refuses_move(enum scope from, enum scope to)
{
    return from == SCOPE_RUN && to != SCOPE_RUN ? "lock-step" : NULL;
}

/** @return why it is not told the broker's counters, which depend on the wall clock, or NULL */
static inline const char *scope_refuses_counters(enum scope asker)
{
    return scope_is_inside(asker) ? "in-lock-step" : NULL;
}

#endif
