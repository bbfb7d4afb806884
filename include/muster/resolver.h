/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file resolver.h
 * Agents that say whom an address SCHEME:REST stands for.
 *
 * A resolver offers the service `resolver` with the attribute scheme=SCHEME.  The broker asks the
 * first one in order of name, a mail of layer 2 to which the runtime answers, and delivers the mail
 * to those whom it names.  What is no address, and what is not answered within a second (in a lock
 * step: ten steps), is unknown-name.
 *
 * In a lock step those alone are asked that belong to it: set mu_process_options.watches.
 */
#ifndef MUSTER_RESOLVER_H
#define MUSTER_RESOLVER_H

#include "muster/agent.h"

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

typedef struct mu_resolution mu_resolution;

/* Says whom an address stands for; see mu_agent_resolve. */
typedef bool (*mu_resolve)(void *self, mu_agent *a, const char *rest, const char *sender,
                           mu_resolution *r);

/**
 * Makes an agent a resolver, of one scheme; a later call replaces it.
 *
 * @param resolve  says whom an address stands for, by mu_resolution_add; nobody is an answer, too.
 *                 It gets what stands behind the colon, and whose mail it is, whom the broker
 *                 leaves out.  It returns whether it is an address: if not, the sender is told
 *                 unknown-name.
 * @param self     its first argument
 * @return as mu_agent_advertise; MU_MALFORMED: the scheme is not a name
 */
MU_MUST_USE mu_result mu_agent_resolve(mu_agent *a, const char *scheme, mu_resolve resolve,
                                       void *self);

/**
 * Adds a name; one that nobody bears is skipped, one that is added again counts once.
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
