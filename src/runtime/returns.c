/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/returns.h"

#include "runtime/process.h"

void returns_hear(mu_agent *a, returns_handler *on_return)
{
    a->on_return = on_return;
}

static bool is_bad(muster_Outcome result)
{
    return result != muster_OUTCOME_DELIVERED && result != muster_OUTCOME_STORED &&
           result != muster_OUTCOME_DUPLICATE;
}

void returns_take(mu_agent *a, const muster_Receipt *receipt)
{
    if (!a->on_return || !is_bad(receipt->result)) {
        return;
    }
    uint64_t first = receipt->first_seq, end = outbox_range(&a->outbox, &first, receipt->last_seq);
    for (uint64_t seq = first; seq < end; seq++) {
        const muster_Mail *m = outbox_awaited(&a->outbox, seq);
        if (m) {
            a->on_return(a->handlers.self, a, m->dst, m->layer == WIRE_DIRECTIVE,
                         (enum mu_outcome)receipt->result);
        }
    }
}
