/* SPDX-License-Identifier: Apache-2.0 */
#include "core/pairs.h"

#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

typedef char pair_key[2 * MU_NAME_MAX + 2];

static void key_make(pair_key key, const char *first, const char *second)
{
    struct mu_text t = mu_text_in(key, sizeof(pair_key));
    mu_text_add(&t, first);
    mu_text_add(&t, " "); /* comes before all that names are made of: keys sort as pairs do */
    mu_text_add(&t, second);
    MU_ASSERT(!t.cut && strlen(first) <= MU_NAME_MAX);
}

void mu_pairs_init(struct mu_pairs *p, uint32_t capacity)
{
    *p = (struct mu_pairs){.capacity = capacity, .free = MU_NONE};
    p->at = mu_startup_array(capacity, sizeof *p->at);
    p->order = mu_startup_array(capacity, sizeof *p->order);
    mu_table_init(&p->table, capacity);
}

/* @return the place of the first key in the order that is not before this one */
static uint32_t key_place(const struct mu_pairs *p, const char *key)
{
    uint32_t low = 0, high = p->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (strcmp(p->at[p->order[middle]].key, key) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

uint32_t mu_pairs_find(const struct mu_pairs *p, const char *first, const char *second)
{
    pair_key key;
    if (p->count == 0) {
        return MU_NONE;
    }
    key_make(key, first, second);
    return mu_table_find(&p->table, key);
}

static uint32_t pair_take(struct mu_pairs *p)
{
    uint32_t index = p->free;
    if (index != MU_NONE) {
        p->free = p->at[index].free_next;
        return index;
    }
    return p->used < p->capacity ? p->used++ : MU_NONE;
}

uint32_t mu_pairs_add(struct mu_pairs *p, const char *first, const char *second)
{
    uint32_t index = pair_take(p);
    if (index == MU_NONE) {
        return MU_NONE;
    }
    struct mu_pair *pair = &p->at[index];
    key_make(pair->key, first, second);
    mu_text_copy(pair->first, sizeof pair->first, first);
    mu_result put = mu_table_put(&p->table, pair->key, index);
    MU_ASSERT(put == MU_OK);
    uint32_t place = key_place(p, pair->key);
    memmove(&p->order[place + 1], &p->order[place], (p->count - place) * sizeof *p->order);
    p->order[place] = index;
    p->count++;
    return index;
}

void mu_pairs_remove(struct mu_pairs *p, uint32_t index)
{
    struct mu_pair *pair = &p->at[index];
    uint32_t place = key_place(p, pair->key);
    MU_ASSERT(place < p->count && p->order[place] == index);
    mu_result removed = mu_table_remove(&p->table, pair->key);
    MU_ASSERT(removed == MU_OK);
    p->count--;
    memmove(&p->order[place], &p->order[place + 1], (p->count - place) * sizeof *p->order);
    pair->free_next = p->free;
    p->free = index;
}

const char *mu_pairs_first(const struct mu_pairs *p, uint32_t index)
{
    return p->at[index].first;
}

const char *mu_pairs_second(const struct mu_pairs *p, uint32_t index)
{
    return p->at[index].key + strlen(p->at[index].first) + 1;
}

uint32_t mu_pairs_start(const struct mu_pairs *p, const char *first)
{
    pair_key key;
    if (p->count == 0) {
        return 0;
    }
    key_make(key, first, "");
    return key_place(p, key);
}

uint32_t mu_pairs_of(const struct mu_pairs *p, uint32_t place, const char *first)
{
    bool there = place < p->count && strcmp(p->at[p->order[place]].first, first) == 0;
    return there ? p->order[place] : MU_NONE;
}
