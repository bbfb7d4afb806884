/* SPDX-License-Identifier: Apache-2.0 */
#include "core/spell.h"

#include <string.h>

enum { SPELL_LETTERS_MAX = 63 };

static size_t spell_least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Rows of the table of distances between beginnings of the two words. */
struct spell_rows {
    size_t before_last[SPELL_LETTERS_MAX + 1];
    size_t last[SPELL_LETTERS_MAX + 1];
    size_t now[SPELL_LETTERS_MAX + 1];
};

static void spell_fill_row(struct spell_rows *rows, const char *a, size_t i, const char *b)
{
    rows->now[0] = i;
    for (size_t j = 1; b[j - 1] != '\0'; j++) {
        size_t best = spell_least(rows->last[j], rows->now[j - 1]) + 1;
        best = spell_least(best, rows->last[j - 1] + (a[i - 1] != b[j - 1]));
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
            best = spell_least(best, rows->before_last[j - 2] + 1);
        }
        rows->now[j] = best;
    }
}

size_t mu_spell_distance(const char *a, const char *b)
{
    size_t a_len = strlen(a);
    size_t b_len = strlen(b);
    if (a_len > SPELL_LETTERS_MAX || b_len > SPELL_LETTERS_MAX) {
        return a_len > b_len ? a_len : b_len;
    }
    struct spell_rows rows = {0};
    for (size_t j = 0; j <= b_len; j++) {
        rows.now[j] = j;
    }
    for (size_t i = 1; i <= a_len; i++) {
        memcpy(rows.before_last, rows.last, sizeof rows.last);
        memcpy(rows.last, rows.now, sizeof rows.now);
        spell_fill_row(&rows, a, i, b);
    }
    return rows.now[b_len];
}

void mu_spell_init(struct mu_spell *s, const char *word)
{
    size_t near = strlen(word) / 3;
    *s = (struct mu_spell){.word = word, .distance = (near > 0 ? near : 1) + 1};
}

void mu_spell_offer(struct mu_spell *s, const char *known)
{
    size_t distance = mu_spell_distance(s->word, known);
    if (distance < s->distance && distance < strlen(known)) {
        s->distance = distance;
        s->nearest = known;
    }
}
