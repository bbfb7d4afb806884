/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file worldtool.h
 * What `muster world` does: with files, and with the world of a run that lives.
 */
#ifndef MUSTER_WORLDTOOL_WORLDTOOL_H
#define MUSTER_WORLDTOOL_WORLDTOOL_H

#include "core/network.h"
#include "core/options.h"
#include "world/model/world.h"

#include <stdbool.h>
#include <stdio.h>

/* --- world_files.c ---------------------------------------------------------------------------- */

/* What `muster world` does with files: check, draw, import. */

struct world_files_options {
    const char *file;
    const char *out; /* NULL: standard output */
    int64_t seed;    /* of random places */
    bool json;
};

/** Does what the words of `muster world` say of files.  @return the exit code, explained */
int world_files_run(const struct mu_options *o, struct world_files_options *options);

/** Writes a picture of a world as SVG.  @return MU_OK, or MU_FAULT_FILE for a bad world */
MU_MUST_USE mu_result world_files_draw(const struct world_files_options *options, FILE *to,
                                       struct mu_fault *fault);

/** Writes a world file that holds a map of ROS's map_server.  @return MU_OK or MU_FAULT_FILE */
MU_MUST_USE mu_result world_files_import_map(const struct world_files_options *options, FILE *to,
                                             struct mu_fault *fault);

/**
 * Writes a world of Stage anew: as one file, without what has no effect here.
 *
 * @return MU_OK or MU_FAULT_FILE
 */
MU_MUST_USE mu_result world_files_import_stage(const struct world_files_options *options, FILE *to,
                                               struct mu_fault *fault);

/**
 * Says how a picture is called in the file that is written: by its name if that stands in the same
 * folder, else by its whole path.
 *
 * @return whether it is there and its path is short enough
 */
bool world_import_picture(const struct world_files_options *options, const char *picture,
                          char *path, size_t size);

/* --- world_run.c ------------------------------------------------------------------------------ */

/* What `muster world` does to the world of a run that lives: place, push, reset, ... */

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
