/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file life.h
 * The states of an agent: which directive leads from which state of its life to which, what the
 * broker has said of its name, and how it leaves its process.
 */
#ifndef MUSTER_RUNTIME_LIFE_H
#define MUSTER_RUNTIME_LIFE_H

#include "muster/agent.h"

/* The events of an agent's life. */
enum life_event { LIFE_START, LIFE_SUSPEND, LIFE_RESUME, LIFE_DISPOSE, LIFE_EVENTS };

/** @return the state after an event; the same state when the event means nothing there */
enum mu_state life_next(enum mu_state state, enum life_event event);

/** @return the state that an event is for */
enum mu_state life_wanted(enum life_event event);

/** Finds the event that a directive's performative names.  @return MU_OK or MU_ABSENT */
MU_MUST_USE mu_result life_event_named(const char *performative, enum life_event *event);

/* An agent's name at the broker. */
enum life_name {
    NAME_UNSAID,      /* no registration of it has gone out */
    NAME_FOLLOWS,     /* an agent of the same name is leaving: the broker hears of this one later */
    NAME_ASKED,       /* its registration has gone out */
    NAME_ACCEPTED,    /* its broker has accepted it */
    NAME_ASKED_AGAIN, /* it was accepted, and its registration is said anew: to another broker? */
    NAME_REFUSED,
    NAME_STATES
};

enum life_name_event {
    NAME_GRANT,   /* verdicts of the broker */
    NAME_REFUSAL, /* refused and counted: one before the registration is for an earlier agent */
    NAME_OWN_EVENTS,
    NAME_WRITTEN = NAME_OWN_EVENTS, /* its registration has gone out */
    NAME_ANEW,                      /* every registration is to be said anew */
    NAME_FREE,                      /* the agent before it has left */
    NAME_EVENTS
};

/* How an agent leaves its process. */
enum life_exit {
    EXIT_PRESENT,
    EXIT_LAST_WORDS, /* it is gone; its registration stays until its last mails are out */
    EXIT_DEPARTING,  /* likewise, and another process or agent has its name now */
    EXIT_DEPARTED,   /* it has left, and another process or agent has its name */
    EXIT_LEFT,
    EXIT_STATES
};

enum life_exit_event {
    EXIT_GOES,     /* it is disposed of */
    EXIT_MOVES,    /* another process or agent has its name from now on */
    EXIT_SAID_ALL, /* its last mails are out, or the broker that they were for is gone */
    EXIT_EVENTS
};

/** Applies an event.  @return false: the state refuses it; our own events abort then */
bool life_name_on(mu_agent *a, enum life_name_event event);

/** Applies an event of our own; counts the agents of the process that begin to leave. */
void life_exit_on(mu_agent *a, enum life_exit_event event);

/** @return whether its registration stays for its last words */
bool life_is_leaving(const mu_agent *a);

/** @return whether another process or agent answers for its name */
bool life_is_elsewhere(const mu_agent *a);

#endif
