/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

void receipts_add(struct receipts *r, uint32_t agent, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result)
{
    struct mu_list *q = &r->queues[agent];
    struct receipt *last = q->count > r->told[agent] ? &r->at[mu_list_last(q)] : NULL;
    if (last && last->result == result && last->last_seq + 1 == first_seq) {
        last->last_seq = last_seq;
        return;
    }
    if (q->count == RECEIPTS_EACH_MAX) { /* the oldest: the newer ones say more */
        receipts_drop(r, agent, 1);
        r->lost++;
    }
    uint32_t index = mu_pool_take(&r->pool);
    if (index == MU_NONE) {
        r->lost++;
        return;
    }
    r->at[index] = (struct receipt){.first_seq = first_seq, .last_seq = last_seq, .result = result};
    (void)mu_list_append(q, MU_LINKS(r->at, link), index);
}

void receipts_drop(struct receipts *r, uint32_t agent, uint32_t count)
{
    MU_ASSERT(count <= receipts_count(r, agent));
    r->told[agent] -= count < r->told[agent] ? count : r->told[agent];
    for (; count > 0; count--) {
        mu_pool_give(&r->pool, mu_list_take(&r->queues[agent], MU_LINKS(r->at, link)));
    }
}
