/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file terminal.h
 * What verbs show on a terminal, and read from it.
 */
#ifndef MUSTER_CLI_TERMINAL_TERMINAL_H
#define MUSTER_CLI_TERMINAL_TERMINAL_H

#include "core/palette.h"
#include "core/text.h"
#include "muster/stats.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* --- the line editor of muster console -------------------------------------------------------- */

/*
 * A line editor on the terminal: history, completion, and a prompt that stays below what is printed
 * meanwhile.  The only file that sees libedit, which allocates on its own.
 */

/* What the editor asks of its console. */
struct console_edit_hooks {
    void *self;
    /** @return the prompt, valid until the next call; escape sequences stand between \1 and \1 */
    const char *(*prompt)(void *self);
    /** Waits until something is typed.  @return false: interrupted, or there is no more to do */
    bool (*wait)(void *self);
    /** @return the words for completion, as complete.c has them, up to date if that was possible */
    const char *(*words)(void *self);
};

struct console_edit;

/**
 * Begins with the history of earlier consoles of this user.
 *
 * @param hooks  stay the caller's, and must outlive the editor
 * @return NULL: the terminal cannot be edited on
 */
struct console_edit *console_edit_open(const struct console_edit_hooks *hooks);

/** Ends, and keeps the history. */
void console_edit_close(struct console_edit *e);

/** @return a line with its end, valid until the next call; NULL: the end of input, or no line */
const char *console_edit_line(struct console_edit *e);

/** Shows prompt and line again, after something was printed. */
void console_edit_refresh(struct console_edit *e);

/* --- the screen of muster top ----------------------------------------------------------------- */

/* A terminal that a table is drawn on again and again, and the keys that are typed there. */

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

/* --- its table -------------------------------------------------------------------------------- */

/* What `muster top` shows, as text and as JSON: no terminal, no clock. */

enum { TOP_LINE_MAX = 512 }; /* bytes of a line, with the zero */

/* A line as it is to be cut off for a terminal; names are made printable. */
struct top_line {
    char bytes[TOP_LINE_MAX];
    struct mu_text text;
};

/** @return the index of the column that bears a key, or -1 */
int top_table_key(const char *key);

/** @return the key of a column, counted round and round */
const char *top_table_key_of(int column);

/** Adds all keys, separated by commas, for help. */
void top_table_keys(struct mu_text *out);

/** @return how many rows there are: robots, and behind them agents without a body */
size_t top_table_rows(const mu_stats *s);

/**
 * Puts rows in order: by name from a on, by a number from the highest down (nearest: up); equal
 * ones stay in the order of the world, and what has no body, and so no such number, comes last.
 *
 * @param order  out: indices, top_table_rows of them
 */
void top_table_sort(const mu_stats *s, int column, size_t *order);

/** @return how many columns fit into so many characters; all of them when wide is 0 */
size_t top_table_columns(size_t wide);

/** Writes the heads of that many columns; the one that is sorted by has a star. */
void top_table_head(struct top_line *l, size_t columns, int sorted);

/** Writes the line of a robot or an agent. */
void top_table_row(struct top_line *l, const mu_stats *s, size_t row, size_t columns);

/** Writes what all robots came to, in the index-th of TOP_TEAM_LINES lines. */
enum { TOP_TEAM_LINES = 3 };
void top_table_team(struct top_line *l, const mu_stats *s, size_t index);

/** Says how a run ended. */
void top_table_end(struct top_line *l, const struct mu_run_result *result);

/** Writes one object for a robot or an agent. */
void top_table_json(FILE *to, const mu_stats *s, size_t row);

/** Writes one object for the end of a run. */
void top_table_json_end(FILE *to, const mu_stats *s, const struct mu_run_result *result);

#endif
