/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

static const uint64_t BEAT_NS = 300000000;

/* Other brokers and watchers do not speak: they hear of us so often at least. */
static const uint64_t SPARED_MAX_NS = 1000000000;

bool heartbeat_looks(const struct heartbeat *p, uint64_t now_ns)
{
    return p->told_ns == 0 || now_ns - p->looked_ns >= BEAT_NS;
}

bool heartbeat_beats(struct heartbeat *p, uint64_t spoke_ns, uint64_t now_ns)
{
    bool all_spoke = spoke_ns > p->looked_ns;
    bool spared = p->told_ns > 0 && all_spoke && now_ns - p->told_ns < SPARED_MAX_NS;
    p->looked_ns = now_ns;
    if (!spared) {
        p->told_ns = now_ns;
    }
    return !spared;
}
