/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file builder.h
 * What the files that turn a parsed world into struct world share: properties with their checks,
 * warnings, frames.
 */
#ifndef MUSTER_WORLD_BUILDER_H
#define MUSTER_WORLD_BUILDER_H

#include "world/world.h"
#include "world/worldfile.h"

enum {
    BUILDER_SHAPES_MAX = 65536,
    BUILDER_MODELS_MAX = 65536, /* with those that definitions bring along */
    BUILDER_NESTING_MAX = 32,
    BUILDER_WARNINGS_MAX = 128 /* further ones are not printed */
};

#define BUILDER_POSE_MAX_M 1e5 /* farther out, a millimetre gets lost in a raster */

/* What a property belongs to: a bit each. */
enum builder_kind {
    BUILDER_WORLD = 1,
    BUILDER_SOLID = 2,
    BUILDER_ROBOT = 4,
    BUILDER_RANGER = 8,
    BUILDER_SENSOR = 16,
    BUILDER_BLOCK = 32
};

struct builder {
    struct world *world;
    struct mu_fault *fault;
    bool quiet;
    size_t model_count;
    const char *warned[BUILDER_WARNINGS_MAX];
    size_t warned_count;
};

/** Prints one warning about a word, the first time that it comes. */
void builder_warn(struct builder *b, const struct worldfile_place *at, const char *word,
                  const char *what);

/** Warns of the properties that a model of this kind has and muster does not know. */
void builder_warn_unknown(struct builder *b, const struct worldfile_entity *entity,
                          enum builder_kind kind);

/** Fills a fault at a place of the file.  @return MU_FAULT_FILE */
mu_result builder_fault(struct builder *b, const struct worldfile_place *at, const char *format,
                        ...) __attribute__((format(printf, 3, 4)));

/**
 * Warns of a model that Stage knows and muster does not.
 *
 * @return MU_OK, or MU_FAULT_FILE when Stage does not know it either
 */
MU_MUST_USE mu_result builder_skip_model(struct builder *b, const struct worldfile_entity *entity);

/** How many numbers a property has; where it is not given, they stay as they are. */
struct builder_numbers {
    const char *key;
    double *to;
    size_t min, max;
};

MU_MUST_USE mu_result builder_numbers(struct builder *b, const struct worldfile_entity *entity,
                                      struct builder_numbers wanted);

/** Reads a text into *text; stays as it is where it is not given. */
MU_MUST_USE mu_result builder_text(struct builder *b, const struct worldfile_entity *entity,
                                   const char *key, const char **text);

/** Reads Stage's pose [x y z heading_deg], within a frame. */
MU_MUST_USE mu_result builder_pose(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_pose frame, struct world_pose *pose);

/** Reads Stage's size [x y z]; refuses what is not above 0. */
MU_MUST_USE mu_result builder_size(struct builder *b, const struct worldfile_entity *entity,
                                   double size_m[2]);

/** @return where a property stands, else where the model stands */
struct worldfile_place builder_place(const struct worldfile_entity *entity, const char *key);

/** @return the pose, given in a frame, in the frame's own frame; heading in (-pi, pi] */
struct world_pose world_pose_in(struct world_pose frame, struct world_pose pose);

/** Visits the models inside a model: first those of what it derives from. */
MU_MUST_USE mu_result builder_children(const struct worldfile_entity *entity,
                                       mu_result (*visit)(void *context,
                                                          const struct worldfile_entity *child),
                                       void *context);

/** Adds a static shape.  at: whose it is, for the fault when there is no room. */
MU_MUST_USE mu_result builder_add_shape(struct builder *b, const struct world_shape *shape,
                                        const struct worldfile_place *at);

/** Builds what a static model is made of: its box, its blocks, its bitmap, its boundary. */
MU_MUST_USE mu_result solid_build(struct builder *b, const struct worldfile_entity *entity,
                                  struct world_pose pose);

/** Reads a robot's body; its name is "" where the file gives none. */
MU_MUST_USE mu_result body_read(struct builder *b, const struct worldfile_entity *entity,
                                struct world_pose frame, struct world_robot *robot);

/** Does the work of world_robot_fits. */
bool place_fits(const struct world *world, size_t robot, double clear_m);

/** Does the work of world_check_places. */
MU_MUST_USE mu_result place_check(const struct world *world, struct mu_fault *fault);

#endif
