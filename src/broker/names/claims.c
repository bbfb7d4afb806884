/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

#include "muster/memory.h"

void claims_init(struct claims *c)
{
    *c = (struct claims){.free = MU_NONE, .first = MU_NONE, .last = MU_NONE};
    c->pool = mu_startup_array(CLAIMS_MAX, sizeof *c->pool);
}

uint32_t claims_find(const struct claims *c, uint32_t first, uint32_t process)
{
    uint32_t index = first;
    while (index != MU_NONE && c->pool[index].process != process) {
        index = c->pool[index].behind;
    }
    return index;
}

/* @return where the index of a claim stands, in the chain of its name; MU_NONE: the chain's end */
static uint32_t *link_to(struct claims *c, uint32_t *first, uint32_t index)
{
    uint32_t *link = first;
    while (*link != index) {
        link = &c->pool[*link].behind;
    }
    return link;
}

static uint32_t take_free(struct claims *c)
{
    uint32_t index = c->free;
    if (index != MU_NONE) {
        c->free = c->pool[index].next;
    } else if (c->used < CLAIMS_MAX) {
        index = c->used++;
    }
    return index;
}

bool claims_add(struct claims *c, uint32_t *first, const struct claim *claim)
{
    uint32_t index = take_free(c);
    if (index == MU_NONE) {
        return false;
    }
    struct claim *at = &c->pool[index];
    *at = *claim;
    at->behind = MU_NONE;
    at->next = MU_NONE;
    at->prev = c->last;
    *link_to(c, first, MU_NONE) = index;
    if (c->last == MU_NONE) {
        c->first = index;
    } else {
        c->pool[c->last].next = index;
    }
    c->last = index;
    c->count++;
    return true;
}

void claims_drop(struct claims *c, uint32_t *first, uint32_t index)
{
    struct claim *at = &c->pool[index];
    *link_to(c, first, index) = at->behind;
    if (at->prev == MU_NONE) {
        c->first = at->next;
    } else {
        c->pool[at->prev].next = at->next;
    }
    if (at->next == MU_NONE) {
        c->last = at->prev;
    } else {
        c->pool[at->next].prev = at->prev;
    }
    at->next = c->free;
    c->free = index;
    c->count--;
}
