/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file top_table.h
 * What `muster top` shows, as text and as JSON: no terminal, no clock.
 */
#ifndef MUSTER_CTL_TOP_TABLE_H
#define MUSTER_CTL_TOP_TABLE_H

#include "core/text.h"
#include "muster/stats.h"

#include <stdio.h>

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

/**
 * Puts robots in order: by name from a on, by a number from the highest down (nearest: up); equal
 * ones stay in the order of the world.
 *
 * @param order  out: indices, mu_stats_count of them
 */
void top_table_sort(const mu_stats *s, int column, size_t *order);

/** @return how many columns fit into so many characters; all of them when wide is 0 */
size_t top_table_columns(size_t wide);

/** Writes the heads of that many columns; the one that is sorted by has a star. */
void top_table_head(struct top_line *l, size_t columns, int sorted);

/** Writes a robot's line. */
void top_table_row(struct top_line *l, const mu_stats *s, size_t robot, size_t columns);

/** Writes what all robots came to, in the index-th of TOP_TEAM_LINES lines. */
enum { TOP_TEAM_LINES = 3 };
void top_table_team(struct top_line *l, const mu_stats *s, size_t index);

/** Says how a run ended. */
void top_table_end(struct top_line *l, const struct mu_run_result *result);

/** Writes one object for a robot. */
void top_table_json(FILE *to, const mu_stats *s, size_t robot);

/** Writes one object for the end of a run. */
void top_table_json_end(FILE *to, const mu_stats *s, const struct mu_run_result *result);

#endif
