/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file host_options.h
 * Options on the command line of muster-host.
 */
#ifndef MUSTER_HOST_OPTIONS_H
#define MUSTER_HOST_OPTIONS_H

#include "agent/robot.h"

struct host_options {
    const struct robot_options *robots; /* for each agent; its name is the host's */
    int64_t agents;                     /* that there is room for */
    int64_t bytes;                      /* of a snapshot, at most */
    struct mu_option_list take;         /* patterns of names; none: every name */
    struct mu_option_list natives;      /* "NAME=FILE": robots that begin here, and their rules */
    struct mu_option_list bodiless;     /* likewise: agents without a body */
    struct mu_option_list globals;      /* of such: "NAME.G=VALUE" */
};

/**
 * Reads and checks the command line.
 *
 * @param set  out: lives as long as the process
 * @return MU_OK; MU_DONE: help was printed; MU_FAULT_USAGE: the mistake was printed
 */
MU_MUST_USE mu_result host_options_read(const struct host_options **set, int argc, char **argv);

#endif
