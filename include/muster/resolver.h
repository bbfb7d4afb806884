/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file resolver.h
 * Agents that turn an address SCHEME:REST into names.
 *
 * A resolver offers the service `resolver` with the attribute scheme=SCHEME.  The broker asks the
 * first one in order of name, by a mail of layer 2 to which the runtime answers.  It delivers the
 * mail to the names in the answer.  An invalid address, and one without an answer within a second
 * (in a lock step: ten steps), is unknown-name.
 *
 * A lock step asks only resolvers that belong to it: set mu_process_options.watches.
 */
#ifndef MUSTER_RESOLVER_H
#define MUSTER_RESOLVER_H

#include "muster/agent.h"

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

typedef struct mu_resolution mu_resolution;

/* Turns an address into names; see mu_agent_resolve. */
typedef bool (*mu_resolve)(void *self, mu_agent *a, const char *rest, const char *sender,
                           mu_resolution *r);

/**
 * Makes an agent a resolver, of one scheme; a later call replaces it.
 *
 * @param resolve  adds names by mu_resolution_add; no name is an answer, too.  It gets the text
 *                 behind the colon, and the mail's sender, which the broker leaves out.  It
 *                 returns whether the address is valid: if not, the sender is told unknown-name.
 * @param self     its first argument
 * @return as mu_agent_advertise; MU_MALFORMED: the scheme is not a name
 */
MU_MUST_USE mu_result mu_agent_resolve(mu_agent *a, const char *scheme, mu_resolve resolve,
                                       void *self);

/**
 * Adds a name; one that no agent has is skipped, one that is added again counts once.
 *
 * @return MU_OK; MU_MALFORMED: not a name; MU_FULL: it is left out, because an answer is one mail,
 *         with room for 512 of the longest names
 */
mu_result mu_resolution_add(mu_resolution *r, const char *name);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
