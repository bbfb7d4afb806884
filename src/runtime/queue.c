/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/queue.h"

#include "runtime/process.h"

void queue_add(struct mu_agent *a, enum queue_kind kind)
{
    struct queue *q = &a->process->queues[kind];
    struct queue_link *link = &a->links[kind];
    if (link->in) {
        return;
    }
    *link = (struct queue_link){.prev = q->last, .in = true};
    if (q->last) {
        q->last->links[kind].next = a;
    } else {
        q->first = a;
    }
    q->last = a;
}

void queue_remove(struct mu_agent *a, enum queue_kind kind)
{
    struct queue *q = &a->process->queues[kind];
    struct queue_link *link = &a->links[kind];
    if (!link->in) {
        return;
    }
    if (link->prev) {
        link->prev->links[kind].next = link->next;
    } else {
        q->first = link->next;
    }
    if (link->next) {
        link->next->links[kind].prev = link->prev;
    } else {
        q->last = link->prev;
    }
    *link = (struct queue_link){0};
}
