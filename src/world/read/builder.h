/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file builder.h
 * Turns a parsed world into struct world.  Shared: properties with their checks, units, warnings,
 * frames.
 */
#ifndef MUSTER_WORLD_BUILDER_H
#define MUSTER_WORLD_BUILDER_H

#include "world/model/world.h"
#include "world/parse/parser.h"

enum {
    BUILDER_SHAPES_MAX = 65536,
    BUILDER_MODELS_MAX = 65536, /* with those that definitions bring along */
    BUILDER_NESTING_MAX = 32,
    BUILDER_WARNINGS_MAX = 128 /* further ones are not printed */
};

#define BUILDER_POSE_MAX_M 1e5 /* farther out, a millimetre gets lost in a raster */

/* Limits of a moving body, so that its inertia is a normal number. */
#define BUILDER_BODY_MIN_M 1e-3
#define BUILDER_BODY_MAX_M 1e3

struct builder {
    struct world *world;
    struct mu_fault *fault;
    const struct mu_fault_listener *listener; /* NULL: the first mistake ends the work */
    bool quiet;
    uint64_t seed;         /* of random places */
    double unit_length_m;  /* of the file's lengths */
    double unit_angle_deg; /* and angles */
    size_t model_count;
    struct builder_mistake {
        int line, column;
        uint64_t text;                 /* its hash */
    } mistakes[MU_FAULT_MISTAKES_MAX]; /* that the listener was told of */
    size_t mistake_count;
    bool ended;     /* a limit was passed: no more mistakes are looked for */
    bool misplaced; /* the body that was read last: where it stands is not known */
    const char *warned[BUILDER_WARNINGS_MAX];
    size_t warned_count;
};

/** Prints one warning about a word, the first time that it comes. */
void builder_warn(struct builder *b, const struct mu_fault_place *at, const char *word,
                  const char *what);

/**
 * Warns of the properties that a model of this kind has and muster does not know.
 *
 * For a listener, one that looks like a slip of the hand is a mistake.
 */
void builder_warn_unknown(struct builder *b, const struct worldfile_entity *entity,
                          enum property_kind kind);

/** Fills a fault at a place of the file.  @return MU_FAULT_FILE */
mu_result builder_fault(struct builder *b, const struct mu_fault_place *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** The same for a passed limit, which ends the work. */
mu_result builder_full(struct builder *b, const struct mu_fault_place *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/** Tells the listener, if there is one, of the fault that ended all. */
void builder_tell_end(struct builder *b);

/** Counts a model.  @return MU_OK, or MU_FAULT_FILE when there are too many or one is too deep */
MU_MUST_USE mu_result builder_count_model(struct builder *b, const struct worldfile_entity *entity,
                                          int depth);

/**
 * Passes a result on.  If a listener wants all mistakes, it hears of this one, and the work goes
 * on.
 *
 * @return MU_OK then, else the result
 */
MU_MUST_USE mu_result builder_go_on(struct builder *b, mu_result result);

/**
 * Warns of a model that Stage knows and muster does not.
 *
 * @return MU_OK, or MU_FAULT_FILE when Stage does not know it either
 */
MU_MUST_USE mu_result builder_skip_model(struct builder *b, const struct worldfile_entity *entity);

/**
 * Numbers of a property; an absent property leaves them as they are.
 *
 * units: one letter for each number: 'l' is a length, which becomes metres; 'a' is an angle, which
 * becomes degrees.  NULL, or a missing letter: a plain number
 */
struct builder_numbers {
    const char *key;
    double *to;
    size_t min, max;
    const char *units;
};

MU_MUST_USE mu_result builder_numbers(struct builder *b, const struct worldfile_entity *entity,
                                      struct builder_numbers wanted);

/** Reads one number between two limits, both included. */
MU_MUST_USE mu_result builder_number(struct builder *b, const struct worldfile_entity *entity,
                                     struct builder_numbers wanted, double min, double max);

/** Reads a whole number from 0 up to a limit. */
MU_MUST_USE mu_result builder_count(struct builder *b, const struct worldfile_entity *entity,
                                    const char *key, double max, uint32_t *to);

/** Reads 0 or another number as a truth. */
MU_MUST_USE mu_result builder_flag(struct builder *b, const struct worldfile_entity *entity,
                                   const char *key, bool *to);

/** Reads a text into *text; stays as it is where it is not given. */
MU_MUST_USE mu_result builder_text(struct builder *b, const struct worldfile_entity *entity,
                                   const char *key, const char **text);

/** Reads Stage's pose [x y z heading_deg], within a frame. */
MU_MUST_USE mu_result builder_pose(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_pose frame, struct world_pose *pose);

/** Reads Stage's size [x y z], which must be above 0. */
MU_MUST_USE mu_result builder_size(struct builder *b, const struct worldfile_entity *entity,
                                   double size_m[2]);

/** Checks the sides of a moving body. */
MU_MUST_USE mu_result builder_check_body(struct builder *b, const struct worldfile_entity *entity,
                                         double length_m, double width_m);

/** @return where a property stands, else where the model stands */
struct mu_fault_place builder_place(const struct worldfile_entity *entity, const char *key);

/** Visits the models inside a model, those of its base first. */
MU_MUST_USE mu_result builder_children(const struct worldfile_entity *entity,
                                       mu_result (*visit)(void *context,
                                                          const struct worldfile_entity *child),
                                       void *context);

/** Adds a static shape.  at: its model, for the fault when there is no room. */
MU_MUST_USE mu_result builder_add_shape(struct builder *b, const struct world_shape *shape,
                                        const struct mu_fault_place *at);

/** Reads how a model looks: its colour and its returns, with Stage's defaults. */
MU_MUST_USE mu_result look_read(struct builder *b, const struct worldfile_entity *entity,
                                struct world_look *look);

/** Reads a colour's name (X11) or "#rrggbb".  @return false when it is neither */
bool look_color(const char *text, uint32_t *rgb);

/** @return the name of an X11 colour that was meant; NULL: none is near */
const char *look_color_near(const char *text);

/** Builds the parts of a static model: its box, its blocks, its bitmap, its boundary. */
MU_MUST_USE mu_result solid_build(struct builder *b, const struct worldfile_entity *entity,
                                  struct world_pose pose);

/** @return whether a model at the top of the file is a thing that can be moved */
bool object_is(const struct worldfile_entity *entity);

/** Adds a thing that can be moved; without a name of its own it stays nameless. */
MU_MUST_USE mu_result object_build(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_pose pose);

/** Reads a robot's body; its name is "" where the file gives none. */
MU_MUST_USE mu_result body_read(struct builder *b, const struct worldfile_entity *entity,
                                struct world_pose frame, struct world_robot *robot);

/** Sets the first reading of a robot's odometer, which may depend on its pose. */
MU_MUST_USE mu_result body_read_start(struct builder *b, const struct worldfile_entity *entity,
                                      struct world_robot *robot);

/** Reads the devices of a robot: sensors, gripper, parts. */
MU_MUST_USE mu_result device_read_all(struct builder *b, const struct worldfile_entity *entity,
                                      struct world_robot *robot);

/** Puts robots and things at random free places, as each `distribute` of the file says. */
MU_MUST_USE mu_result distribute_all(struct builder *b);

#endif
