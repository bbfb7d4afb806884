/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file router.h
 * A mail's way: routed to the boxes of its receivers, acknowledged by each of them, or expired.
 */
#ifndef MUSTER_BROKER_ROUTER_H
#define MUSTER_BROKER_ROUTER_H

#include "broker/base/mailbox.h"

struct broker;

/** Puts an admitted mail on its way.  @return false if its sender may not send such a mail */
bool router_route(struct broker *b, struct mail *m);

/**
 * Goes on with a mail that need not wait for an address, or no longer.
 *
 * @param names  fields of content: whom SCHEME:REST stands for; NULL: nobody can tell
 * @return as router_route
 */
bool router_go_on(struct broker *b, struct mail *m, const char *names);

/** Routes the mails of a sender that wait for a resolver's answer no longer. */
void router_pump(struct broker *b, uint32_t sender);

/** Ends all waits for answers that are overdue, or all waits, and routes the mails that waited. */
void router_resolve_expire(struct broker *b, uint64_t mail_ns);
void router_resolve_give_up(struct broker *b);

/** Refuses an admitted mail for which a lock step has no more room. */
void router_turn_away(struct broker *b, struct mail *m);

/** Drops an admitted mail that is not to take effect; its sender is told. */
void router_drop(struct broker *b, struct mail *m);

/** A durable mail is on disk: its sender is told, if that is to be told. */
void router_stored(struct broker *b, struct mail *m);

/** A durable mail that cannot be on disk leaves all boxes; nothing of it has gone out. */
void router_undo(struct broker *b, struct mail *m);

/**
 * Puts a mail of an earlier life of the broker into its boxes.
 *
 * @param waiting  names of the receivers that have not settled it, joined by commas
 * @param left_ns  of its time to live
 * @return false: nobody has room for it, and it is freed
 */
bool router_restore(struct broker *b, struct mail *m, const char *waiting, uint64_t left_ns);

/** Sends a mail of the broker's own to an agent, as an answer; it takes of that agent's share. */
void router_post(struct broker *b, uint32_t receiver, const muster_Mail *letter);

/** @return whether the mail is for an agent in the lock step, or changes what is said of one */
bool router_meets_lockstep(struct broker *b, const struct mail *m);

/** The agent has taken everything up to that number. */
void router_acknowledge(struct broker *b, uint32_t agent, uint64_t number);

/** Admits mail that is due at this time of the run. */
void router_admit_due(struct broker *b, uint64_t run_ns);

/** Ends the wait of mail whose time to live is over. */
void router_expire(struct broker *b, uint64_t mail_ns);

/** @return what may be handed to the agent just now */
enum mailbox_gate router_gate(const struct broker *b, uint32_t agent);

#endif
