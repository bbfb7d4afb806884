/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file worldfile.h
 * A world file as it is written: definitions, models and their properties, with their places.
 *
 * The grammar is Stage's:
 *
 *     file       = { "include" string | "define" name base "(" body ")" | statement }
 *     body       = { statement }
 *     statement  = key value | type "(" body ")"
 *     value      = number | string | word | "[" { number | string | word } "]"
 *
 * A `#` starts a comment.  Included paths are relative to the file that includes.  A definition
 * holds for what stands behind it; a later one of the same name replaces it.
 *
 * What a file may hold is bounded by one block of memory and by the limits below; beyond them it
 * is refused.
 */
#ifndef MUSTER_WORLD_WORLDFILE_H
#define MUSTER_WORLD_WORLDFILE_H

#include "core/fault.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    WORLDFILE_BYTES_MAX = 64 << 20, /* parsed text and, while it is read, a bitmap */
    WORLDFILE_TEXT_MAX = 8 << 20,   /* bytes of one file */
    WORLDFILE_INCLUDES_MAX = 256,   /* in all */
    WORLDFILE_FILES_MAX = 512,      /* with bitmaps */
    WORLDFILE_INCLUDE_DEPTH_MAX = 16,
    WORLDFILE_NESTING_MAX = 32,    /* models in models, as written */
    WORLDFILE_DERIVATION_MAX = 32, /* definitions that derive from definitions */
    WORLDFILE_DEFINITIONS_MAX = 1024,
    WORLDFILE_PROPERTIES_MAX = 2048, /* of one model, without what it derives from */
    WORLDFILE_TUPLE_MAX = 256,       /* values in [ ] */
    WORLDFILE_MISTAKES_MAX = 100     /* that a listener is told of */
};

struct worldfile_place {
    const char *file;
    int line, column;
};

struct worldfile_value {
    const char *text; /* NULL: a number */
    double number;
};

struct worldfile_property {
    const char *key; /* without its index */
    int index;       /* of point[3]: 3; -1: none */
    const struct worldfile_value *values;
    size_t value_count;
    struct worldfile_place at;
    struct worldfile_property *next;
};

struct worldfile_entity {
    const char *type;
    const char *defines;                 /* a definition: the name that it defines */
    const struct worldfile_entity *base; /* the definition that type names; NULL: none */
    int derivation;                      /* definitions below it */
    struct worldfile_property *properties, *last_property;
    size_t property_count;
    struct worldfile_entity *children, *last_child, *next;
    struct worldfile_place at;
};

/* Where a robot or a thing comes from. */
struct worldfile_origin {
    struct worldfile_place at;
    const char *type;
    const struct worldfile_entity *entity; /* NULL: the file has none */
    bool misplaced;                        /* where it stands could not be read */
};

struct device_ring; /* device.c */

struct world_file {
    char *bytes;
    size_t bytes_used;
    size_t include_count, definition_count;
    const char *files[WORLDFILE_FILES_MAX]; /* that were read, as they were opened, each once */
    size_t files_count;
    struct worldfile_entity root;         /* what stands outside all models */
    struct worldfile_entity *definitions; /* the latest first */
    struct worldfile_origin *origins;     /* of the robots of struct world, in their order */
    struct worldfile_origin *object_origins;
    struct device_ring *rings; /* of sonars, each once; the latest first */
    double box_m[4];           /* around all that is no robot: least x, least y, most x, most y */
    const struct mu_fault_listener *listener; /* NULL: the first mistake ends the parsing */
    size_t mistake_count;                     /* that it was told */
};

/** Takes the memory.  A file that is initialized can be parsed into again and again. */
void worldfile_init(struct world_file *file);

/** Forgets what was parsed, then reads and parses a file. */
MU_MUST_USE mu_result worldfile_parse(struct world_file *file, const char *path,
                                      struct mu_fault *fault);

/** The same for len bytes in memory; path stands in faults, and includes are relative to it. */
MU_MUST_USE mu_result worldfile_parse_text(struct world_file *file, const char *path,
                                           const char *text, size_t len, struct mu_fault *fault);

/** Takes zeroed bytes of the file's memory.  @return NULL when there is no room */
void *worldfile_take(struct world_file *file, size_t bytes);

/** @return the property of a model, from itself or what it derives from; NULL: it has none */
const struct worldfile_property *worldfile_property(const struct worldfile_entity *entity,
                                                    const char *key);

/** @return the type at the end of a model's derivation */
const char *worldfile_kind(const struct worldfile_entity *entity);

/** @return the latest definition of a name; NULL: none */
const struct worldfile_entity *worldfile_definition(const struct world_file *file,
                                                    const char *name);

/** Notes that a file was read, a bitmap; what is parsed is noted by itself. */
void worldfile_note(struct world_file *file, const char *path);

/** Makes a path that is relative to a file's folder.  @return whether it fitted */
MU_MUST_USE bool worldfile_path(const char *beside, const char *name, char *path, size_t size);

#endif
