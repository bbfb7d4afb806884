/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

uint32_t claims_find(const struct claims *c, uint32_t first, uint32_t process)
{
    uint32_t index = first;
    while (index != MU_NONE && c->at[index].process != process) {
        index = c->at[index].behind;
    }
    return index;
}

/* @return where the index of a claim stands, in the chain of its name; MU_NONE: the chain's end */
static uint32_t *link_to(struct claims *c, uint32_t *first, uint32_t index)
{
    uint32_t *link = first;
    while (*link != index) {
        link = &c->at[*link].behind;
    }
    return link;
}

bool claims_add(struct claims *c, uint32_t *first, const struct claim *claim)
{
    uint32_t index = mu_pool_take(&c->pool);
    if (index == MU_NONE) {
        return false;
    }
    struct claim *at = &c->at[index];
    *at = *claim;
    at->behind = MU_NONE;
    at->link = (struct mu_link){0};
    *link_to(c, first, MU_NONE) = index;
    return mu_list_append(&c->list, MU_LINKS(c->at, link), index);
}

void claims_drop(struct claims *c, uint32_t *first, uint32_t index)
{
    *link_to(c, first, index) = c->at[index].behind;
    (void)mu_list_remove(&c->list, MU_LINKS(c->at, link), index);
    mu_pool_give(&c->pool, index);
}
