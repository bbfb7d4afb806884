/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"

void changelog_init(struct changelog *c, uint32_t capacity)
{
    *c = (struct changelog){.lines = mu_startup_array(capacity, sizeof *c->lines)};
}

void changelog_remove(struct changelog *c, uint32_t line)
{
    (void)mu_list_remove(&c->list, MU_LINKS(c->lines, link), line);
    c->lines[line].version = 0;
    (void)mu_list_prepend(&c->gone, MU_LINKS(c->lines, gone), line);
}

uint32_t changelog_gone(struct changelog *c)
{
    return mu_list_take(&c->gone, MU_LINKS(c->lines, gone));
}

void changelog_touch(struct changelog *c, uint32_t line)
{
    (void)mu_list_remove(&c->list, MU_LINKS(c->lines, link), line);
    (void)mu_list_append(&c->list, MU_LINKS(c->lines, link), line);
    c->lines[line].version = ++c->version;
}
