/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mail/mail.h"

#include "broker/control/parts.h"

/* @return whether the news can wait: its sender sends what does not get through */
static bool news_can_wait(struct broker *b, uint32_t sender, muster_Outcome result)
{
    bool bad = result == muster_OUTCOME_BOX_FULL || result == muster_OUTCOME_DROPPED;
    return bad && !scope_is_paced(registry_scope(&b->registry, sender)) &&
           limiter_holds(&b->limiter, sender, b->clock.now_ns);
}

void outcome_tell(struct broker *b, uint32_t sender, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result)
{
    const struct agent *a = &b->registry.agents[sender];
    if (a->process == MU_NONE && !a->awaited) { /* the absent are told nothing, nor is the broker */
        return;
    }
    receipts_add(&b->receipts, sender, first_seq, last_seq, result);
    if (a->process != MU_NONE && !news_can_wait(b, sender, result)) {
        residents_wake(&b->registry, &b->processes, sender);
    }
}

void outcome_tick(struct broker *b)
{
    uint32_t agent;
    while ((agent = limiter_next(&b->limiter, b->clock.now_ns)) != MU_NONE) {
        residents_wake(&b->registry, &b->processes, agent);
    }
}

void outcome_end(struct broker *b, struct mail *m, muster_Outcome result)
{
    if (mail_told_on(m, TOLD_ENDS)) {
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
    if (mail_told_on(m, TOLD_STORES)) {
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

/* --- one receiver less ------------------------------------------------------------------------ */

void outcome_settle(struct broker *b, struct mail *m)
{
    b->counters.waiting--;
    MU_ASSERT(m->unsettled > 0);
    m->unsettled--;
    ledger_settle(b, m);
    journal_settled(b, m);
    if (m->unsettled == 0) {
        timers_remove(&b->due, m);
        timers_remove(&b->expiry, m);
        arrivals_remove(&b->arrivals, m);
        answer_settled(b, m);
        pool_release(&b->pool, m);
    }
}
