/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

uint32_t claims_find(const struct claims *c, const struct mu_list *of, uint32_t process)
{
    uint32_t index = mu_list_first(of);
    while (index != MU_NONE && c->at[index].process != process) {
        index = mu_list_next(MU_LINKS(c->at, behind), index);
    }
    return index;
}

bool claims_add(struct claims *c, struct mu_list *of, const struct claim *claim)
{
    uint32_t index = mu_pool_take(&c->pool);
    if (index == MU_NONE) {
        return false;
    }
    c->at[index] = *claim;
    c->at[index].behind = c->at[index].link = (struct mu_link){0};
    (void)mu_list_append(of, MU_LINKS(c->at, behind), index);
    return mu_list_append(&c->list, MU_LINKS(c->at, link), index);
}

void claims_drop(struct claims *c, struct mu_list *of, uint32_t index)
{
    (void)mu_list_remove(of, MU_LINKS(c->at, behind), index);
    (void)mu_list_remove(&c->list, MU_LINKS(c->at, link), index);
    mu_pool_give(&c->pool, index);
}
