/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file states.h
 * The states of a robot and of a migration, and the events that change them.
 *
 * An event that the table does not have changes nothing.  Our own code aborts then (..._enter).  An
 * event of a broker, a simulator or a host is refused and counted by the caller (..._apply).
 */
#ifndef MUSTER_AGENT_STATES_H
#define MUSTER_AGENT_STATES_H

#include "muster/result.h"

#include <stdbool.h>

/* --- a robot's place in its process, and its part in the step at hand --------------------------*/

enum robot_state {
    ROBOT_VACANT,    /* its place is free: not begun, disposed of, moved away, or refused */
    ROBOT_JOINS,     /* it begins here; the broker has not given it its name yet */
    ROBOT_RESTORED,  /* its mind is made of a checkpoint; it has not asked for its name */
    ROBOT_ARRIVES,   /* it comes from elsewhere and has asked for its name */
    ROBOT_RETURNS,   /* it comes from its checkpoint and has asked for its name */
    ROBOT_RETURNED,  /* it has its name again; its first step is to come */
    ROBOT_RESTS,     /* no percept waits */
    ROBOT_PERCEIVES, /* a percept waits for its mind */
    ROBOT_REPEATS,   /* it repeats its answer to the step at hand */
    ROBOT_STATES
};

enum robot_event {
    ROBOT_BEGINS,     /* its mind is made of rules */
    ROBOT_RECALLS,    /* its mind is made of a checkpoint */
    ROBOT_ASKS,       /* it asks for its name, coming from elsewhere or from a checkpoint */
    ROBOT_IS_NAMED,   /* the broker gives it its name */
    ROBOT_FEELS,      /* a step begins with a percept for its mind */
    ROBOT_SITS_OUT,   /* a step begins in which it takes no part */
    ROBOT_SAYS_AGAIN, /* a step begins that its checkpoint has an answer to */
    ROBOT_HAS_FELT,   /* its mind takes the percept */
    ROBOT_LEAVES,     /* it is disposed of, refused, or gone elsewhere */
    ROBOT_EVENTS
};

/** Applies an event.  @return false: the state does not have it, and stays */
MU_MUST_USE bool robot_state_apply(enum robot_state *state, enum robot_event event);

/** Applies an event of our own code; aborts if the state does not have it. */
void robot_state_enter(enum robot_state *state, enum robot_event event);

/** @return whether it has asked for a name, to go on where it was before */
bool robot_state_arrives(enum robot_state state);

/** @return whether it is in its process, with a name */
bool robot_state_lives(enum robot_state state);

/* --- the way of an agent, or of its copy, out of its process ---------------------------------- */

enum migration_purpose {
    MIGRATION_MOVE,
    MIGRATION_CLONE,
    MIGRATION_LAUNCH, /* in a snapshot's header only: no agent migrates for it */
    MIGRATION_PURPOSES
};

enum migration_state {
    MIGRATION_STAYS,
    MIGRATION_DEPARTS,    /* it sets out at the end of the step, or when all mail is out */
    MIGRATION_LAST_WORDS, /* its rules have fired; the answer may have no room for their mail */
    MIGRATION_DEPOSITED,  /* the snapshot goes to the broker; in lock step, its word is awaited */
    MIGRATION_KEPT,       /* the broker has it: the host's word is awaited */
    MIGRATION_SENDS,      /* pieces go out: of a copy, or to a host at another broker */
    MIGRATION_WAITS,      /* for the host's word */
    MIGRATION_YIELDS,     /* the host is ready; mail of the agent has no receipt yet */
    MIGRATION_HANDS_OVER, /* the name is released; the agent here is kept until the host has it */
    MIGRATION_STATES
};

enum migration_event {
    MIGRATION_BEGINS,       /* at the end of the step: a move, or a copy in lock step */
    MIGRATION_BEGINS_APART, /* a copy where no step waits for it */
    MIGRATION_TAKES_LEAVE,  /* its rules hear that it leaves */
    MIGRATION_DEPOSITS,     /* the broker is given the snapshot */
    MIGRATION_STANDS_STILL, /* out of lock step, the answer with the snapshot is out */
    MIGRATION_STORED,       /* the broker has it, and the host is at another one */
    MIGRATION_READY,        /* the host has made its own, and asks for the name */
    MIGRATION_TAKEN,        /* it, or its copy, lives elsewhere */
    MIGRATION_REFUSED,      /* by the host, or the broker */
    MIGRATION_SENT,         /* all pieces are out */
    MIGRATION_AGREED,       /* the host's answer to the pieces, */
    MIGRATION_DECLINED,     /* any other */
    MIGRATION_SETTLED,      /* the broker has answered for all that it sent */
    MIGRATION_SHOWN,        /* the white pages show it at the host */
    MIGRATION_FAILS,        /* it cannot be written, or time is up, or the host has gone */
    MIGRATION_GONE,         /* it was disposed of before it set out */
    MIGRATION_EVENTS
};

/** @return whether the state has the event, for that purpose */
bool migration_state_has(enum migration_state state, enum migration_purpose purpose,
                         enum migration_event event);

/** Applies an event.  @return false: the state does not have it, and stays */
MU_MUST_USE bool migration_state_apply(enum migration_state *state, enum migration_purpose purpose,
                                       enum migration_event event);

/** Applies an event of our own code, or one that was asked for before; aborts as robot_state_enter.
 */
void migration_state_enter(enum migration_state *state, enum migration_purpose purpose,
                           enum migration_event event);

#endif
