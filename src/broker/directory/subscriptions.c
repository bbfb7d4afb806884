/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/text.h"

#include <string.h>

struct subscription *subscriptions_at(struct subscriptions *s, uint32_t index)
{
    MU_ASSERT(index < s->count);
    return &s->at[s->order[index]];
}

uint32_t subscriptions_find(struct subscriptions *s, const char *agent, const char *text)
{
    for (uint32_t i = 0; i < s->count; i++) {
        const struct subscription *one = subscriptions_at(s, i);
        if (strcmp(one->agent, agent) == 0 && strcmp(one->text, text) == 0) {
            return i;
        }
    }
    return MU_NONE;
}

struct subscription *subscriptions_add(struct subscriptions *s, const char *agent, const char *text)
{
    if (s->count == MU_SUBSCRIPTIONS_MAX) {
        return NULL;
    }
    if (s->count == s->used) {
        s->order[s->used] = s->used;
        s->used++;
    }
    struct subscription *one = &s->at[s->order[s->count++]];
    memset(one, 0, sizeof *one);
    bool fits = mu_text_copy(one->agent, sizeof one->agent, agent) &&
                mu_text_copy(one->text, sizeof one->text, text);
    MU_ASSERT(fits);
    return one;
}

void subscriptions_remove(struct subscriptions *s, uint32_t index)
{
    uint32_t slot = s->order[index];
    array_remove(s->order, sizeof *s->order, &s->count, index);
    s->order[s->count] = slot;
}

/* @return whether it was set */
static bool bit_set(uint64_t *bits, uint32_t line, bool on)
{
    uint64_t bit = 1ull << (line % 64);
    uint64_t *at = &bits[line / 64];
    bool had = (*at & bit) != 0;
    *at = on ? *at | bit : *at & ~bit;
    return had;
}

bool subscriptions_note(struct subscription *s, uint32_t line, bool found)
{
    return bit_set(s->told, line, found) != found;
}

bool subscriptions_owe(struct subscription *s, uint32_t line, bool owed)
{
    return bit_set(s->owed, line, owed);
}

void subscriptions_rest(struct subscriptions *s, uint64_t lines[SUBSCRIPTIONS_WORDS])
{
    memset(lines, 0, SUBSCRIPTIONS_WORDS * sizeof *lines);
    for (uint32_t i = 0; i < s->count; i++) {
        const struct subscription *one = subscriptions_at(s, i);
        for (uint32_t word = 0; word < SUBSCRIPTIONS_WORDS; word++) {
            lines[word] |= one->told[word] | one->owed[word];
        }
    }
}

void subscriptions_forget(struct subscriptions *s, uint32_t line)
{
    for (uint32_t i = 0; i < s->count; i++) {
        (void)subscriptions_note(subscriptions_at(s, i), line, false);
        (void)subscriptions_owe(subscriptions_at(s, i), line, false);
    }
}
