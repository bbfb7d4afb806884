/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "muster/memory.h"
#include "muster/result.h"

void receipts_init(struct receipts *r, uint32_t agents)
{
    *r = (struct receipts){.free = MU_NONE};
    r->pool = mu_startup_array(MU_MAILS_MAX, sizeof *r->pool);
    r->queues = mu_startup_array(agents, sizeof *r->queues);
}

static struct receipt_queue *queue_of(struct receipts *r, uint32_t agent)
{
    struct receipt_queue *q = &r->queues[agent];
    if (!q->begun) {
        *q = (struct receipt_queue){.begun = true, .head = MU_NONE, .tail = MU_NONE};
    }
    return q;
}

const struct receipt_queue *receipts_of(struct receipts *r, uint32_t agent)
{
    return queue_of(r, agent);
}

static uint32_t receipt_take(struct receipts *r)
{
    uint32_t index = r->free;
    if (index != MU_NONE) {
        r->free = r->pool[index].next;
    } else if (r->used < MU_MAILS_MAX) {
        index = r->used++;
    }
    return index;
}

void receipts_add(struct receipts *r, uint32_t agent, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result)
{
    struct receipt_queue *q = queue_of(r, agent);
    if (q->tail != MU_NONE) {
        struct receipt *last = &r->pool[q->tail];
        if (last->result == result && last->last_seq + 1 == first_seq) {
            last->last_seq = last_seq;
            return;
        }
    }
    if (q->count == RECEIPTS_EACH_MAX) { /* the oldest: the newer ones say more */
        receipts_drop(r, agent, 1);
        r->lost++;
    }
    uint32_t index = receipt_take(r);
    if (index == MU_NONE) {
        r->lost++;
        return;
    }
    r->pool[index] = (struct receipt){
        .first_seq = first_seq, .last_seq = last_seq, .result = result, .next = MU_NONE};
    if (q->tail == MU_NONE) {
        q->head = index;
    } else {
        r->pool[q->tail].next = index;
    }
    q->tail = index;
    q->count++;
}

void receipts_drop(struct receipts *r, uint32_t agent, uint32_t count)
{
    struct receipt_queue *q = queue_of(r, agent);
    MU_ASSERT(count <= q->count);
    q->count -= count;
    for (; count > 0; count--) {
        uint32_t index = q->head;
        q->head = r->pool[index].next;
        r->pool[index].next = r->free;
        r->free = index;
    }
    if (q->head == MU_NONE) {
        q->tail = MU_NONE;
    }
}
