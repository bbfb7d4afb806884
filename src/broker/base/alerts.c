/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

void alerts_note(struct alerts *e, enum alert_kind kind, uint32_t agent, uint32_t sender,
                 uint64_t now_ns)
{
    uint32_t index = agent * ALERT_KINDS + (uint32_t)kind;
    struct alert *known = &e->all[index];
    (void)mu_list_append(&e->queue, MU_LINKS(e->all, link), index);
    known->kind = kind;
    known->agent = agent;
    known->sender = sender;
    known->count++;
    known->at_ns = now_ns;
}

bool alerts_next(struct alerts *e, uint64_t now_ns, struct alert *out)
{
    if (e->ready == 0) {
        if (e->queue.count == 0 || now_ns < e->pause_until_ns) {
            return false;
        }
        e->ready = e->queue.count;
        e->pause_until_ns = clock_after_ns(now_ns, EVENTS_PAUSE_NS);
    }
    struct alert *next = &e->all[mu_list_take(&e->queue, MU_LINKS(e->all, link))];
    *out = *next;
    next->count = 0;
    e->ready--;
    return true;
}
