/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mail/mail.h"

#include "broker/control/parts.h"

void ledger_alert(struct broker *b, enum alert_kind kind, uint32_t agent, uint32_t sender)
{
    struct alert event = {
        .agent = agent, .sender = sender, .count = 1, .at_ns = b->clock.now_ns, .kind = kind};
    alerts_note(&b->alerts, &event);
}

void ledger_refused(struct broker *b, const struct mail *m, uint32_t agent, enum quota_answer why,
                    uint64_t receivers)
{
    bool over = why == QUOTA_OVER;
    *(over ? &b->counters.over_share : &b->counters.box_full) += receivers;
    ledger_alert(b, over ? ALERT_OVER_SHARE : ALERT_BOX_FULL, agent, m->sender);
}

static bool account_take(struct broker *b, struct mail *m, enum quota_side side, uint32_t posts,
                         struct quota_use *booked)
{
    struct quota_use want = {.mails = 1, .bytes = pool_bytes(m), .posts = posts};
    enum quota_answer why = quota_book(&b->quotas, side, m->payer, &want, clock_by_steps(&b->clock),
                                       m->letter.layer == 0);
    if (why != QUOTA_FITS) {
        ledger_refused(b, m, REGISTRY_BROKER, why, posts);
        return false;
    }
    *booked = want;
    return true;
}

bool ledger_charge(struct broker *b, struct mail *m, uint32_t posts)
{
    m->side = (uint8_t)scope_account(registry_scope(&b->registry, m->payer));
    return account_take(b, m, (enum quota_side)m->side, posts, &m->booked);
}

bool ledger_charge_veiled(struct broker *b, struct mail *m, uint32_t posts)
{
    return account_take(b, m, QUOTA_OUTSIDE, posts, &m->booked_veiled);
}

bool ledger_restore(struct broker *b, struct mail *m, uint32_t posts)
{
    enum quota_side side;
    m->booked = (struct quota_use){.mails = 1, .bytes = pool_bytes(m), .posts = posts};
    bool fits = quota_restore(&b->quotas, &side, m->payer, &m->booked);
    m->side = (uint8_t)side;
    if (!fits) {
        m->booked = (struct quota_use){0};
    }
    return fits;
}

/* left: posts that stay; the mail stays with them */
static void account_give_back(struct broker *b, const struct mail *m, enum quota_side side,
                              uint32_t left, struct quota_use *booked)
{
    struct quota_use less = *booked;
    if (left > 0) {
        less = (struct quota_use){.posts = booked->posts - left};
    }
    quota_subtract(booked, &less);
    quota_unbook(&b->quotas, side, m->payer, &less);
}

void ledger_settle(struct broker *b, struct mail *m)
{
    account_give_back(b, m, (enum quota_side)m->side, m->unsettled - m->veiled, &m->booked);
    account_give_back(b, m, QUOTA_OUTSIDE, m->veiled, &m->booked_veiled);
}
