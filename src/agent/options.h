/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file options.h
 * Options on the command lines of muster-robot and of other programs that have robots.
 */
#ifndef MUSTER_AGENT_OPTIONS_H
#define MUSTER_AGENT_OPTIONS_H

#include "core/network.h"
#include "core/options.h"
#include "muster/agent.h"
#include "muster/limits.h"
#include "muster/result.h"

#include <stdbool.h>
#include <stdint.h>

/* The options of checkpoints. */
struct checkpoint_options {
    double every_s;     /* 0: never */
    const char *folder; /* of the files */
    bool restore;       /* agents with a file there come back */
};

struct robot_options {
    struct mu_network network;
    const char *program; /* for messages: "muster robot" */
    enum mu_kind kind;   /* robots, or agents that are none */
    const char *name, *rules;
    const char *world; /* NULL: no map */
    int64_t count,
        first; /* robots, and the number of the first; count 0: one robot, without a number */
    int64_t seed, firings_max, failures_max;
    int64_t mends_max;             /* how often a broken mind is made anew; 0: never */
    struct mu_option_list globals; /* "mate=red" */
    struct mu_option_list groups, services;
    struct checkpoint_options checkpoints;
    bool diary, verbose, functions, standby;
    bool awaits_run; /* no step but those of a simulator */
};

/**
 * Parses the command line of a program that has robots: its own rows, behind those that all such
 * programs have.
 *
 * @param program  table: its own rows; the only word is the name
 * @param out      lives as long as the process; name NULL: there is not one word
 * @return as mu_options_parse
 */
MU_MUST_USE mu_result options_parse(struct mu_options *program, int argc, char **argv,
                                    const struct robot_options **out);

/**
 * Reads and checks the command line of muster-robot.
 *
 * @param set  out: lives as long as the process
 * @return MU_OK; MU_DONE: help was printed; MU_FAULT_USAGE: the mistake was printed
 */
MU_MUST_USE mu_result options_read(const struct robot_options **set, int argc, char **argv);

/** @return how many robots the process has */
uint32_t options_robots(const struct robot_options *set);

/** Writes the name of the index-th robot: NAME, or NAME_NUMBER if there are several. */
void options_robot(const struct robot_options *set, uint32_t index, char name[MU_NAME_MAX + 1]);

/** @return MU_OK, or MU_FAULT_USAGE: the folder is missing, which was printed */
MU_MUST_USE mu_result options_check_checkpoints(const struct checkpoint_options *set,
                                                const char *program);

/**
 * Splits "mapper role=scout".
 *
 * @param name  out: the service; longer than MU_NAME_MAX: it is not valid
 * @return its attributes, in the same text
 */
const char *options_service(const char *service, char name[MU_NAME_MAX + 2]);

#endif
