/* SPDX-License-Identifier: Apache-2.0 */
/* The C library's qsort takes memory for more than about a kilobyte of items.  This is heap sort
 * (J. W. J. Williams, Algorithm 232, Communications of the ACM 7(6), 1964). */
#include "core/sort.h"

#include <stdbool.h>
#include <string.h>

enum { CHUNK = 64 };

struct sort {
    char *items;
    size_t size;
    mu_sort_compare *compare;
    const void *context;
};

static bool sort_is_before(const struct sort *s, size_t one, size_t other)
{
    return s->compare(s->items + one * s->size, s->items + other * s->size, s->context) < 0;
}

static void sort_swap(const struct sort *s, size_t one, size_t other)
{
    char *x = s->items + one * s->size, *y = s->items + other * s->size;
    char kept[CHUNK];
    for (size_t left = s->size; left > 0;) {
        size_t len = left < CHUNK ? left : CHUNK;
        memcpy(kept, x, len);
        memcpy(x, y, len);
        memcpy(y, kept, len);
        x += len;
        y += len;
        left -= len;
    }
}

/* Lets an item sink until neither child comes after it. */
static void sort_sink(const struct sort *s, size_t at, size_t count)
{
    for (size_t child; (child = 2 * at + 1) < count; at = child) {
        if (child + 1 < count && sort_is_before(s, child, child + 1)) {
            child++;
        }
        if (!sort_is_before(s, at, child)) {
            return;
        }
        sort_swap(s, at, child);
    }
}

static bool sort_is_done(const struct sort *s, size_t count)
{
    for (size_t i = 1; i < count; i++) {
        if (sort_is_before(s, i, i - 1)) {
            return false;
        }
    }
    return true;
}

void mu_sort(void *items, size_t count, size_t size, mu_sort_compare *compare, const void *context)
{
    const struct sort s = {items, size, compare, context};
    if (sort_is_done(&s, count)) {
        return;
    }
    for (size_t at = count / 2; at-- > 0;) {
        sort_sink(&s, at, count);
    }
    for (size_t left = count; left-- > 1;) {
        sort_swap(&s, 0, left);
        sort_sink(&s, 0, left);
    }
}
