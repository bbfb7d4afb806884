/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file membership.h
 * Names come, move and go, here and beyond other brokers.
 */
#ifndef MUSTER_BROKER_MEMBERSHIP_H
#define MUSTER_BROKER_MEMBERSHIP_H

#include "broker/services/services.h"

/* --- lifecycle.c ----------------------------------------------------------------------------- */

/** The agent is absent from now on; a process that waits for its name gets it. */
void lifecycle_depart(struct broker *b, uint32_t agent);

/** An agent that is nowhere moves into a slot of a process: a claim on its name is granted. */
void lifecycle_seat(struct broker *b, const struct claim *c);

/** It goes from one process to another: what it has not acknowledged goes there again. */
void lifecycle_move(struct broker *b, const struct claim *c);

/** Its own process says something new of it. */
void lifecycle_reregister(struct broker *b, struct claim *c);

/** An agent's state changes, and with it perhaps what it may be handed. */
void lifecycle_set_state(struct broker *b, uint32_t agent, muster_State state);

/** The run has let go of a process: departures that it held up take place. */
void lifecycle_settle(struct broker *b, uint32_t place);

/** A process that has waited long enough for a name is given it, if it is free, and else refused.
 */
void lifecycle_tick(struct broker *b);

/** @return when lifecycle_tick is needed next, or UINT64_MAX */
uint64_t lifecycle_deadline_ns(const struct broker *b);

/** The reader of a process may have missed what was written: all that stands is told again. */
void lifecycle_tell_again(struct broker *b, uint32_t place);

/** Something about the agent has changed: its best route is looked for. */
void lifecycle_review(struct broker *b, uint32_t agent);

void lifecycle_tick_routes(struct broker *b);

void lifecycle_end_claim(struct broker *b, uint32_t index);

/** A process waits for a name. */
void lifecycle_claim(struct broker *b, struct claim *c);

/** A process does not get a name, which an agent at another broker has, or (home "") one here. */
void lifecycle_refuse_held(struct broker *b, uint32_t agent, uint32_t place, const char *home);

/** It is the last bearer itself, which has set out for there. */
bool lifecycle_is_copy(struct broker *b, uint32_t agent, const struct presence *is);

/* --- registration.c -------------------------------------------------------------------------- */

/* Registrations, claims on names, and departures. */

/** Takes what a process says of one part of its agents. */
void registration_take(struct broker *b, const muster_Registration *r);

/** What an entry says of an agent of that process, or of one beyond another broker. */
void registration_presence(const muster_Entry *e, const char *host, uint32_t pid,
                           struct presence *is);

/** A process has taken back a part, or (crashed) it is not written for any more. */
void registration_gone(struct broker *b, uint32_t place, uint32_t part, bool crashed);

/* --- transfer.c ------------------------------------------------------------------------------ */

/** Takes a word of a process.  @param in_step  it came with the process's answer to a step */
void transfer_hear(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step);

/** A step has taken effect: it ends now, or when those that are on their way are at their hosts. */
void transfer_step_ended(struct broker *b);

/** The run is over, for that reason: an agent that is on its way inside stays. */
void transfer_run_over(struct broker *b, const char *reason);

/** Gives up hosts that are silent. */
void transfer_tick(struct broker *b);

/* --- federation.c ---------------------------------------------------------------------------- */

/**
 * A neighbour of this name and life speaks.
 *
 * @return it, entered if it is new; NULL: it is of an earlier life, or there are too many
 */
struct peer *federation_meet(struct broker *b, const char *name, uint64_t incarnation);

/** Takes a part of what another broker announces. */
void federation_hear(struct broker *b, const muster_Registration *r);

/** Another broker is silent, or has left: nothing is known of the agents beyond it. */
void federation_lose(struct broker *b, uint32_t place);

/* --- announce.c ------------------------------------------------------------------------------ */

/*
 * What this broker says to the others of the agents that it knows: its own, those beyond other
 * brokers, and those that are absent.  An agent's slot is its place in the white pages.
 */

/** Everything is to be said again. */
void announce_all(struct broker *b);

/** What is said of an agent is no more: its slot is free. */
void announce_agent(struct broker *b, uint32_t agent);

void announce_tick(struct broker *b);
uint64_t announce_deadline_ns(const struct broker *b);

/* --- retire.c -------------------------------------------------------------------------------- */

/*
 * A name whose agent was disposed of ends at once; its index is free when nothing refers to it any
 * more and the other brokers have heard of it.  The others end when room is needed: those whose
 * agents have been absent for long enough, and that hold nothing that may be asked for: mail in a
 * box or on its way, sent or awaited, a group, a snapshot, a claim, a probe.  While a run goes by
 * steps none ends.
 *
 * Many parts of the broker keep indices of agents.  Those that are in use are found anew each time,
 * by a look at all of them: nothing has to be counted.
 */

/**
 * An agent has left that was perhaps disposed of.  If so, its mail is answered, and its groups and
 * services go, at once, or when the run that goes by steps is over.
 */
void retire_disposed(struct broker *b, uint32_t agent);

/** Ends names, when it is time.  No caller may have an index in hand. */
void retire_tick(struct broker *b);

/** @return when retire_tick is needed next, or UINT64_MAX */
uint64_t retire_deadline_ns(const struct broker *b);

#endif
