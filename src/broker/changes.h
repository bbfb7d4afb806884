/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file changes.h
 * Which lines of a table have changed since when: a list in order of change, to whose end a changed
 * line moves.  Who has seen all up to a version finds what is new without a look at the rest.
 *
 * Pure; lines are indices.  Memory of lines that never changed stays untouched.
 */
#ifndef MUSTER_BROKER_CHANGES_H
#define MUSTER_BROKER_CHANGES_H

#include <stdint.h>

struct change {
    uint64_t version;    /* of the table, when the line last changed; 0: never */
    uint32_t next, prev; /* MU_NONE: none */
};

struct changes {
    struct change *lines;
    uint32_t first, last;
    uint64_t version; /* of the last change */
};

/** Takes memory, at start-up, for that many lines. */
void changes_init(struct changes *c, uint32_t lines);

/** The line has changed now. */
void changes_touch(struct changes *c, uint32_t line);

/** @return the version at which the line last changed; 0: never */
uint64_t changes_version(const struct changes *c, uint32_t line);

/** @return the first line that changed after that version, or MU_NONE; costs a step a newer line */
uint32_t changes_after(const struct changes *c, uint64_t version);

/** @return the line that changed next after this one, or MU_NONE */
uint32_t changes_next(const struct changes *c, uint32_t line);

#endif
