/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file parser.h
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
#ifndef MUSTER_WORLD_PARSER_H
#define MUSTER_WORLD_PARSER_H

#include "core/fault.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

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
    WORLDFILE_TUPLE_MAX = 256        /* values in [ ] */
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
    struct mu_fault_place at;
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
    struct mu_fault_place at;
};

struct world_file {
    char *bytes;
    size_t bytes_used;
    size_t include_count, definition_count;
    const char *files[WORLDFILE_FILES_MAX]; /* that were read, as they were opened, each once */
    size_t files_count;
    struct worldfile_entity root;             /* the properties outside all models */
    struct worldfile_entity *definitions;     /* the latest first */
    const struct mu_fault_listener *listener; /* NULL: the first mistake ends the parsing */
    size_t mistake_count;                     /* that it was told */
};

/** Takes the memory.  A file that is initialized can be parsed into again and again. */
void worldfile_init(struct world_file *file);

/** Forgets an earlier parse, then reads and parses a file. */
MU_MUST_USE mu_result worldfile_parse(struct world_file *file, const char *path,
                                      struct mu_fault *fault);

/** The same for len bytes in memory; path stands in faults, and includes are relative to it. */
MU_MUST_USE mu_result worldfile_parse_text(struct world_file *file, const char *path,
                                           const char *text, size_t len, struct mu_fault *fault);

/** Takes zeroed bytes of the file's memory.  @return NULL when there is no room */
void *worldfile_take(struct world_file *file, size_t bytes);

/** @return the property of a model or of its base; NULL: it has none */
const struct worldfile_property *worldfile_property(const struct worldfile_entity *entity,
                                                    const char *key);

/** @return the type at the end of a model's derivation */
const char *worldfile_kind(const struct worldfile_entity *entity);

/** @return the latest definition of a name; NULL: none */
const struct worldfile_entity *worldfile_definition(const struct world_file *file,
                                                    const char *name);

/** Notes that a bitmap was read; parsed files are noted already. */
void worldfile_note(struct world_file *file, const char *path);

/** Makes a path that is relative to a file's folder.  @return whether it fitted */
MU_MUST_USE bool worldfile_path(const char *beside, const char *name, char *path, size_t size);

/* --- floor plans as pictures: PNG, and PNM (P1, P2, P4, P5); dark is solid --- */

enum {
    BITMAP_SIDE_MAX = 16384,
    BITMAP_THRESHOLD = 127 /* Stage's */
};

/* Which pixels are solid: grey goes from 0, black, to 255, white. */
struct bitmap_rule {
    double threshold; /* greys below it are solid */
    bool negate;      /* above 255 - threshold, instead */
};

struct bitmap {
    uint8_t *solid; /* one byte a pixel, row by row from the top; 1: solid */
    int width, height;
};

/* In pixels from the picture's left upper corner. */
struct bitmap_rectangle {
    int x, y, width, height;
};

/**
 * Reads a picture into the world file's memory.
 *
 * @return NULL, or why not
 */
const char *bitmap_read(struct bitmap *bitmap, const char *path, const struct bitmap_rule *rule,
                        struct world_file *memory);

/**
 * Takes one rectangle of solid pixels out of the picture: from the first solid pixel at or behind
 * *at on, as far as it goes right and then down, or down and then right, whichever is larger.
 *
 * @param at  in: where to look from, 0 at first; out: where to go on
 * @return false when no solid pixel is left
 */
bool bitmap_take_rectangle(struct bitmap *bitmap, size_t *at, struct bitmap_rectangle *out);

/* --- the properties of world files, one table: meaning, and owner -------------------------------
 * */

/* The owner of a property: a bit each. */
enum property_kind {
    PROPERTY_WORLD = 1,
    PROPERTY_SOLID = 2,
    PROPERTY_ROBOT = 4,
    PROPERTY_PART = 8, /* a model on a robot */
    PROPERTY_RANGER = 16,
    PROPERTY_SENSOR = 32,
    PROPERTY_CAMERA = 64,
    PROPERTY_FINDER = 128,
    PROPERTY_GRIPPER = 256,
    PROPERTY_BLOCK = 512,
    PROPERTY_DISTRIBUTE = 1024
};

/** @return whether a property is read there, or passed over because it concerns no robot */
bool properties_known(const char *key, enum property_kind kind);

/** @return whether a property is read there */
bool properties_read_there(const char *key, int kinds);

/** @return the property that was meant; NULL: none is near, or Stage has this very word */
const char *properties_near(const char *key, enum property_kind kind);

/** Prints the table as Markdown to standard output. */
void properties_print(void);

#endif
