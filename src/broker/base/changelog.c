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

uint64_t changelog_version(const struct changelog *c, uint32_t line)
{
    return c->lines[line].version;
}

uint32_t changelog_after(const struct changelog *c, uint64_t version)
{
    uint32_t found = MU_NONE;
    for (uint32_t line = mu_list_last(&c->list);
         line != MU_NONE && c->lines[line].version > version;
         line = mu_list_prev(MU_LINKS(c->lines, link), line)) {
        found = line;
    }
    return found;
}

uint32_t changelog_next(const struct changelog *c, uint32_t line)
{
    return mu_list_next(MU_LINKS(c->lines, link), line);
}
