/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

bool limiter_holds(struct limiter *p, uint32_t agent, uint64_t now_ns)
{
    struct paced *a = &p->agents[agent];
    if (now_ns < a->until_ns) {
        (void)mu_list_append(&p->queue, MU_LINKS(p->agents, link), agent);
        return true;
    }
    if (!mu_list_has(MU_LINKS(p->agents, link),
                     agent)) { /* else others would wait behind it once more */
        a->until_ns = clock_after_ns(now_ns, p->pause_ns);
    }
    return false;
}

void limiter_told(struct limiter *p, uint32_t agent, uint64_t now_ns)
{
    (void)mu_list_remove(&p->queue, MU_LINKS(p->agents, link), agent);
    p->agents[agent].until_ns = clock_after_ns(now_ns, p->pause_ns);
}

/* The head may be due a little later than one behind it, which then waits for it. */
uint64_t limiter_deadline_ns(const struct limiter *p)
{
    return p->queue.count ? p->agents[mu_list_first(&p->queue)].until_ns : UINT64_MAX;
}

uint32_t limiter_next(struct limiter *p, uint64_t now_ns)
{
    uint32_t agent = MU_NONE;
    if (p->queue.count > 0 && now_ns >= limiter_deadline_ns(p)) {
        agent = mu_list_take(&p->queue, MU_LINKS(p->agents, link));
        p->agents[agent].until_ns = clock_after_ns(now_ns, p->pause_ns);
    }
    return agent;
}
