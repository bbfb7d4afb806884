/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world_load.h
 * Reads world files, and adds robots to them.
 */
#ifndef MUSTER_WORLD_LOAD_H
#define MUSTER_WORLD_LOAD_H

#include "world/model/world.h"

/* In the place of a path: a world in which nothing is. */
#define WORLD_NONE "none"

struct world_options {
    bool quiet;                               /* no warnings */
    uint64_t seed;                            /* of random places, where the file has none */
    const struct mu_fault_listener *listener; /* NULL: loading ends at the first mistake */
};

/**
 * Loads a world file in Stage's grammar (define, include, nested models, # comments) and units.
 *
 * Each unsupported property is named once, as a warning on standard error.  A listener hears these
 * instead, and every mistake; after a mistake the world cannot be used.
 *
 * @return MU_OK, or MU_FAULT_FILE with file, line, column and the expectation (with a listener: of
 * the last mistake)
 */
MU_MUST_USE mu_result world_open(struct world *world, const char *path,
                                 const struct world_options *options, struct mu_fault *fault);

/** Reads a file into a world that is open already: its memory is used again. */
MU_MUST_USE mu_result world_read(struct world *world, const char *path,
                                 const struct world_options *options, struct mu_fault *fault);

/** world_open with seed 1 and without a listener. */
MU_MUST_USE mu_result world_load(struct world *world, const char *path, bool quiet,
                                 struct mu_fault *fault);

/**
 * Adds a robot of a kind that the world file defines, or moves the robot of that name.
 *
 * @param body   a name from a `define` of the world file, derived from Stage's `position`;
 *               NULL: the robot must stand in the world file already
 * @param pose   where it starts; NULL: where the world file has it
 * @return MU_OK; MU_FAULT_FILE when the body is unknown, the name is taken by something else, or
 *         there is no room (fault->text says which; file is the world's)
 */
MU_MUST_USE mu_result world_add_robot(struct world *world, const char *name, const char *body,
                                      const struct world_pose *pose, const char *color,
                                      struct mu_fault *fault);

/** The same for `muster sim --place`: "NAME BODY X Y DEG COLOR", - for a default. */
MU_MUST_USE mu_result world_add_placed(struct world *world, const char *text,
                                       struct mu_fault *fault);

#endif
