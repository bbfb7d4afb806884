/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* A sender of so many mails at a time waits for their receipts before it goes on. */
enum { RECEIPTS_MANY = MU_WINDOW_MAX / 8 };

/* @return what paces such news for a sender, or NULL */
static struct limiter *limiter_of(struct broker *b, uint32_t sender, muster_Outcome result)
{
    if (result == muster_OUTCOME_BOX_FULL || result == muster_OUTCOME_DROPPED) {
        return &b->bad_news;
    }
    bool few = receipts_mails(&b->receipts, sender) < RECEIPTS_MANY;
    return result == muster_OUTCOME_DELIVERED && few ? &b->good_news : NULL;
}

static bool news_can_wait(struct broker *b, uint32_t sender, muster_Outcome result)
{
    struct limiter *l = limiter_of(b, sender, result);
    return l && !scope_is_paced(b->registry.agents[sender].scope) &&
           limiter_holds(l, sender, b->clock.now_ns);
}

void outcome_tell(struct broker *b, uint32_t sender, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result)
{
    const struct agent *a = &b->registry.agents[sender];
    if (a->bearer == BEARER_NONE) { /* the absent are told nothing, nor is the broker */
        return;
    }
    receipts_add(&b->receipts, sender, first_seq, last_seq, result);
    if (a->process != MU_NONE && !news_can_wait(b, sender, result)) {
        processes_wake_agent(b, sender);
    }
}

uint64_t outcome_oldest_ns(const struct broker *b)
{
    const struct mail *oldest = b->arrivals.first;
    uint64_t mail_ns = clock_mail_ns(&b->clock);
    return oldest && mail_ns > oldest->came_ns ? mail_ns - oldest->came_ns : 0;
}

static void news_wake(struct broker *b, struct limiter *l)
{
    uint32_t agent;
    while ((agent = limiter_next(l, b->clock.now_ns)) != MU_NONE) {
        processes_wake_agent(b, agent);
    }
}

void outcome_tick(struct broker *b)
{
    news_wake(b, &b->bad_news);
    news_wake(b, &b->good_news);
}

void outcome_end(struct broker *b, struct mail *m, muster_Outcome result)
{
    if (mail_tell(m, TOLD_LAST)) {
        if (result != muster_OUTCOME_DELIVERED && result != muster_OUTCOME_STORED) {
            journal_failed(b, m->sender, &m->letter);
        }
        m->answer = (uint8_t)result;
        outcome_tell(b, m->sender, m->letter.seq, m->letter.seq, result);
    }
}

void outcome_refuse(struct broker *b, struct mail *m, uint32_t unknown, muster_Outcome result)
{
    outcome_end(b, m, unknown > 0 ? muster_OUTCOME_UNKNOWN_NAME : result);
    pool_release(&b->pool, m);
}

void outcome_stored(struct broker *b, struct mail *m)
{
    if (mail_tell(m, TOLD_STORED)) {
        outcome_tell(b, m->sender, m->letter.seq, m->letter.seq, muster_OUTCOME_STORED);
    }
}

/* The last word on a mail that all receivers are through with, as far as it is known here: what
 * becomes of what another broker has taken over, that broker tells. */
static void answer_settled(struct broker *b, struct mail *m)
{
    if (m->stored_ends_it) {
        outcome_end(b, m, muster_OUTCOME_STORED);
    } else if (m->fate == FATE_PASSED_ON) {
        outcome_stored(b, m);
    } else {
        outcome_end(b, m, mail_outcome(m));
    }
}

void outcome_settle(struct broker *b, struct mail *m)
{
    ledger_settle(b, m);
    if (m->row > 0) {
        journal_settled(b, m);
    }
    if (m->posts.count == 0) {
        timers_remove(&b->due, m);
        timers_remove(&b->expiry, m);
        pool_list_remove(&b->arrivals, m);
        answer_settled(b, m);
        pool_release(&b->pool, m);
    }
}

/* --- no room, or no receiver ---------------------------------------------------------------- */

/* Counts the agents that a mail does not reach. */
static void receivers_count(struct broker *b, const struct mail *m, struct recipients *to)
{
    recipients_of_mail(b, m, to);
    b->counters.sent += to->count + to->unknown;
    b->counters.unknown_name += to->unknown;
}

void outcome_turn_away(struct broker *b, struct mail *m)
{
    struct recipients to;
    receivers_count(b, m, &to);
    ledger_refused(b, m, REGISTRY_BROKER, QUOTA_OVER, to.count);
    outcome_refuse(b, m, to.unknown, muster_OUTCOME_BOX_FULL);
}

void outcome_drop(struct broker *b, struct mail *m)
{
    struct recipients to;
    receivers_count(b, m, &to);
    b->counters.dropped += to.count;
    outcome_refuse(b, m, 0, muster_OUTCOME_DROPPED);
}

