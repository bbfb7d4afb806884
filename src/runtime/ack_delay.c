/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/ack_delay.h"

void ack_delay_add(struct ack_delay *o, uint64_t now_ns)
{
    if (o->items++ == 0) {
        o->since_ns = now_ns;
    }
}

void ack_delay_clear(struct ack_delay *o, uint64_t now_ns)
{
    if (o->items > 0) {
        *o = (struct ack_delay){.said_ns = now_ns};
    }
}

/* @return a pause that is ACK_PAUSE_NS on average, and no two are alike: a hundred processes that
 * have heard the same do not all answer at the same time, again and again */
static uint64_t pause_of(uint64_t said_ns)
{
    return ACK_PAUSE_NS / 2 + said_ns / 64 * 0x9e3779b97f4a7c15u % ACK_PAUSE_NS;
}

static uint64_t due_ns(const struct ack_delay *o)
{
    uint64_t soon_ns = o->since_ns + ACK_DELAY_NS;
    uint64_t pause_ns = o->said_ns ? o->said_ns + pause_of(o->said_ns) : 0;
    return soon_ns > pause_ns ? soon_ns : pause_ns;
}

bool ack_delay_due(const struct ack_delay *o, uint64_t now_ns)
{
    return o->items >= ACK_DELAY_ITEMS || (o->items > 0 && now_ns >= due_ns(o));
}

int64_t ack_delay_wait_ns(const struct ack_delay *o, uint64_t now_ns)
{
    if (o->items == 0) {
        return INT64_MAX;
    }
    return ack_delay_due(o, now_ns) ? ACK_DELAY_NS : (int64_t)(due_ns(o) - now_ns);
}
