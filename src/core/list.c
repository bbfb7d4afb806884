/* SPDX-License-Identifier: Apache-2.0 */
#include "core/list.h"

#include "muster/memory.h"
#include "muster/result.h"

bool mu_list_append(struct mu_list *l, struct mu_links links, uint32_t i)
{
    struct mu_link *link = mu_list_link(links, i);
    if (link->next != 0) {
        return false;
    }
    *link = (struct mu_link){.next = 1, .prev = l->last + 1};
    *(l->last ? &mu_list_link(links, l->last - 1)->next : &l->first) = l->last ? i + 2 : i + 1;
    l->last = i + 1;
    l->count++;
    return true;
}

bool mu_list_prepend(struct mu_list *l, struct mu_links links, uint32_t i)
{
    struct mu_link *link = mu_list_link(links, i);
    if (link->next != 0) {
        return false;
    }
    *link = (struct mu_link){.next = l->first + 1, .prev = 1};
    *(l->first ? &mu_list_link(links, l->first - 1)->prev : &l->last) = l->first ? i + 2 : i + 1;
    l->first = i + 1;
    l->count++;
    return true;
}

bool mu_list_remove(struct mu_list *l, struct mu_links links, uint32_t i)
{
    struct mu_link link = *mu_list_link(links, i);
    if (link.next == 0) {
        return false;
    }
    if (link.prev > 1) {
        mu_list_link(links, link.prev - 2)->next = link.next;
    } else {
        l->first = link.next - 1;
    }
    if (link.next > 1) {
        mu_list_link(links, link.next - 2)->prev = link.prev;
    } else {
        l->last = link.prev - 1;
    }
    *mu_list_link(links, i) = (struct mu_link){0};
    l->count--;
    return true;
}

uint32_t mu_list_take(struct mu_list *l, struct mu_links links)
{
    uint32_t first = mu_list_first(l);
    if (first != MU_NONE) {
        (void)mu_list_remove(l, links, first);
    }
    return first;
}

void mu_pool_init(struct mu_pool *p, uint32_t size)
{
    *p = (struct mu_pool){.size = size, .given = mu_startup_array(size, sizeof(uint32_t))};
}

uint32_t mu_pool_take(struct mu_pool *p)
{
    if (p->live == p->size) {
        return MU_NONE;
    }
    uint32_t given = p->used - p->live++;
    return given > 0 ? p->given[given - 1] : p->used++;
}

void mu_pool_give(struct mu_pool *p, uint32_t i)
{
    MU_ASSERT(p->live > 0 && i < p->used);
    p->given[p->used - p->live--] = i;
}
