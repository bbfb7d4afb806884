/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* What is within a sender's share of the store, however full that is. */
static const struct quota_use store_floor = {.mails = 64, .bytes = 64 * 1024, .posts = 1024};

/* One in so many places of the store is for directives alone. */
enum { RESERVE_PART = 64 };

static void use_shrink(struct quota_use *use, uint32_t part)
{
    use->mails -= use->mails / part;
    use->bytes -= use->bytes / part;
    use->posts -= use->posts / part;
}

/* Books a mail on its sender's account, if that may be.
 * @param halved  both sides are in use, and have one half of the store each: the run never has more
 * @param urgent  a directive: it has no share, and a reserve that no other mail can take */
static enum quota_answer account_book(struct quota_accounts *a, enum quota_side side,
                                      uint32_t sender, const struct quota_use *want, bool halved,
                                      bool urgent)
{
    static const struct quota_use nothing;
    struct quota_use *own = &a->senders[side][sender];
    struct quota_use most = {
        .mails = MU_MAILS_MAX, .bytes = MU_MAIL_BYTES_MAX, .posts = MU_POSTS_MAX};
    if (halved || side == QUOTA_INSIDE) {
        use_shrink(&most, 2);
    }
    if (!urgent) {
        use_shrink(&most, RESERVE_PART);
    }
    enum quota_answer answer =
        quota_ask(urgent ? &nothing : own, &a->all[side], want, &most, &store_floor);
    if (answer == QUOTA_FITS) {
        quota_add(own, want);
        quota_add(&a->all[side], want);
    }
    return answer;
}

void ledger_alert(struct broker *b, enum alert_kind kind, uint32_t agent, uint32_t sender)
{
    alerts_note(&b->alerts, kind, agent, sender, b->clock.now_ns);
}

void ledger_refused(struct broker *b, const struct mail *m, uint32_t agent, enum quota_answer why,
                    uint64_t receivers)
{
    bool over = why == QUOTA_OVER;
    *(over ? &b->counters.over_share : &b->counters.box_full) += receivers;
    ledger_alert(b, over ? ALERT_OVER_QUOTA : ALERT_BOX_FULL, agent, m->sender);
}

static bool account_take(struct broker *b, struct mail *m, enum quota_side side, uint32_t posts,
                         struct quota_use *booked)
{
    struct quota_use want = {.mails = 1, .bytes = pool_bytes(m), .posts = posts};
    enum quota_answer why = account_book(&b->quotas, side, m->payer, &want,
                                         clock_by_steps(&b->clock), m->letter.layer == 0);
    if (why != QUOTA_FITS) {
        ledger_refused(b, m, REGISTRY_BROKER, why, posts);
        return false;
    }
    *booked = want;
    return true;
}

bool ledger_charge(struct broker *b, struct mail *m, uint32_t posts)
{
    m->side = (uint8_t)scope_account(b->registry.agents[m->payer].scope);
    return account_take(b, m, (enum quota_side)m->side, posts, &m->booked);
}

bool ledger_charge_veiled(struct broker *b, struct mail *m, uint32_t posts)
{
    return account_take(b, m, QUOTA_OUTSIDE, posts, &m->booked_veiled);
}

/* It had its room in an earlier life: whichever account has room for it takes it, as a directive.
 */
bool ledger_restore(struct broker *b, struct mail *m, uint32_t posts)
{
    struct quota_use want = {.mails = 1, .bytes = pool_bytes(m), .posts = posts};
    for (uint8_t side = QUOTA_OUTSIDE; side < QUOTA_SIDES; side++) {
        if (account_book(&b->quotas, side, m->payer, &want, false, true) == QUOTA_FITS) {
            m->side = side;
            m->booked = want;
            return true;
        }
    }
    return false;
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
    quota_subtract(&b->quotas.senders[side][m->payer], &less);
    quota_subtract(&b->quotas.all[side], &less);
}

void ledger_settle(struct broker *b, struct mail *m)
{
    account_give_back(b, m, (enum quota_side)m->side, m->posts.count - m->veiled, &m->booked);
    account_give_back(b, m, QUOTA_OUTSIDE, m->veiled, &m->booked_veiled);
}
