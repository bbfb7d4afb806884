/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/booking.h"

#include "broker/parts.h"
#include "broker/presence.h"

void booking_event(struct broker *b, enum event_kind kind, uint32_t agent, uint32_t sender)
{
    struct event event = {
        .agent = agent, .sender = sender, .count = 1, .at_ns = b->clock.now_ns, .kind = kind};
    events_note(&b->events, &event);
}

void booking_refused(struct broker *b, const struct mail *m, uint32_t agent, enum share_answer why,
                     uint64_t receivers)
{
    bool over = why == SHARE_OVER;
    *(over ? &b->counters.over_share : &b->counters.box_full) += receivers;
    booking_event(b, over ? EVENT_OVER_SHARE : EVENT_BOX_FULL, agent, m->sender);
}

bool booking_take(struct broker *b, struct mail *m, uint32_t posts)
{
    struct share_use want = {.mails = 1, .bytes = store_bytes(m), .posts = posts};
    m->side = presence_in_lockstep(b, m->payer) ? SHARE_LOCKSTEP : SHARE_OUTSIDE;
    enum share_answer why = share_book(&b->shares, (enum share_side)m->side, m->payer, &want,
                                       b->lockstep.on, m->letter.layer == 0);
    if (why != SHARE_FITS) {
        booking_refused(b, m, REGISTRY_BROKER, why, posts);
    }
    return why == SHARE_FITS;
}

bool booking_restore(struct broker *b, struct mail *m, uint32_t posts)
{
    struct share_use use = {.mails = 1, .bytes = store_bytes(m), .posts = posts};
    enum share_side side;
    bool fits = share_restore(&b->shares, &side, m->payer, &use);
    m->side = (uint8_t)side;
    return fits;
}

void booking_give_back(struct broker *b, const struct mail *m, uint32_t posts)
{
    struct share_use less = {.posts = posts};
    if (m->unsettled == 0) {
        less.mails = 1;
        less.bytes = store_bytes(m);
    }
    share_unbook(&b->shares, (enum share_side)m->side, m->payer, &less);
}
