/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pairs.h
 * A set of pairs of names, such as (group, agent), of fixed capacity: found by hash, kept in order.
 *
 * Each pair has an index, under which the caller keeps what belongs to it; the index stays while
 * the pair is in the set.  Memory is touched only as it is used.
 */
#ifndef MUSTER_CORE_PAIRS_H
#define MUSTER_CORE_PAIRS_H

#include "core/table.h"
#include "muster/limits.h"

struct mu_pair {
    char first[MU_NAME_MAX + 1];
    char key[2 * MU_NAME_MAX + 2]; /* "first second": no name has a space in it */
    uint32_t free_next;
};

struct mu_pairs {
    struct mu_pair *at;
    uint32_t *order; /* indices in order of first, then second */
    uint32_t count;
    uint32_t capacity;
    uint32_t used; /* high-water mark of at */
    uint32_t free; /* list of indices given back */
    struct mu_table table;
};

/** Takes memory at start-up. */
void mu_pairs_init(struct mu_pairs *p, uint32_t capacity);

/** Both names are at most MU_NAME_MAX bytes long; second may be "".  @return index, or MU_NONE */
uint32_t mu_pairs_find(const struct mu_pairs *p, const char *first, const char *second);

/** Enters a pair that is not there.  @return its index, or MU_NONE: full */
uint32_t mu_pairs_add(struct mu_pairs *p, const char *first, const char *second);

void mu_pairs_remove(struct mu_pairs *p, uint32_t index);

const char *mu_pairs_first(const struct mu_pairs *p, uint32_t index);
const char *mu_pairs_second(const struct mu_pairs *p, uint32_t index);

/** @return the place in the order where the pairs with this first name begin, or would */
uint32_t mu_pairs_start(const struct mu_pairs *p, const char *first);

/** @return the index of the pair at that place, if first is its first name; else MU_NONE */
uint32_t mu_pairs_of(const struct mu_pairs *p, uint32_t place, const char *first);

#endif
