/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/session/guests.h"

#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

struct guests *guests_open(void)
{
    struct guests *g = mu_startup_alloc(sizeof *g);
    g->at = mu_startup_array(MU_AGENTS_MAX, sizeof *g->at);
    g->coming = mu_startup_array(MU_CAPSULES_MAX, sizeof *g->coming);
    return g;
}

/* @return the index of the first one whose name is not before this one */
static uint32_t place_of(const struct guests *g, const char *name)
{
    uint32_t low = 0, high = g->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (strcmp(g->at[middle].name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

struct guest *guests_find(const struct guests *g, const char *name)
{
    uint32_t at = place_of(g, name);
    return at < g->count && strcmp(g->at[at].name, name) == 0 ? &g->at[at] : NULL;
}

mu_result guests_seat(struct guests *g, const char *name, int32_t process)
{
    struct guest *known = guests_find(g, name);
    if (known && known->state != muster_STATE_ABSENT && known->process < 0) {
        known->process = process; /* the one that it set out from has died */
        return MU_OK;
    }
    if (known && known->state != muster_STATE_ABSENT) {
        known->next_process = process;
        return MU_OK;
    }
    if (g->coming_count == MU_CAPSULES_MAX || g->count + g->coming_count >= MU_AGENTS_MAX) {
        return MU_FULL;
    }
    struct guest *coming = &g->coming[g->coming_count++];
    *coming = (struct guest){.process = process, .next_process = -1};
    mu_text_copy(coming->name, sizeof coming->name, name);
    return MU_OK;
}

static void guest_insert(struct guests *g, const struct guest *coming)
{
    uint32_t at = place_of(g, coming->name);
    memmove(&g->at[at + 1], &g->at[at], (g->count - at) * sizeof *g->at);
    g->at[at] = *coming;
    g->count++;
}

static void guest_renumber(struct guest *guest, int32_t from, int32_t to)
{
    bool moves = guest->next_process >= 0;
    if (to < 0 && (moves ? guest->next_process : guest->process) == from) {
        guest->process = guest->next_process = -1;
        return;
    }
    if (to < 0 && guest->process == from) {
        guest->process = guest->next_process;
    }
    guest->process = guest->process == from ? to : guest->process;
    guest->next_process = guest->next_process == from ? to : guest->next_process;
}

void guests_renumber(struct guests *g, int32_t from, int32_t to)
{
    for (uint32_t i = 0; i < g->count; i++) {
        guest_renumber(&g->at[i], from, to);
    }
    for (uint32_t i = 0; i < g->coming_count; i++) {
        guest_renumber(&g->coming[i], from, to);
    }
}

void guests_settle(struct guests *g)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < g->count; i++) {
        struct guest *guest = &g->at[i];
        guest->process = guest->next_process >= 0 ? guest->next_process : guest->process;
        guest->next_process = -1;
        if (guest->state != muster_STATE_ABSENT) {
            g->at[kept++] = *guest;
        }
    }
    g->count = kept;
    for (uint32_t i = 0; i < g->coming_count; i++) {
        guest_insert(g, &g->coming[i]);
    }
    g->coming_count = 0;
}
