/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world_files.h
 * What `muster world` does with files: check, draw, import.
 */
#ifndef MUSTER_CTL_WORLD_FILES_H
#define MUSTER_CTL_WORLD_FILES_H

#include "core/options.h"
#include "world/model/world.h"

#include <stdbool.h>
#include <stdio.h>

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

#endif
