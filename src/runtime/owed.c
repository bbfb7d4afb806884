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

static uint64_t due_ns(const struct owed *o)
{
    uint64_t soon_ns = o->since_ns + OWED_DELAY_NS;
    uint64_t pause_ns = o->said_ns ? o->said_ns + OWED_PAUSE_NS : 0;
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
