/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file changes.h
 * The lines of a table in order of their last change: who remembers the version that it has had
 * finds what is new to it without looking at the rest.
 */
#ifndef MUSTER_BROKER_CHANGES_H
#define MUSTER_BROKER_CHANGES_H

#include "core/table.h"

#include <stdbool.h>

struct change {
    uint64_t version;    /* 0: not in the list */
    uint32_t next, prev; /* the next one has the higher version */
    bool gone;           /* in the list of those that are no more */
};

struct changes {
    struct change *lines; /* one for each line of the table */
    uint32_t first, last; /* the oldest, the youngest */
    uint64_t version;     /* of the last change; the first is 1 */
    uint32_t *gone;       /* lines that are no more, until changes_gone has told of them */
    uint32_t gone_count;
};

/** Takes memory at start-up. */
void changes_init(struct changes *c, uint32_t capacity);

/** A line has changed, or is new: it is now the youngest. */
void changes_touch(struct changes *c, uint32_t line);

/** @return the version at which the line last changed; 0: never, or it is no more */
uint64_t changes_version(const struct changes *c, uint32_t line);

/** A line is no more; changes_gone tells of that, and nothing else does. */
void changes_remove(struct changes *c, uint32_t line);

/** @return a line that is no more, or was not for a while, each once; or MU_NONE */
uint32_t changes_gone(struct changes *c);

/** @return the oldest line that changed after that version, or MU_NONE; costs O(changes since) */
uint32_t changes_after(const struct changes *c, uint64_t version);

/** @return the line that changed next after this one, or MU_NONE */
uint32_t changes_next(const struct changes *c, uint32_t line);

#endif
