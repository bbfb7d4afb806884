/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file host_settings.h
 * What the command line of muster-host says.
 */
#ifndef MUSTER_HOST_HOST_SETTINGS_H
#define MUSTER_HOST_HOST_SETTINGS_H

#include "agent/settings.h"

struct host_settings {
    struct settings robots;        /* what holds for each agent; its name is the host's */
    int64_t agents;                /* that there is room for */
    int64_t bytes;                 /* of a capsule, at most */
    struct mu_option_list take;    /* patterns of names; none: every name */
    struct mu_option_list natives; /* "NAME=FILE": agents that begin here, and their rules */
};

/**
 * Reads and checks the command line; what it says lives as long as the process.
 *
 * @return MU_OK; MU_DONE: help was asked for and given; MU_FAULT_USAGE: it has said what is wrong
 */
MU_MUST_USE mu_result host_settings_parse(const struct host_settings **set, int argc, char **argv);

#endif
