/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/dedup.h"

#include "core/hash.h"
#include "muster/limits.h"

#include <string.h>

_Static_assert(DEDUP_MAX > MU_WINDOW_MAX + 8, "a window, and directives beyond it");

/* As the broker's boxes have them: a directive has no priority. */
static uint32_t queue_of(const muster_Mail *m)
{
    return m->layer == 0 ? 0 : (uint32_t)(m->priority + 2);
}

static uint32_t sender_of(const muster_Mail *m)
{
    return (uint32_t)mu_hash_string(m->src);
}

/* @return never 0 for a life that is known */
static uint32_t life_of(const muster_Mail *m)
{
    uint32_t hash = (uint32_t)mu_hash_number(m->since_wall_ns);
    return hash || m->since_wall_ns == 0 ? hash : 1;
}

void dedup_clear(struct dedup *t)
{
    for (uint32_t i = 0; i < DEDUP_QUEUES; i++) {
        if (t->queues[i].mails[0].seq != 0) {
            memset(&t->queues[i], 0, sizeof t->queues[i]);
        }
    }
    if (t->brokers[0].incarnation != 0) {
        memset(t->brokers, 0, sizeof t->brokers);
    }
}

void dedup_add(struct dedup *t, const muster_Mail *m)
{
    uint32_t queue = queue_of(m), next = t->queues[queue].next;
    t->queues[queue].mails[next].sender = sender_of(m);
    t->queues[queue].mails[next].life = life_of(m);
    t->queues[queue].mails[next].seq = m->seq;
    t->queues[queue].next = (next + 1) % DEDUP_MAX;
}

bool dedup_has(const struct dedup *t, const muster_Mail *m)
{
    uint32_t sender = sender_of(m), life = life_of(m), queue = queue_of(m);
    for (uint32_t i = 0; i < DEDUP_MAX; i++) {
        uint32_t had = t->queues[queue].mails[i].life;
        bool same_life = had == life || had == 0 || life == 0;
        if (t->queues[queue].mails[i].seq == m->seq && t->queues[queue].mails[i].sender == sender &&
            same_life) {
            return m->seq != 0;
        }
    }
    return false;
}

void dedup_leave(struct dedup *t, uint64_t incarnation, uint64_t last_number)
{
    uint32_t i = 0;
    while (i < DEDUP_BROKERS - 1 && t->brokers[i].incarnation != incarnation) {
        i++;
    }
    memmove(&t->brokers[1], &t->brokers[0], i * sizeof t->brokers[0]);
    t->brokers[0].incarnation = incarnation;
    t->brokers[0].last_number = last_number;
}

uint64_t dedup_last_number(const struct dedup *t, uint64_t incarnation)
{
    for (uint32_t i = 0; i < DEDUP_BROKERS; i++) {
        if (t->brokers[i].incarnation == incarnation) {
            return t->brokers[i].last_number;
        }
    }
    return 0;
}
