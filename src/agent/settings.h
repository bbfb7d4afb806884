/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file settings.h
 * What the command line of muster-robot says.
 */
#ifndef MUSTER_AGENT_SETTINGS_H
#define MUSTER_AGENT_SETTINGS_H

#include "agent/checkpoint.h"
#include "core/network.h"
#include "core/options.h"
#include "muster/limits.h"
#include "muster/result.h"

#include <stdbool.h>
#include <stdint.h>

struct settings {
    struct mu_network network;
    const char *name, *rules;
    const char *world; /* NULL: no map */
    int64_t count,
        first; /* of robots, and the number of the first; count 0: one, without a number */
    int64_t seed, firings_max, failures_max;
    int64_t mends_max;             /* of a mind that is broken; 0: it stays so */
    struct mu_option_list globals; /* "mate=red" */
    struct mu_option_list groups, services;
    struct checkpoint_settings checkpoints;
    bool diary, verbose, functions;
};

/* This option, for a program's table of options. */
#define SETTINGS_MEND_OPTION(set)                                                            \
    {                                                                                        \
        .name = "mend", .kind = MU_OPTION_INTEGER, .unit = "N", .fallback = "0",             \
        .help = "make a mind that broke, for want of memory, anew of its checkpoint or its " \
                "rules, so often at most; then the robot is suspended",                      \
        .target = &(set).mends_max, .max = 1000                                              \
    }

/**
 * Reads and checks the command line; what it says lives as long as the process.
 *
 * @return MU_OK; MU_DONE: help was asked for and given; MU_FAULT_USAGE: it has said what is wrong
 */
MU_MUST_USE mu_result settings_parse(const struct settings **set, int argc, char **argv);

/** @return how many robots are wanted */
uint32_t settings_robots(const struct settings *set);

/** The name of the index-th of them: the one that was given, or that with a number behind it. */
void settings_robot(const struct settings *set, uint32_t index, char name[MU_NAME_MAX + 1]);

/**
 * Takes a service's name off "mapper role=scout".
 *
 * @param name  MU_NAME_MAX + 2 bytes; longer than MU_NAME_MAX: no service has it
 * @return its attributes, in the same text
 */
const char *settings_service(const char *service, char name[MU_NAME_MAX + 2]);

#endif
