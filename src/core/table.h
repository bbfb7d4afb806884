/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file table.h
 * From a name to an index, in a table of fixed capacity: open addressing, linear probing.
 *
 * The memory is for all that fits in; of it a table uses as much as it needs, and twice as much
 * when that is two thirds full.  So a hundred names in a table for thousands touch two pages
 * instead of one each.
 */
#ifndef MUSTER_CORE_TABLE_H
#define MUSTER_CORE_TABLE_H

#include "muster/result.h"

#include <stdint.h>

/** No index. */
#define MU_NONE UINT32_MAX

struct mu_table_slot {
    const char *name; /* NULL: free */
    uint32_t hash;
    uint32_t index;
};

struct mu_table {
    struct mu_table_slot *slots;
    uint32_t mask;      /* slots in use less one; a power of two less one */
    uint32_t mask_most; /* when all are in use */
    uint32_t count;
    uint32_t capacity;
};

/** Takes the table's memory, at start-up; capacity from 1 to 2^30. */
void mu_table_init(struct mu_table *t, uint32_t capacity);

/**
 * Enters a name.  The table keeps the pointer: the name must stay where it is, unchanged, until
 * it is removed.
 *
 * @return MU_OK; MU_EXISTS: the name is there already, and stays as it was; MU_FULL
 */
mu_result mu_table_put(struct mu_table *t, const char *name, uint32_t index);

/** @return the index of a name, or MU_NONE */
uint32_t mu_table_find(const struct mu_table *t, const char *name);

/** @return MU_OK, or MU_ABSENT: there is no such name */
mu_result mu_table_remove(struct mu_table *t, const char *name);

#endif
