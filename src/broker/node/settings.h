/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file settings.h
 * What the command line of muster-broker says.
 */
#ifndef MUSTER_BROKER_SETTINGS_H
#define MUSTER_BROKER_SETTINGS_H

#include "core/network.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

struct settings {
    struct mu_network network;
    bool verbose, counters;
    double delivery_interval_ms;
    const char *policy, *audit; /* files; NULL: none */
    const char *store;          /* a file; "none"; NULL: the usual one */
    int64_t box_mails, box_bytes;
    const char *box_policy_word;
    muster_BoxPolicy box_policy;
};

/** @return MU_EXIT_DONE: go on; else the exit code.  name: out; NULL: there is nothing to do */
int settings_read(struct settings *s, const char **name, int argc, char **argv);

#endif
