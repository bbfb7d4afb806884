/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world_run.h
 * What `muster world` does to the world of a run that lives: place, push, reset, ...
 */
#ifndef MUSTER_CTL_WORLD_RUN_H
#define MUSTER_CTL_WORLD_RUN_H

#include "core/network.h"
#include "core/options.h"

struct world_run_options {
    struct mu_network network; /* domain < 0: the one live run's, else 0 */
    double wait_s;             /* for the simulator's answer; < 0: 5 s, or as long as it waits */
    double push_s;             /* that a push lasts; 0: it is an impulse */
    double at_s;               /* time of the run before which it is not done; < 0: at once */
    const char *when;          /* a condition before which it is not; NULL: none */
    bool json;
};

/** @return whether that is a word of it */
bool world_run_knows(const char *word);

/** Sends the order that the words of `muster world` say.  @return the exit code, explained */
int world_run(const struct mu_options *o, const struct world_run_options *options);

#endif
