/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file kind.h
 * Layers of mail, and kinds of agents that take them.
 *
 * A kind names its parent and defines only what differs.  A mail of layer L goes to the kind's own
 * handlers for L and its performative, in the order of their table, then to its parent's, until one
 * takes it.  A mail that no kind takes goes to mu_handlers.on_mail, if the agent has one; else it
 * is answered `not-understood`, unless it was for many, or was itself an answer.  Layers are
 * numbers: a new one needs a handler and nothing else.  A directive never comes here: the runtime
 * carries it out.
 *
 * Kinds (struct mu_agent_kind, agent.h) are constant and outlive their agents; self is
 * mu_handlers.self.
 */
#ifndef MUSTER_KIND_H
#define MUSTER_KIND_H

#include "muster/agent.h"

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

/**
 * The behaviour that every agent has.
 *
 * Layer 1: suspend, resume and dispose are granted, and answered `agree`, where the agent's state
 * allows them and it is not of MU_KIND_SPECIAL; they are refused else.  dispatch, retract and clone
 * are refused: `no-mobility` (a robot with rules grants them).  Mail waits for a suspended agent, a
 * request to resume, too: the directive does not.  Layer 2: the questions `state`, `groups` and
 * `services` are answered with `inform`: `state running`, `groups north scouts`, `services map`.
 */
extern const struct mu_agent_kind mu_base_kind;

/** Makes an agent one of a kind; until then it is of mu_base_kind.  Call it before it spins.  A
 * kind that is its own ancestor is a bug, and ends the program. */
void mu_agent_be(mu_agent *a, const struct mu_agent_kind *kind);

/**
 * Enters an agent that has lived elsewhere, or is a copy of one: as mu_agent_join, in the state
 * MU_MOVING until it is accepted and its owner sets another.
 *
 * @param from   how far it had come, and its kind; NULL: a robot that has taken no mail
 * @param event  what happens when it is accepted: MU_ON_ARRIVE, MU_ON_CLONE, or MU_ON_CREATE
 * @return as mu_agent_join; MU_MALFORMED also for an invalid event
 */
MU_MUST_USE mu_result mu_agent_arrive(mu_process *p, mu_agent **out, const char *name,
                                      const struct mu_passage *from, enum mu_event event,
                                      const struct mu_handlers *handlers);

/**
 * In a handler of a kind: asks its parent.
 *
 * @return the parent's result; MU_PASS also when no handler took it, and outside of a kind's
 * handler
 */
enum mu_take mu_agent_take_parent(mu_agent *a, const struct mu_mail *mail);

/** In a hook of a kind: calls the parent's, if there is one; outside of a hook, nothing. */
void mu_agent_event_parent(mu_agent *a);

/**
 * Answers a mail: to its sender, in its layer, conversation, language and ontology; in-reply-to is
 * its reply-with, or its number (seq) when it has none.
 *
 * @return as mu_agent_send; MU_REFUSED: it is itself an answer, and asks for none by a reply-with,
 *         so that two agents do not answer each other for ever; MU_TIMEOUT: the step at hand is
 *         past its reply_by_ns.  Nothing is sent then.
 */
MU_MUST_USE mu_result mu_agent_reply(mu_agent *a, const struct mu_mail *mail,
                                     const char *performative, const char *content);

/** @return whether KQML or FIPA know that performative; others are sent all the same */
bool mu_performative_known(const char *performative);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
