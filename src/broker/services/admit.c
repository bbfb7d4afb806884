/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/services.h"

#include "broker/control/parts.h"

#include <string.h>

/* Has the broker had this mail before?  What an earlier life of it has had is known up to the last
 * durable mail alone, and asked only of what may have come to that life. */
static bool was_had(const struct broker *b, uint32_t sender, const muster_Mail *letter,
                    muster_Outcome *outcome)
{
    const struct agent *a = &b->registry.agents[sender];
    *outcome = muster_OUTCOME_DUPLICATE;
    const struct mail *m = journal_find(&b->journal, sender, letter->seq);
    if (letter->seq <= a->seen_seq) {
        /* Its answer is still to come, and a sender that hears of a duplicate asks no more: what
         * is on disk already is said to be there, lest this life ends before the answer. */
        if (m && mail_is_written(m) && m->told != TOLD_LAST &&
            scope_is_told(registry_scope(&b->registry, sender))) {
            *outcome = muster_OUTCOME_STORED;
        }
        return true;
    }
    if (!letter->again || letter->seq > a->durable_seq) {
        return false;
    }
    if (m) {
        *outcome = m->told == TOLD_LAST ? (muster_Outcome)m->answer : muster_OUTCOME_STORED;
    } else if (letter->seq > a->failed_seq) {
        *outcome = muster_OUTCOME_DELIVERED; /* of the others, how they ended is not known */
    }
    return true;
}

/* Its sender has had the last word on it, of another broker or an earlier life of this one.
 * @return whether its number alone counts: what follows it is not taken before */
static bool is_over(const muster_Mail *letter)
{
    return letter->again && letter->dst[0] == '\0';
}

/* What is said of it is said once: one that asks again has a duplicate. */
static void seen_note(struct broker *b, uint32_t sender, uint64_t seq)
{
    struct agent *a = &b->registry.agents[sender];
    if (seq > a->seen_seq) {
        a->seen_seq = seq;
        if (b->journal.on) {
            journal_seq(b, sender);
        }
    }
}

/* There is no room for it, for any receiver. */
static void turn_away(struct broker *b, uint32_t sender, const muster_Mail *letter,
                      uint64_t *counter, muster_Outcome outcome)
{
    struct recipients to;
    recipients_of_letter(b, letter, sender, &to);
    b->counters.sent += to.count + to.unknown;
    *counter += to.count + to.unknown;
    journal_failed(b, sender, letter);
    outcome_tell(b, sender, letter->seq, letter->seq, outcome);
}

struct mail *admit_mail(struct broker *b, uint32_t sender, const muster_Mail *letter)
{
    struct agent *a = &b->registry.agents[sender];
    if (strcmp(letter->src, a->name) != 0) {
        b->counters.malformed++;
        return NULL;
    }
    if (is_over(letter)) {
        seen_note(b, sender, letter->seq);
        return NULL;
    }
    muster_Outcome had;
    if (was_had(b, sender, letter, &had)) {
        b->counters.duplicates_dropped++;
        outcome_tell(b, sender, letter->seq, letter->seq, had);
        seen_note(b, sender, letter->seq);
        return NULL;
    }
    seen_note(b, sender, letter->seq);
    if (!mu_address_valid(letter->dst)) {
        b->counters.malformed++;
        journal_failed(b, sender, letter);
        outcome_tell(b, sender, letter->seq, letter->seq, muster_OUTCOME_REFUSED);
        return NULL;
    }
    if (letter->level != muster_LEVEL_RAM && !journal_takes(b)) {
        turn_away(b, sender, letter, &b->counters.no_store, muster_OUTCOME_NO_STORE);
        return NULL;
    }
    struct mail *m = pool_put(&b->pool, letter);
    if (!m) {
        ledger_alert(b, ALERT_BOX_FULL, REGISTRY_BROKER, sender);
        turn_away(b, sender, letter, &b->counters.box_full, muster_OUTCOME_BOX_FULL);
        return NULL;
    }
    m->sender = m->payer = sender;
    return m;
}
