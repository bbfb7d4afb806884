/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mail/mail.h"

#include "broker/control/parts.h"

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

static bool account_take(struct broker *b, struct mail *m, enum share_side side, uint32_t posts,
                         struct share_use *booked)
{
    struct share_use want = {.mails = 1, .bytes = store_bytes(m), .posts = posts};
    enum share_answer why =
        share_book(&b->shares, side, m->payer, &want, b->lockstep.on, m->letter.layer == 0);
    if (why != SHARE_FITS) {
        booking_refused(b, m, REGISTRY_BROKER, why, posts);
        return false;
    }
    *booked = want;
    return true;
}

bool booking_take(struct broker *b, struct mail *m, uint32_t posts)
{
    m->side = names_in_lockstep(b, m->payer) ? SHARE_LOCKSTEP : SHARE_OUTSIDE;
    return account_take(b, m, (enum share_side)m->side, posts, &m->booked);
}

bool booking_take_veiled(struct broker *b, struct mail *m, uint32_t posts)
{
    return account_take(b, m, SHARE_OUTSIDE, posts, &m->booked_veiled);
}

bool booking_restore(struct broker *b, struct mail *m, uint32_t posts)
{
    enum share_side side;
    m->booked = (struct share_use){.mails = 1, .bytes = store_bytes(m), .posts = posts};
    bool fits = share_restore(&b->shares, &side, m->payer, &m->booked);
    m->side = (uint8_t)side;
    if (!fits) {
        m->booked = (struct share_use){0};
    }
    return fits;
}

/* left: posts that stay; the mail stays with them */
static void account_give_back(struct broker *b, const struct mail *m, enum share_side side,
                              uint32_t left, struct share_use *booked)
{
    struct share_use less = *booked;
    if (left > 0) {
        less = (struct share_use){.posts = booked->posts - left};
    }
    share_subtract(booked, &less);
    share_unbook(&b->shares, side, m->payer, &less);
}

void booking_give_back(struct broker *b, struct mail *m)
{
    account_give_back(b, m, (enum share_side)m->side, m->unsettled - m->veiled, &m->booked);
    account_give_back(b, m, SHARE_OUTSIDE, m->veiled, &m->booked_veiled);
}
