/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/inbox.h"

#include "runtime/process.h"

void inbox_init(struct inbox *box)
{
    for (uint32_t i = 0; i < INBOX_MAX; i++) {
        box->at[i] = bus_sample(BUS_DELIVERY);
    }
}

static void **place_of(struct inbox *box, uint32_t index)
{
    return &box->at[(box->first + index) % INBOX_MAX];
}

void inbox_fill(mu_process *p)
{
    struct inbox *box = &p->inbox;
    const muster_Delivery *d;
    enum bus_life life;
    while (box->count < INBOX_MAX && (d = bus_next(&p->delivery, &life))) {
        bool is_glance = life == BUS_DATA && d->glances._length > 0;
        if (is_glance && d->broker_incarnation == p->link.incarnation) {
            glances_take(p, d);
        } else if (life == BUS_DATA) {
            void **place = place_of(box, box->count++);
            *place = bus_keep(&p->delivery, *place);
        }
    }
}

void inbox_drop(mu_process *p)
{
    if (p->mail) {
        p->mail = NULL;
        p->inbox.first = (p->inbox.first + 1) % INBOX_MAX;
        p->inbox.count--;
    }
}

void inbox_next(mu_process *p)
{
    inbox_drop(p);
    if (p->inbox.count == 0) {
        inbox_fill(p);
    }
    while (!p->mail && p->inbox.count > 0) {
        p->mail = *place_of(&p->inbox, 0);
        if (!link_is_ours(p, p->mail)) {
            inbox_drop(p);
        }
    }
}
