/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* --- in from the wire ----------------------------------------------------------------------------
 */

/* Has the broker had this mail before?  What an earlier life of it has had is known up to the last
 * durable mail alone, and asked only of what may have come to that life. */
static bool was_had(struct broker *b, uint32_t sender, const muster_Mail *letter,
                    muster_Outcome *outcome)
{
    const struct agent *a = &b->registry.agents[sender];
    *outcome = muster_OUTCOME_DUPLICATE;
    const struct mail *m = journal_find(&b->journal, sender, letter->seq);
    if (letter->seq <= a->seq.seen) {
        /* Its answer is still to come, and a sender that hears of a duplicate asks no more: what
         * is on disk already is said to be there, lest this life ends before the answer. */
        if (m && mail_is_written(m) && m->told != TOLD_LAST &&
            scope_is_told(b->registry.agents[sender].scope)) {
            *outcome = muster_OUTCOME_STORED;
        }
        return true;
    }
    if (!letter->again || letter->seq > a->seq.durable) {
        return false;
    }
    if (m) {
        *outcome = m->told == TOLD_LAST ? (muster_Outcome)m->answer : muster_OUTCOME_STORED;
    } else if (letter->seq > a->seq.failed) {
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
    if (seq > a->seq.seen) {
        a->seq.seen = seq;
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

/* Taken once, whole, and only if there is room for it.  @return the mail, to be routed or dropped;
 * or NULL: refused, counted, and the sender told */
static struct mail *mail_admit(struct broker *b, uint32_t sender, const muster_Mail *letter)
{
    struct agent *a = &b->registry.agents[sender];
    if (strcmp(letter->src, a->name) != 0) {
        b->counters.malformed++;
        return NULL;
    }
    muster_Outcome had;
    bool known = was_had(b, sender, letter, &had);
    seen_note(b, sender, letter->seq);
    if (is_over(letter)) {
        return NULL;
    }
    if (known) {
        b->counters.duplicates_dropped++;
        outcome_tell(b, sender, letter->seq, letter->seq, had);
        return NULL;
    }
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

/* --- which way -----------------------------------------------------------------------------------
 */

/* @return whether a resolver names its receivers */
static bool mail_is_to_scheme(const struct mail *m)
{
    return m->only == MU_NONE && mu_address_kind(m->letter.dst) == MU_ADDRESS_SCHEME;
}

/* @return whether the mail is for an agent inside, or changes what is said of one */
static bool meets_run(struct broker *b, const struct mail *m)
{
    struct recipients to;
    if (mail_is_to_scheme(m)) {
        return view_resolver(b, m->letter.dst) != MU_NONE; /* only members are asked */
    }
    recipients_of_mail(b, m, &to);
    bool meets = false;
    for (uint32_t i = 0; i < to.count && !meets; i++) {
        uint32_t agent = to.agents[i];
        if (registry_is_own(agent)) { /* what changes the broker takes effect between steps, too */
            meets = m->letter.layer == 0 || recipients_has_member_change(b, m);
        } else {
            meets = view_inside(b, agent) || steps_keeps_before(b, m, agent);
        }
    }
    return meets;
}

void route_from_outside(struct broker *b, struct mail *m)
{
    if (!clock_by_steps(&b->clock) || !meets_run(b, m)) {
        (void)route_mail(b, m);
    } else if (!steps_keep(b, m, true)) {
        outcome_turn_away(b, m);
    }
}

/* One of a recording waits for the step that ends when it is due; there it is one from outside. */
static void replay_keep(struct broker *b, struct mail *m)
{
    if (b->replays.count == QUOTA_MAILS_MAX) {
        outcome_turn_away(b, m);
        return;
    }
    m->at_ns[TIMERS_DUE] = (uint64_t)m->letter.due_ns;
    m->order = ++b->orders;
    timers_add(&b->replays, m);
    outcome_stored(b, m);
}

void route_letter(struct broker *b, uint32_t sender, const muster_Mail *letter,
                  enum steps_effect effect)
{
    struct mail *m = mail_admit(b, sender, letter);
    if (!m) {
        return;
    }
    if (effect == STEPS_REPLAY && deliver_is_held(b, m)) {
        replay_keep(b, m);
    } else if (effect != STEPS_INSIDE && effect != STEPS_OUTSIDE) {
        route_from_outside(b, m);
    } else if (!steps_keep(b, m, effect == STEPS_OUTSIDE)) {
        outcome_turn_away(b, m);
    }
}

/* --- on its way ------------------------------------------------------------------------------- */

static bool mail_is_answer(uint32_t own, const struct mail *m)
{
    bool asks_state = strcmp(m->letter.performative, "state") == 0;
    return own == REGISTRY_BROKER && !asks_state && resolve_is_answer(m);
}

static void mails_pump(struct broker *b, uint32_t sender);

/* The broker's own request handlers take it. */
static void handlers_call(struct broker *b, struct mail *m, const struct recipients *to)
{
    for (uint32_t i = 0; i < to->count; i++) {
        uint32_t own = to->agents[i];
        if (!registry_is_own(own)) {
            continue;
        }
        b->counters.delivered++;
        if (mail_is_answer(own, m)) {
            mails_pump(b, resolve_take_answer(b, m));
        } else {
            handlers_take(b, own, m);
        }
    }
}

/* Goes on with a mail that need not wait for an address, or no longer.
 * @param names  fields of content: the agents that SCHEME:REST stands for; NULL: not known
 * @return as route_mail */
static bool mail_go_on(struct broker *b, struct mail *m, const char *names)
{
    struct recipients to;
    if (names) {
        recipients_of_answer(b, names, m->sender, &to);
    } else {
        recipients_of_mail(b, m, &to);
        to.unknown = mail_is_to_scheme(m) ? 1 : to.unknown;
    }
    m->order = ++b->orders;
    if (m->letter.layer == 0) {
        to.refused = authorize_mail(b, m, to.agents, &to.count);
        if (to.refused > 0) {
            ledger_alert(b, ALERT_REFUSED, REGISTRY_BROKER, m->sender);
        }
    }
    b->counters.sent += to.count + to.unknown + to.refused;
    b->counters.unknown_name += to.unknown;
    bool goes_on = to.refused == 0 || to.count > 0;
    if (m->letter.level != muster_LEVEL_RAM && !journal_takes(b)) {
        b->counters.no_store += to.count; /* the disk has failed since it was admitted */
        outcome_refuse(b, m, to.unknown, muster_OUTCOME_NO_STORE);
        return goes_on;
    }
    struct delivered done = deliver_put(b, m, &to);
    if (done.boxes >= MULTICAST_PROCESSES_MIN) {
        multicast_note(b, m);
    }
    if (done.handlers) {
        handlers_call(b, m, &to);
        deliver_conclude(b, m, &to, &done);
    }
    return goes_on;
}

/* Routes the mails of a sender that wait for a resolver's answer no longer. */
static void mails_pump(struct broker *b, uint32_t sender)
{
    struct mail *m, *answer;
    while (sender != MU_NONE && (m = resolve_next_ready(b, sender, &answer))) {
        (void)mail_go_on(b, m, answer ? answer->letter.content : NULL);
        if (answer) {
            pool_release(&b->pool, answer);
        }
    }
}

bool route_mail(struct broker *b, struct mail *m)
{
    bool plain = resolve_is_plain(&b->resolve, m);
    enum resolve_need need = plain ? RESOLVE_NOTHING : resolve_needs(b, m);
    if (need == RESOLVE_NOTHING) {
        return mail_go_on(b, m, NULL);
    }
    if (need == RESOLVE_FULL) {
        outcome_turn_away(b, m);
    } else if (ledger_charge(b, m, 1)) {
        resolve_wait(b, m);
    } else {
        b->counters.sent++;
        outcome_refuse(b, m, 0, muster_OUTCOME_BOX_FULL);
    }
    return true;
}

void route_resolve_expire(struct broker *b, uint64_t mail_ns)
{
    for (uint32_t s; (s = resolve_overdue(b, mail_ns)) != MU_NONE;) {
        mails_pump(b, s);
    }
}
