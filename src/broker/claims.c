/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/claims.h"

#include "muster/memory.h"

void claims_init(struct claims *c)
{
    *c = (struct claims){.free = MU_NONE, .first = MU_NONE, .last = MU_NONE};
    c->pool = mu_startup_array(REGISTRY_MAX, sizeof *c->pool);
}

uint32_t claims_add(struct claims *c, const struct claim *claim)
{
    uint32_t index = c->free;
    if (index != MU_NONE) {
        c->free = c->pool[index].next;
    } else {
        index = c->used++;
        MU_ASSERT(index < REGISTRY_MAX);
    }
    struct claim *at = &c->pool[index];
    *at = *claim;
    at->next = MU_NONE;
    at->prev = c->last;
    if (c->last == MU_NONE) {
        c->first = index;
    } else {
        c->pool[c->last].next = index;
    }
    c->last = index;
    c->count++;
    return index;
}

void claims_drop(struct claims *c, uint32_t index)
{
    struct claim *at = &c->pool[index];
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
