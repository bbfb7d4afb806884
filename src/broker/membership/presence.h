/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file presence.h
 * Who is there: registrations, claims on names, and departures.
 */
#ifndef MUSTER_BROKER_PRESENCE_H
#define MUSTER_BROKER_PRESENCE_H

#include "broker/control/broker.h"
#include "broker/names/registry.h"

/** @return nanoseconds since 1970 */
uint64_t presence_wall_ns(const struct broker *b);

/**
 * It has acknowledged a number.  If that was not handed out before the last verdict, its process
 * knows its seat here, and which number comes next: who has had that number already takes whatever
 * follows it.
 */
void presence_seated(struct broker *b, uint32_t agent, uint64_t number);

/** @return whether the agent's process is in a lock step that is on */
bool presence_in_lockstep(const struct broker *b, uint32_t agent);

/** @return whether the lock step waits for its process: it is a member, or looks on and speaks from
 * outside, in its turn */
bool presence_is_paced(const struct broker *b, uint32_t agent);

/** @return whether the agent lives beyond another broker */
bool presence_is_beyond(const struct broker *b, uint32_t agent);

/** Takes what a process says of one part of its agents. */
void presence_register(struct broker *b, const muster_Registration *r);

/** A process has taken back a part, or (crashed) nobody writes for it any more. */
void presence_gone(struct broker *b, uint32_t place, uint32_t part, bool crashed);

/** The agent is absent from now on; who waits for its name gets it. */
void presence_depart(struct broker *b, uint32_t agent);

/** An agent that is nowhere moves into a slot of a place. */
void presence_seat(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot,
                   const struct presence *is);

/** It goes from one place to another: what it has not acknowledged goes there again. */
void presence_move(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot,
                   const struct presence *is);

/** Its own place says something new of it. */
void presence_reregister(struct broker *b, uint32_t agent, uint32_t slot, struct presence *is);

/** An agent's state changes, and with it perhaps what it may be handed. */
void presence_set_state(struct broker *b, uint32_t agent, muster_State state);

/** The lock step has let go of a process: departures that it held up take place. */
void presence_settle(struct broker *b, uint32_t place);

/** Its bearer was lost with a broker, or is on its way to another platform, and may come by itself:
 * for a while newcomers wait. */
void presence_keep(struct broker *b, uint32_t agent);

/** Who has waited long enough for a name is given it, if nobody has it, and else refused. */
void presence_tick(struct broker *b);

/** @return when presence_tick is needed next, or UINT64_MAX */
uint64_t presence_deadline_ns(const struct broker *b);

/** The broker at which an agent lives, if it is another one, is to know after which number its box
 * goes on: it takes none that does not follow. */
void presence_tell_number(struct broker *b, uint32_t agent);

/** Whoever reads for a place may have missed what was written: all that stands is told again. */
void presence_tell_again(struct broker *b, uint32_t place);

#endif
