/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/owed.h"

void owed_add(struct owed *o, uint64_t now_ns)
{
    if (o->parcels++ == 0) {
        o->since_ns = now_ns;
    }
}

void owed_clear(struct owed *o, uint64_t now_ns)
{
    if (o->parcels > 0) {
        *o = (struct owed){.said_ns = now_ns};
    }
}

/* @return a pause that is OWED_PAUSE_NS on average, and no two are alike: a hundred processes that
 * have heard the same do not all answer at the same time, again and again */
static uint64_t pause_of(uint64_t said_ns)
{
    return OWED_PAUSE_NS / 2 + said_ns / 64 * 0x9e3779b97f4a7c15u % OWED_PAUSE_NS;
}

static uint64_t due_ns(const struct owed *o)
{
    uint64_t soon_ns = o->since_ns + OWED_DELAY_NS;
    uint64_t pause_ns = o->said_ns ? o->said_ns + pause_of(o->said_ns) : 0;
    return soon_ns > pause_ns ? soon_ns : pause_ns;
}

bool owed_due(const struct owed *o, uint64_t now_ns)
{
    return o->parcels >= OWED_PARCELS || (o->parcels > 0 && now_ns >= due_ns(o));
}

int64_t owed_wait_ns(const struct owed *o, uint64_t now_ns)
{
    if (o->parcels == 0) {
        return INT64_MAX;
    }
    return owed_due(o, now_ns) ? OWED_DELAY_NS : (int64_t)(due_ns(o) - now_ns);
}
