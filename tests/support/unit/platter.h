/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file platter.h
 * A disk that is an array: what a broker's journal wrote to it is there in the broker's next life.
 */
#ifndef MUSTER_TESTS_PLATTER_H
#define MUSTER_TESTS_PLATTER_H

#include "broker/mail/mail.h"

#include <stdbool.h>
#include <stdint.h>

enum { PLATTER_ROWS = 2048, PLATTER_NAMES = 64, PLATTER_SLOTS = 256, PLATTER_TEXT = 128 };

/* A mail. */
struct platter_row {
    uint64_t row, expires_wall_ns;
    muster_Mail letter; /* its texts are void: those that are kept follow */
    char src[MU_NAME_MAX + 1], dst[PLATTER_TEXT], content[PLATTER_TEXT];
    char performative[MU_FIELD_MAX + 1], reply_with[MU_FIELD_MAX + 1];
    char waiting[2 * PLATTER_TEXT];
};

struct platter_name {
    char name[MU_NAME_MAX + 1];
    muster_Kind kind;
    uint64_t durable_seq, failed_seq, reserved_seq;
};

struct platter_line {
    struct line_word line; /* as for a row */
    char key[MU_NAME_MAX + 1], agent[MU_NAME_MAX + 1], origin[MU_NAME_MAX + 1];
    char attributes[PLATTER_TEXT];
};

struct platter {
    struct platter_row rows[PLATTER_ROWS]; /* in order of row */
    uint32_t rows_count;
    struct platter_name names[PLATTER_NAMES];
    uint32_t names_count;
    struct platter_line lines[LINES_KINDS][PLATTER_SLOTS]; /* no key: nothing is there */
    uint64_t run_wall_ns;
};

/**
 * Writes one entry of a commit.
 *
 * @return false: there is no room, or the entry makes no sense: a row that is there already, or
 *         one to be changed that is not
 */
bool platter_write(struct platter *p, const struct journal_entry *e);

/** Gives back all that was written, in the order in which durable_restore wants it. */
void platter_read(const struct platter *p, void (*restore)(const struct journal_entry *e));

#endif
