/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/owed.h"

void owed_add(struct owed *o, uint64_t now_ns)
{
    if (o->parcels++ == 0) {
        o->since_ns = now_ns;
    }
}

void owed_clear(struct owed *o)
{
    *o = (struct owed){0};
}

bool owed_due(const struct owed *o, uint64_t now_ns)
{
    return o->parcels >= OWED_PARCELS || (o->parcels > 0 && now_ns - o->since_ns >= OWED_DELAY_NS);
}

int64_t owed_wait_ns(const struct owed *o, uint64_t now_ns)
{
    if (o->parcels == 0) {
        return INT64_MAX;
    }
    uint64_t waited_ns = now_ns - o->since_ns;
    return owed_due(o, now_ns) ? OWED_DELAY_NS : (int64_t)(OWED_DELAY_NS - waited_ns);
}