void outcome_admit_due(struct broker *b, uint64_t run_ns)
{
    struct mail *m;
    while (b->clock.runs && (m = timers_first(&b->due)) && m->at_ns[TIMERS_DUE] <= run_ns) {
        timers_remove(&b->due, m);
        MU_LIST_EACH (post, &m->posts, MU_LINKS(b->mailbox.posts, links[LINKS_MAIL])) {
            mailbox_admit(&b->mailbox, post);
            processes_wake_agent(b, b->mailbox.posts[post].agent);
        }
    }
}

/* --- its end ---------------------------------------------------------------------------------- */

void outcome_acknowledge(struct broker *b, uint32_t agent, uint64_t number)
{
    struct box *box = &b->mailbox.boxes[agent];
    if (number > mailbox_last_number(&b->mailbox, agent)) { /* it cannot have had that */
        b->counters.malformed++;
        return;
    }
    if (!box->begun || number <= box->acked) {
        return;
    }
    bool beyond = names_is_beyond(&b->registry, &b->processes, agent);
    while (box->acked < number) {
        struct mail *m = mailbox_pop(&b->mailbox, agent);
        if (mail_is_written(m)) {
            journal_acknowledged(b, agent);
        }
        if (beyond) {
            mail_meets(m, FATE_PASSED_ON);
            b->federation.count.passed_on++;
        } else {
            b->counters.delivered++;
        }
        outcome_settle(b, m);
    }
    uint32_t flying = box->lists[POST_FLIGHT].posts.count;
    if (flying > 0 && !scope_is_paced(b->registry.agents[agent].scope)) {
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
    }
    if (box->use.mails > flying || box->out != MU_NONE) { /* more may go now */
        processes_wake_agent(b, agent);
    }
}

/* A mail leaves all boxes in which it waits. */
static void posts_leave(struct broker *b, struct mail *m, enum mail_fate fate, uint64_t *counter)
{
    uint32_t next = MU_NONE;
    pool_keep(m);
    for (uint32_t post = mu_list_first(&m->posts); post != MU_NONE; post = next) {
        next = mailbox_sibling(&b->mailbox, post);
        if (b->mailbox.posts[post].list != POST_FLIGHT) {
            mailbox_withdraw(&b->mailbox, post);
            ++*counter;
            mail_meets(m, fate);
            outcome_settle(b, m);
        }
    }
    pool_release(&b->pool, m);
}

void outcome_expire(struct broker *b, uint64_t mail_ns)
{
    struct mail *m;
    while ((m = timers_first(&b->expiry)) && m->at_ns[TIMERS_EXPIRY] <= mail_ns) {
        timers_remove(&b->expiry, m);
        posts_leave(b, m, FATE_EXPIRED, &b->counters.expired);
    }
}

void outcome_on_disk(struct broker *b, struct mail *m)
{
    if (m->tell_stored && m->stored_ends_it) {
        outcome_end(b, m, muster_OUTCOME_STORED);
    } else if (m->tell_stored) {
        outcome_stored(b, m);
    }
    m->tell_stored = false;
}

void outcome_undo(struct broker *b, struct mail *m)
{
    outcome_end(b, m, muster_OUTCOME_NO_STORE);
    posts_leave(b, m, FATE_DROPPED, &b->counters.no_store);
}

/* So long the broker keeps receipts for senders of an earlier life of it, and for those that have
 * fallen silent: they may come back. */
static const uint64_t AWAIT_NS = 10000000000;

static void await_until(struct journal *j, uint64_t until_ns)
{
    j->awaits_ns = j->awaits_ns < until_ns ? j->awaits_ns : until_ns;
}

void outcome_await(struct broker *b, uint32_t agent)
{
    names_bearer_on(&b->registry, agent, BEARER_AWAITS);
    if (b->clock.now_ns <= UINT64_MAX - AWAIT_NS) {
        await_until(&b->journal, b->clock.now_ns + AWAIT_NS);
    }
}

void outcome_await_tick(struct broker *b)
{
    if (b->clock.now_ns < b->journal.awaits_ns) {
        return;
    }
    b->journal.awaits_ns = UINT64_MAX;
    uint64_t wall_ns = clock_wall_ns(&b->clock);
    for (uint32_t i = 0; i < b->registry.count; i++) {
        const struct agent *a = &b->registry.agents[i];
        uint64_t absent_ns = wall_ns - a->since_wall_ns;
        if (a->bearer == BEARER_AWAITED && absent_ns < AWAIT_NS) {
            await_until(&b->journal, b->clock.now_ns + (AWAIT_NS - absent_ns));
        } else if (a->bearer == BEARER_AWAITED) {
            names_bearer_on(&b->registry, i, BEARER_FORGETS);
            receipts_drop(&b->receipts, i, receipts_count(&b->receipts, i));
        }
    }
}
