/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"
#include "muster/result.h"

void alerts_init(struct alerts *e, uint32_t agents)
{
    *e = (struct alerts){.size = agents * ALERT_KINDS};
    e->all = mu_startup_array(e->size, sizeof *e->all);
    e->ring = mu_startup_array(e->size, sizeof *e->ring);
}

void alerts_note(struct alerts *e, const struct alert *event)
{
    uint32_t index = event->agent * ALERT_KINDS + (uint32_t)event->kind;
    struct alert *known = &e->all[index];
    if (known->count == 0) {
        MU_ASSERT(e->count < e->size);
        e->ring[(e->head + e->count++) % e->size] = index;
    }
    uint64_t count = known->count + event->count;
    *known = *event;
    known->count = count;
}

bool alerts_next(struct alerts *e, uint64_t now_ns, struct alert *out)
{
    if (e->ready == 0) {
        if (e->count == 0 || now_ns < e->pause_until_ns) {
            return false;
        }
        e->ready = e->count;
        e->pause_until_ns =
            now_ns > UINT64_MAX - EVENTS_PAUSE_NS ? UINT64_MAX : now_ns + EVENTS_PAUSE_NS;
    }
    struct alert *next = &e->all[e->ring[e->head]];
    *out = *next;
    next->count = 0;
    e->head = (e->head + 1) % e->size;
    e->count--;
    e->ready--;
    return true;
}

const char *alerts_kind_word(enum alert_kind kind)
{
    static const char *const kinds[ALERT_KINDS] = {"box-full", "dropped", "over-share", "refused"};
    return kinds[kind];
}
