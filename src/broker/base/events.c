/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"
#include "muster/result.h"

void events_init(struct events *e, uint32_t agents)
{
    *e = (struct events){.size = agents * EVENT_KINDS};
    e->all = mu_startup_array(e->size, sizeof *e->all);
    e->ring = mu_startup_array(e->size, sizeof *e->ring);
}

void events_note(struct events *e, const struct event *event)
{
    uint32_t index = event->agent * EVENT_KINDS + (uint32_t)event->kind;
    struct event *known = &e->all[index];
    if (known->count == 0) {
        MU_ASSERT(e->count < e->size);
        e->ring[(e->head + e->count++) % e->size] = index;
    }
    uint64_t count = known->count + event->count;
    *known = *event;
    known->count = count;
}

bool events_next(struct events *e, uint64_t now_ns, struct event *out)
{
    if (e->ready == 0) {
        if (e->count == 0 || now_ns < e->pause_until_ns) {
            return false;
        }
        e->ready = e->count;
        e->pause_until_ns =
            now_ns > UINT64_MAX - EVENTS_PAUSE_NS ? UINT64_MAX : now_ns + EVENTS_PAUSE_NS;
    }
    struct event *next = &e->all[e->ring[e->head]];
    *out = *next;
    next->count = 0;
    e->head = (e->head + 1) % e->size;
    e->count--;
    e->ready--;
    return true;
}

const char *events_kind_word(enum event_kind kind)
{
    static const char *const kinds[EVENT_KINDS] = {"box-full", "dropped", "over-share", "refused"};
    return kinds[kind];
}
