/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world_run.h
 * `muster world` on a run that lives: place, push, reset, sensor, pace, save.
 */
#ifndef MUSTER_CTL_WORLD_RUN_H
#define MUSTER_CTL_WORLD_RUN_H

#include "core/network.h"

#include <stdbool.h>
#include <stddef.h>

struct world_run_options {
    struct mu_network network;
    double wait_s, push_s;
    bool json;
};

/** @return whether that is a word of world_run */
bool world_run_knows(const char *word);

/** Carries out what the words say, of which world_run_knows the first.  @return the exit code */
int world_run(const char *const *words, size_t count, const struct world_run_options *set);

#endif
