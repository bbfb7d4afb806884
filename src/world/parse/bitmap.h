/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file bitmap.h
 * Floor plans as pictures: PNG, and PNM (P1, P2, P4, P5).  Dark is solid.
 */
#ifndef MUSTER_WORLD_BITMAP_H
#define MUSTER_WORLD_BITMAP_H

#include "world/parse/worldfile.h"

#include <stdint.h>

enum {
    BITMAP_SIDE_MAX = 16384,
    BITMAP_THRESHOLD = 127 /* Stage's */
};

/* What of a picture is solid: grey goes from 0, black, to 255, white. */
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

#endif
