/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file json.h
 * Writes JSON: indented for files, or one object per line for `--json`.
 *
 *     struct mu_json j = mu_json_line(stdout);
 *     mu_json_string(&j, "name", name);
 *     mu_json_end(&j);
 *
 * Whatever bytes a string holds, the output is valid JSON in UTF-8.  Write errors stay with the
 * FILE (ferror) or the text (cut).
 */
#ifndef MUSTER_CORE_JSON_H
#define MUSTER_CORE_JSON_H

#include "core/text.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { MU_JSON_DEPTH_MAX = 16, MU_JSON_NUMBER_MAX = 32 };

enum mu_json_form { MU_JSON_LINE, MU_JSON_INDENTED };

struct mu_json {
    FILE *file; /* or NULL: */
    struct mu_text *text;
    enum mu_json_form form;
    unsigned depth;
    char close[MU_JSON_DEPTH_MAX]; /* what ends each open object or list */
    bool empty[MU_JSON_DEPTH_MAX]; /* nothing stands in it yet */
};

void mu_json_to_file(struct mu_json *j, FILE *file, enum mu_json_form form);
void mu_json_to_text(struct mu_json *j, struct mu_text *text, enum mu_json_form form);

/** Begins an object that is a line of its own; mu_json_end ends it. */
struct mu_json mu_json_line(FILE *file);

/* key: NULL inside a list and at the top.  Deeper than MU_JSON_DEPTH_MAX is a bug. */
void mu_json_object(struct mu_json *j, const char *key);
void mu_json_list(struct mu_json *j, const char *key);

/** Ends the innermost object or list; after the outermost one the line ends, too. */
void mu_json_end(struct mu_json *j);

/** Writes a string, or null for NULL.  Bytes that are no UTF-8 become U+FFFD. */
void mu_json_string(struct mu_json *j, const char *key, const char *value);
void mu_json_bool(struct mu_json *j, const char *key, bool value);
void mu_json_int(struct mu_json *j, const char *key, int64_t value);
void mu_json_uint(struct mu_json *j, const char *key, uint64_t value);

/** Writes a number that reads back as the same double; null when it is not finite. */
void mu_json_real(struct mu_json *j, const char *key, double value);

/** The shortest of 15 to 17 digits that reads back as the same double; value must be finite. */
void mu_json_number(char number[MU_JSON_NUMBER_MAX], double value);

#endif
