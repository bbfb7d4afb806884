/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

static bool mail_before(const struct timers *s, const struct mail *a, const struct mail *b)
{
    uint64_t a_ns = a->at_ns[s->kind], b_ns = b->at_ns[s->kind];
    return a_ns != b_ns ? a_ns < b_ns : a->order < b->order;
}

static void heap_set(struct timers *s, uint32_t i, struct mail *m)
{
    s->heap[i] = m;
    m->place[s->kind] = i;
}

static void heap_up(struct timers *s, uint32_t i, struct mail *m)
{
    while (i > 0 && mail_before(s, m, s->heap[(i - 1) / 2])) {
        heap_set(s, i, s->heap[(i - 1) / 2]);
        i = (i - 1) / 2;
    }
    heap_set(s, i, m);
}

static void heap_down(struct timers *s, uint32_t i, struct mail *m)
{
    for (uint32_t child = 2 * i + 1; child < s->count; child = 2 * i + 1) {
        if (child + 1 < s->count && mail_before(s, s->heap[child + 1], s->heap[child])) {
            child++;
        }
        if (!mail_before(s, s->heap[child], m)) {
            break;
        }
        heap_set(s, i, s->heap[child]);
        i = child;
    }
    heap_set(s, i, m);
}

void timers_add(struct timers *s, struct mail *m)
{
    MU_ASSERT(m->place[s->kind] == MU_NONE && s->count < QUOTA_MAILS_MAX);
    heap_up(s, s->count++, m);
}

void timers_take(struct timers *s, struct mail *m)
{
    uint32_t i = m->place[s->kind];
    m->place[s->kind] = MU_NONE;
    struct mail *last = s->heap[--s->count];
    if (last == m) {
        return;
    }
    heap_down(s, i, last);
    heap_up(s, last->place[s->kind], last);
}
