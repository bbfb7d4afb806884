/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file top_screen.h
 * A terminal that a table is drawn on again and again, and the keys that are typed there.
 */
#ifndef MUSTER_CTL_TOP_SCREEN_H
#define MUSTER_CTL_TOP_SCREEN_H

#include "core/palette.h"

#include <stdbool.h>
#include <stddef.h>

enum top_key {
    TOP_KEY_NONE, /* what is not one of these, or nothing */
    TOP_KEY_QUIT,
    TOP_KEY_SORT,
    TOP_KEY_SORT_BACK,
    TOP_KEY_UP,
    TOP_KEY_DOWN,
    TOP_KEY_PAGE_UP,
    TOP_KEY_PAGE_DOWN
};

/** Takes the terminal: another screen, keys as they are typed.  @return false: it is none */
bool top_screen_open(void);

/** Gives the terminal back as it was; nothing when it was not taken. */
void top_screen_close(void);

/** How large it is now. */
void top_screen_size(size_t *wide, size_t *high);

/** Begins a picture; lines are kept until top_screen_show. */
void top_screen_begin(void);

/** Adds a line, cut to the terminal's width.  @param lit  as a heading, unless NO_COLOR is set */
void top_screen_line(const char *text, bool lit);

/** Adds the line of a robot, its name, up to the first blank, in its colour. */
void top_screen_robot(const char *text, const struct palette_color *color);

void top_screen_show(void);

/** @return the next key that was typed, without waiting */
enum top_key top_screen_key(void);

#endif
