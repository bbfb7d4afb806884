/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

#include "core/text.h"

struct grave *graveyard_find(struct graveyard *g, const char *name)
{
    uint32_t at = mu_table_find(&g->names, name);
    return at != MU_NONE ? &g->ring[at] : NULL;
}

static void grave_clear(struct graveyard *g, struct grave *grave)
{
    if (grave->name[0] != '\0') {
        (void)mu_table_remove(&g->names, grave->name);
        grave->name[0] = '\0';
    }
}

struct grave *graveyard_add(struct graveyard *g, const char *name)
{
    uint32_t at = g->next;
    struct grave *grave = &g->ring[at];
    g->next = (at + 1) % GRAVES_MAX;
    grave_clear(g, grave);
    *grave = (struct grave){.name = ""};
    bool fits = mu_text_copy(grave->name, sizeof grave->name, name);
    MU_ASSERT(fits && mu_table_put(&g->names, grave->name, at) == MU_OK);
    return grave;
}

void graveyard_bury(struct graveyard *g, const struct agent *a)
{
    struct grave *grave = graveyard_add(g, a->name);
    grave->saved_kind = a->saved_kind;
    grave->seq = a->seq;
}

void graveyard_raise(struct graveyard *g, struct agent *a)
{
    struct grave *grave = graveyard_find(g, a->name);
    if (!grave) {
        return;
    }
    a->saved_kind = grave->saved_kind;
    a->seq = grave->seq;
    grave_clear(g, grave);
}
