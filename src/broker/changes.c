/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/changes.h"

#include "core/table.h"
#include "muster/memory.h"

void changes_init(struct changes *c, uint32_t lines)
{
    *c = (struct changes){.first = MU_NONE, .last = MU_NONE};
    c->lines = mu_startup_array(lines, sizeof *c->lines);
}

static void line_unlink(struct changes *c, const struct change *at)
{
    if (at->prev == MU_NONE) {
        c->first = at->next;
    } else {
        c->lines[at->prev].next = at->next;
    }
    if (at->next == MU_NONE) {
        c->last = at->prev;
    } else {
        c->lines[at->next].prev = at->prev;
    }
}

void changes_touch(struct changes *c, uint32_t line)
{
    struct change *at = &c->lines[line];
    if (at->version > 0) {
        line_unlink(c, at);
    }
    *at = (struct change){.version = ++c->version, .next = MU_NONE, .prev = c->last};
    if (c->last == MU_NONE) {
        c->first = line;
    } else {
        c->lines[c->last].next = line;
    }
    c->last = line;
}

uint64_t changes_version(const struct changes *c, uint32_t line)
{
    return c->lines[line].version;
}

uint32_t changes_after(const struct changes *c, uint64_t version)
{
    if (version == 0) {
        return c->first;
    }
    uint32_t after = MU_NONE;
    for (uint32_t i = c->last; i != MU_NONE && c->lines[i].version > version;
         i = c->lines[i].prev) {
        after = i;
    }
    return after;
}

uint32_t changes_next(const struct changes *c, uint32_t line)
{
    return c->lines[line].next;
}
