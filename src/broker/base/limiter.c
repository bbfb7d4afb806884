/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"

void limiter_init(struct limiter *p, uint32_t agents)
{
    *p = (struct limiter){.size = agents};
    p->agents = mu_startup_array(agents, sizeof *p->agents);
    p->ring = mu_startup_array(agents, sizeof *p->ring);
}

static uint64_t pause_end_ns(uint64_t now_ns)
{
    return now_ns > UINT64_MAX - LIMITER_PAUSE_NS ? UINT64_MAX : now_ns + LIMITER_PAUSE_NS;
}

bool limiter_holds(struct limiter *p, uint32_t agent, uint64_t now_ns)
{
    struct paced *a = &p->agents[agent];
    if (now_ns < a->until_ns) {
        if (!a->queued) {
            a->queued = true;
            p->ring[(p->head + p->count++) % p->size] = agent;
        }
        return true;
    }
    if (!a->queued) { /* else others would wait behind it once more */
        a->until_ns = pause_end_ns(now_ns);
    }
    return false;
}

/* The head may be due a little later than one behind it, which then waits for it. */
uint64_t limiter_deadline_ns(const struct limiter *p)
{
    return p->count ? p->agents[p->ring[p->head]].until_ns : UINT64_MAX;
}

uint32_t limiter_next(struct limiter *p, uint64_t now_ns)
{
    if (p->count == 0 || now_ns < limiter_deadline_ns(p)) {
        return MU_NONE;
    }
    uint32_t agent = p->ring[p->head];
    p->head = (p->head + 1) % p->size;
    p->count--;
    p->agents[agent] = (struct paced){.until_ns = pause_end_ns(now_ns)};
    return agent;
}
