/* SPDX-License-Identifier: Apache-2.0 */
#include "core/table.h"

#include "muster/memory.h"

#include <stdbool.h>
#include <string.h>

enum { FIRST_SLOTS = 256 };

static uint32_t name_hash(const char *name)
{
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (const char *c = name; *c; c++) {
        hash = (hash ^ (unsigned char)*c) * 16777619u;
    }
    return hash;
}

/* The slot that holds the name, or else the free one where it would go. */
static uint32_t slot_find(const struct mu_table *t, const char *name, uint32_t hash)
{
    uint32_t i = hash & t->mask;
    while (t->slots[i].name && (t->slots[i].hash != hash || strcmp(t->slots[i].name, name) != 0)) {
        i = (i + 1) & t->mask;
    }
    return i;
}

void mu_table_init(struct mu_table *t, uint32_t capacity)
{
    MU_ASSERT(capacity >= 1 && capacity <= 1u << 30);
    uint32_t slots = 2;
    while (slots < capacity + (uint64_t)capacity / 2) { /* two thirds full at most: short probes */
        slots *= 2;
    }
    *t = (struct mu_table){.mask_most = slots - 1, .capacity = capacity};
    t->mask = t->mask_most < FIRST_SLOTS ? t->mask_most : FIRST_SLOTS - 1;
    t->slots = mu_startup_array(slots, sizeof *t->slots);
}

/* Twice as many slots.  In the order of probing, from behind a free slot on, each name goes to
 * where it is found now: whatever it probes past has gone to its place before. */
static void grow(struct mu_table *t)
{
    uint32_t old_mask = t->mask, first = 0;
    while (t->slots[first].name) {
        first++;
    }
    t->mask = 2 * old_mask + 1;
    for (uint32_t k = 1; k <= old_mask; k++) {
        uint32_t from = (first + k) & old_mask;
        struct mu_table_slot moved = t->slots[from];
        if (moved.name) {
            t->slots[from] = (struct mu_table_slot){0};
            t->slots[slot_find(t, moved.name, moved.hash)] = moved;
        }
    }
}

static bool is_crowded(const struct mu_table *t)
{
    return t->mask < t->mask_most && 3 * (uint64_t)t->count >= 2 * (uint64_t)t->mask;
}

mu_result mu_table_put(struct mu_table *t, const char *name, uint32_t index)
{
    uint32_t hash = name_hash(name);
    uint32_t slot = slot_find(t, name, hash);
    if (t->slots[slot].name) {
        return MU_EXISTS;
    }
    if (t->count == t->capacity) {
        return MU_FULL;
    }
    if (is_crowded(t)) {
        grow(t);
        slot = slot_find(t, name, hash);
    }
    t->slots[slot] = (struct mu_table_slot){.name = name, .hash = hash, .index = index};
    t->count++;
    return MU_OK;
}

uint32_t mu_table_find(const struct mu_table *t, const char *name)
{
    const struct mu_table_slot *slot = &t->slots[slot_find(t, name, name_hash(name))];
    return slot->name ? slot->index : MU_NONE;
}

mu_result mu_table_remove(struct mu_table *t, const char *name)
{
    uint32_t hole = slot_find(t, name, name_hash(name));
    if (!t->slots[hole].name) {
        return MU_ABSENT;
    }
    /* Moves back the names that probed past the hole: no tombstones are needed (Knuth 6.4, R). */
    for (uint32_t i = (hole + 1) & t->mask; t->slots[i].name; i = (i + 1) & t->mask) {
        uint32_t home = t->slots[i].hash & t->mask;
        if (((i - home) & t->mask) >= ((i - hole) & t->mask)) {
            t->slots[hole] = t->slots[i];
            hole = i;
        }
    }
    t->slots[hole] = (struct mu_table_slot){0};
    t->count--;
    return MU_OK;
}
