/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file options.h
 * What the command line of muster-robot says.
 */
#ifndef MUSTER_AGENT_OPTIONS_H
#define MUSTER_AGENT_OPTIONS_H

#include "core/network.h"
#include "core/options.h"
#include "muster/limits.h"
#include "muster/result.h"

#include <stdbool.h>
#include <stdint.h>

/* What the command line says of checkpoints. */
struct checkpoint_options {
    double every_s;     /* 0: never */
    const char *folder; /* of the files */
    bool restore;       /* agents that have a file there come back */
};

/* These options, for a program's table of options. */
#define OPTIONS_CHECKPOINT(set)                                                                   \
    {.name = "checkpoint",                                                                        \
     .kind = MU_OPTION_REAL,                                                                      \
     .unit = "S",                                                                                 \
     .fallback = "0",                                                                             \
     .help = "write each agent to the folder every S seconds, when it comes, and when its state " \
             "changes; 0: never",                                                                 \
     .target = &(set).every_s,                                                                    \
     .max = 1e6},                                                                                 \
        {.name = "folder",                                                                        \
         .kind = MU_OPTION_STRING,                                                                \
         .unit = "DIR",                                                                           \
         .help = "where checkpoints are",                                                         \
         .target = &(set).folder},                                                                \
    {                                                                                             \
        .name = "restore", .kind = MU_OPTION_FLAG,                                                \
        .help = "bring back the agents that have a checkpoint there", .target = &(set).restore    \
    }

struct robot_options {
    struct mu_network network;
    const char *name, *rules;
    const char *world; /* NULL: no map */
    int64_t count,
        first; /* of robots, and the number of the first; count 0: one, without a number */
    int64_t seed, firings_max, failures_max;
    int64_t mends_max;             /* of a mind that is broken; 0: it stays so */
    struct mu_option_list globals; /* "mate=red" */
    struct mu_option_list groups, services;
    struct checkpoint_options checkpoints;
    bool diary, verbose, functions;
};

/* This option, for a program's table of options. */
#define OPTIONS_MEND(set)                                                                    \
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
MU_MUST_USE mu_result options_read(const struct robot_options **set, int argc, char **argv);

/** @return how many robots are wanted */
uint32_t options_robots(const struct robot_options *set);

/** The name of the index-th of them: the one that was given, or that with a number behind it. */
void options_robot(const struct robot_options *set, uint32_t index, char name[MU_NAME_MAX + 1]);

/** @return MU_OK, or MU_FAULT_USAGE: a folder is missing, and it has said so */
MU_MUST_USE mu_result options_check_checkpoints(const struct checkpoint_options *set,
                                                const char *program);

/**
 * Takes a service's name off "mapper role=scout".
 *
 * @param name  MU_NAME_MAX + 2 bytes; longer than MU_NAME_MAX: no service has it
 * @return its attributes, in the same text
 */
const char *options_service(const char *service, char name[MU_NAME_MAX + 2]);

#endif
