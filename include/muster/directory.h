/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file directory.h
 * Groups, and the yellow pages.
 *
 * Every process keeps a copy of both, as of the white pages: the broker pushes each change, so that
 * a question costs no round trip.  In lock step the copy changes only between steps.
 *
 * Changes are mails to the broker: they return at once, and take effect when the broker has them.
 * A refusal comes back to mu_handlers.on_refusal.
 *
 * Names of groups and services are those of agents: [A-Za-z_][A-Za-z0-9_.-]{0,30}.
 */
#ifndef MUSTER_DIRECTORY_H
#define MUSTER_DIRECTORY_H

#include "muster/agent.h"

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

/** Results of all changes: as mu_agent_send; MU_MALFORMED also for an invalid name. */

/** Makes a group without members.  The broker refuses it when the group is there. */
MU_MUST_USE mu_result mu_agent_group_create(mu_agent *a, const char *group);

/** Enters a group, and makes it if it is not there. */
MU_MUST_USE mu_result mu_agent_group_join(mu_agent *a, const char *group);

/** Leaves a group; a group that its last member leaves is gone. */
MU_MUST_USE mu_result mu_agent_group_leave(mu_agent *a, const char *group);

/** Sends content to all members but the sender; an absent member gets it when it is back. */
MU_MUST_USE mu_result mu_agent_group_send(mu_agent *a, const char *group, const char *content);

/** @return the index-th group in order of name, valid until the next spin; NULL past the last */
const char *mu_process_group(const mu_process *p, size_t index);

/** @return the index-th member of a group in order of name, likewise */
const char *mu_process_group_member(const mu_process *p, const char *group, size_t index);

/** @return whether the agent is a member of the group */
bool mu_process_in_group(const mu_process *p, const char *group, const char *agent);

/**
 * Offers a service; offering it again replaces the attributes and renews the lease.
 *
 * @param attributes  key=value, separated by spaces: "role=scout battery=0.8"; a value has at most
 *                    MU_FIELD_MAX bytes; NULL: none
 * @param lease_ns    how long it is offered unless it is renewed, a hundred years at most; 0: until
 *                    withdrawn.  In lock step by simulated time.
 * @return as all changes; MU_MALFORMED also of attributes or a lease that are not such
 */
MU_MUST_USE mu_result mu_agent_advertise(mu_agent *a, const char *service, const char *attributes,
                                         uint64_t lease_ns);

MU_MUST_USE mu_result mu_agent_withdraw(mu_agent *a, const char *service);

/**
 * A standing query: from now on mu_handlers.on_service hears of agents that come and go; agents
 * that are there already come first.  A change of attributes counts only if it changes the answer.
 *
 * @param query  a service, then constraints: "mapper role=scout battery>=0.5"; "*" is any service;
 *               near=X,Y,R: at most R metres from there, by the attributes x and y
 * It ends when the agent leaves.
 *
 * @return as all changes; MU_MALFORMED: no query; MU_FULL: MU_WATCHES_MAX are kept in this process;
 *         MU_REFUSED: the agent has left
 */
MU_MUST_USE mu_result mu_agent_watch_service(mu_agent *a, const char *query);

/**
 * @return the index-th line that fits, in order of service and agent, valid until the next spin;
 *         only agents that are not absent are found; NULL past the last, or the query is no query
 */
const struct mu_service *mu_process_find_service(const mu_process *p, const char *query,
                                                 size_t index);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
