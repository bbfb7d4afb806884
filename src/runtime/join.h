/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file join.h
 * Waiting for a broker as every program of ours does.
 */
#ifndef MUSTER_RUNTIME_JOIN_H
#define MUSTER_RUNTIME_JOIN_H

#include "core/network.h"
#include "muster/agent.h"

/**
 * Puts what the network says of sockets into the environment, where the library looks.
 *
 * @return what the network says of a process; all else is zero
 */
struct mu_process_options join_options(const struct mu_network *network, const char *name);

/**
 * Waits for a broker as long as the network's options say; says so after a second, and that none
 * answered.
 *
 * @param program  "muster robot"
 * @return what mu_process_await_broker says
 */
MU_MUST_USE mu_result join_await(mu_process *p, const struct mu_network *network,
                                 const char *program, int domain);

#endif
