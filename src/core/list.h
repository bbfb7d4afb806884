/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file list.h
 * Lists of elements of an array, and pools of such elements.  Both know elements by their index.
 *
 *     struct mu_links links = MU_LINKS(boxes, watch);
 *     mu_list_append(&watched, links, 7);
 */
#ifndef MUSTER_CORE_LIST_H
#define MUSTER_CORE_LIST_H

#include "core/table.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* An element's place in a list: the index of a neighbour, and 2; 1: there is none; 0: the element
 * is in no list. */
struct mu_link {
    uint32_t next, prev;
};

/* Zeroed memory is an empty list.  Its ends: an index, and 1. */
struct mu_list {
    uint32_t first, last, count;
};

/* The links of an array's elements. */
struct mu_links {
    struct mu_link *first;
    size_t stride; /* from one to the next, in bytes */
};

/* A list is told apart from the elements that stand in it: these may be constant. */
#define MU_LINKS(array, member) \
    ((struct mu_links){(struct mu_link *)(uintptr_t) & (array)[0].member, sizeof(array)[0]})

static inline struct mu_link *mu_list_link(struct mu_links links, uint32_t i)
{
    return (struct mu_link *)(void *)((char *)links.first + i * links.stride);
}

/** @return whether the element is in a list */
static inline bool mu_list_has(struct mu_links links, uint32_t i)
{
    return mu_list_link(links, i)->next != 0;
}

/** @return the first element, the last one, that behind or before one; or MU_NONE */
static inline uint32_t mu_list_first(const struct mu_list *l)
{
    return l->first - 1;
}

static inline uint32_t mu_list_last(const struct mu_list *l)
{
    return l->last - 1;
}

static inline uint32_t mu_list_next(struct mu_links links, uint32_t i)
{
    uint32_t next = mu_list_link(links, i)->next;
    return next > 1 ? next - 2 : MU_NONE;
}

static inline uint32_t mu_list_prev(struct mu_links links, uint32_t i)
{
    uint32_t prev = mu_list_link(links, i)->prev;
    return prev > 1 ? prev - 2 : MU_NONE;
}

/** Goes through a list; none may leave it meanwhile. */
#define MU_LIST_EACH(i, list, links) \
    for (uint32_t i = mu_list_first(list); (i) != MU_NONE; (i) = mu_list_next(links, i))

/** Puts an element last, or first.  @return false: it is in a list already */
bool mu_list_append(struct mu_list *l, struct mu_links links, uint32_t i);
bool mu_list_prepend(struct mu_list *l, struct mu_links links, uint32_t i);

/** Takes an element out of its list.  @return false: it is in none */
bool mu_list_remove(struct mu_list *l, struct mu_links links, uint32_t i);

/** Takes the first element out.  @return MU_NONE: the list is empty */
uint32_t mu_list_take(struct mu_list *l, struct mu_links links);

/* --- pools ------------------------------------------------------------------------------------ */

/* Which elements of an array are in use.  Those that were never used are not touched. */
struct mu_pool {
    uint32_t *given; /* those given back, the last one on top */
    uint32_t size;
    uint32_t used; /* elements ever in use */
    uint32_t live; /* elements in use */
};

/** Takes memory at start-up. */
void mu_pool_init(struct mu_pool *p, uint32_t size);

/** @return an element that is free, the one given back last first; MU_NONE: there is none */
uint32_t mu_pool_take(struct mu_pool *p);

void mu_pool_give(struct mu_pool *p, uint32_t i);

#endif
