/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"

void changelog_init(struct changelog *c, uint32_t capacity)
{
    *c = (struct changelog){.first = MU_NONE, .last = MU_NONE};
    c->lines = mu_startup_array(capacity, sizeof *c->lines);
    c->gone = mu_startup_array(capacity, sizeof *c->gone);
}

static void line_unlink(struct changelog *c, uint32_t line)
{
    struct change *l = &c->lines[line];
    if (l->version == 0) {
        return;
    }
    l->version = 0;
    if (l->prev == MU_NONE) {
        c->first = l->next;
    } else {
        c->lines[l->prev].next = l->next;
    }
    if (l->next == MU_NONE) {
        c->last = l->prev;
    } else {
        c->lines[l->next].prev = l->prev;
    }
}

void changelog_remove(struct changelog *c, uint32_t line)
{
    line_unlink(c, line);
    if (!c->lines[line].gone) {
        c->lines[line].gone = true;
        c->gone[c->gone_count++] = line;
    }
}

uint32_t changelog_gone(struct changelog *c)
{
    if (c->gone_count == 0) {
        return MU_NONE;
    }
    uint32_t line = c->gone[--c->gone_count];
    c->lines[line].gone = false;
    return line;
}

void changelog_touch(struct changelog *c, uint32_t line)
{
    line_unlink(c, line);
    struct change *l = &c->lines[line];
    l->version = ++c->version;
    l->next = MU_NONE;
    l->prev = c->last;
    if (c->last == MU_NONE) {
        c->first = line;
    } else {
        c->lines[c->last].next = line;
    }
    c->last = line;
}

uint64_t changelog_version(const struct changelog *c, uint32_t line)
{
    return c->lines[line].version;
}

uint32_t changelog_after(const struct changelog *c, uint64_t version)
{
    uint32_t found = MU_NONE;
    for (uint32_t line = c->last; line != MU_NONE && c->lines[line].version > version;
         line = c->lines[line].prev) {
        found = line;
    }
    return found;
}

uint32_t changelog_next(const struct changelog *c, uint32_t line)
{
    return c->lines[line].next;
}
