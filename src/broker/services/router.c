/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/router.h"

#include "broker/control/parts.h"
#include "broker/directory/guard.h"
#include "broker/mail/booking.h"
#include "broker/mail/outcome.h"
#include "broker/mail/posting.h"
#include "broker/membership/presence.h"
#include "broker/services/desk.h"
#include "broker/services/query.h"
#include "core/address.h"

#include <string.h>

/* Mail for an agent beyond another broker waits there. */
enum mailbox_gate router_gate(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    if (a->process == MU_NONE) {
        return GATE_SHUT;
    }
    switch (a->is.state) {
    case muster_STATE_STANDBY:
    case muster_STATE_RUNNING: return GATE_OPEN;
    case muster_STATE_SUSPENDED: return presence_is_beyond(b, agent) ? GATE_OPEN : GATE_URGENT;
    case muster_STATE_MOVING: return presence_is_beyond(b, agent) ? GATE_OPEN : GATE_SHUT;
    case muster_STATE_ABSENT: break;
    }
    return GATE_SHUT;
}

/* @return whether it is for whom a resolver names */
static bool mail_is_to_scheme(const struct mail *m)
{
    return m->only == MU_NONE && mu_address_kind(m->letter.dst) == MU_ADDRESS_SCHEME;
}

bool router_meets_lockstep(struct broker *b, const struct mail *m)
{
    struct audience to;
    if (mail_is_to_scheme(m)) {
        return resolve_is_possible(b, m->letter.dst); /* only members of the lock step are asked */
    }
    audience_of_mail(b, m, &to);
    bool meets = false;
    for (uint32_t i = 0; i < to.count && !meets; i++) {
        uint32_t agent = to.agents[i];
        if (registry_is_own(agent)) { /* what changes the broker takes effect between steps, too */
            meets = m->letter.layer == 0 || query_changes_member(b, m);
        } else {
            meets = presence_in_lockstep(b, agent) || lockstep_keeps_before(b, m, agent);
        }
    }
    return meets;
}

/* --- on its way ------------------------------------------------------------------------------- */

/* The disk has failed since it was admitted. */
static void mail_unstored(struct broker *b, struct mail *m, const struct audience *to)
{
    b->counters.no_store += to->count;
    outcome_refuse(b, m, to->unknown, muster_OUTCOME_NO_STORE);
}

bool router_route(struct broker *b, struct mail *m)
{
    enum resolve_need need = resolve_needs(b, m);
    if (need == RESOLVE_NOTHING) {
        return router_go_on(b, m, NULL);
    }
    if (need == RESOLVE_FULL) {
        router_turn_away(b, m);
    } else if (booking_take(b, m, 1)) {
        resolve_wait(b, m);
    } else {
        b->counters.sent++;
        outcome_refuse(b, m, 0, muster_OUTCOME_BOX_FULL);
    }
    return true;
}

static bool mail_is_answer(uint32_t own, const struct mail *m)
{
    bool asks_state = m->letter.layer == 2 && strcmp(m->letter.performative, "state") == 0;
    return own == REGISTRY_BROKER && m->letter.layer != 0 && !asks_state && resolve_is_answer(m);
}

/* The broker's own desks take it. */
static void desks_take(struct broker *b, struct mail *m, const struct audience *to)
{
    for (uint32_t i = 0; i < to->count; i++) {
        uint32_t own = to->agents[i];
        if (!registry_is_own(own)) {
            continue;
        }
        b->counters.delivered++;
        if (mail_is_answer(own, m)) {
            router_pump(b, resolve_take_answer(b, m));
        } else {
            desk_take(b, own, m);
        }
    }
}

void router_pump(struct broker *b, uint32_t sender)
{
    struct mail *m, *answer;
    while (sender != MU_NONE && (m = resolve_next_ready(b, sender, &answer))) {
        (void)router_go_on(b, m, answer ? answer->letter.content : NULL);
        if (answer) {
            store_release(&b->store, answer);
        }
    }
}

void router_resolve_expire(struct broker *b, uint64_t mail_ns)
{
    for (uint32_t s; (s = resolve_overdue(b, mail_ns)) != MU_NONE;) {
        router_pump(b, s);
    }
}

void router_resolve_give_up(struct broker *b)
{
    for (uint32_t s; (s = resolve_give_up(b)) != MU_NONE;) {
        router_pump(b, s);
    }
}

bool router_go_on(struct broker *b, struct mail *m, const char *names)
{
    struct audience to;
    if (names) {
        audience_of_answer(b, names, m->sender, &to);
    } else {
        audience_of_mail(b, m, &to);
        to.unknown = mail_is_to_scheme(m) ? 1 : to.unknown;
    }
    m->order = ++b->orders;
    if (m->letter.layer == 0) {
        to.refused = guard_sift(b, m, to.agents, &to.count);
        if (to.refused > 0) {
            booking_event(b, EVENT_REFUSED, REGISTRY_BROKER, m->sender);
        }
    }
    b->counters.sent += to.count + to.unknown + to.refused;
    b->counters.unknown_name += to.unknown;
    bool goes_on = to.refused == 0 || to.count > 0;
    if (m->letter.level != muster_LEVEL_RAM && !journal_takes(b)) {
        mail_unstored(b, m, &to);
    } else if (posting_book(b, m, &to)) {
        struct posted done = posting_put(b, m, &to);
        desks_take(b, m, &to);
        posting_conclude(b, m, &to, &done);
    }
    return goes_on;
}

/* Counts those whom a mail does not reach. */
static void receivers_count(struct broker *b, const struct mail *m, struct audience *to)
{
    audience_of_mail(b, m, to);
    b->counters.sent += to->count + to->unknown;
    b->counters.unknown_name += to->unknown;
}

void router_turn_away(struct broker *b, struct mail *m)
{
    struct audience to;
    receivers_count(b, m, &to);
    booking_refused(b, m, REGISTRY_BROKER, SHARE_OVER, to.count);
    outcome_refuse(b, m, to.unknown, muster_OUTCOME_BOX_FULL);
}

void router_drop(struct broker *b, struct mail *m)
{
    struct audience to;
    receivers_count(b, m, &to);
    b->counters.dropped += to.count;
    outcome_refuse(b, m, 0, muster_OUTCOME_DROPPED);
}

void router_post(struct broker *b, uint32_t receiver, const muster_Mail *letter)
{
    struct audience to;
    to.count = 1;
    to.unknown = to.refused = 0;
    to.agents[0] = receiver;
    struct mail *m = store_put(&b->store, letter);
    b->counters.sent++;
    if (!m) {
        b->counters.box_full++;
        booking_event(b, EVENT_BOX_FULL, REGISTRY_BROKER, REGISTRY_BROKER);
        return;
    }
    m->sender = REGISTRY_BROKER;
    m->payer = receiver; /* who asks much must not use up what answers to others need */
    m->order = ++b->orders;
    if (posting_book(b, m, &to)) {
        struct posted done = posting_put(b, m, &to);
        posting_conclude(b, m, &to, &done);
    }
}

void router_admit_due(struct broker *b, uint64_t run_ns)
{
    struct mail *m;
    while (b->clock.runs && (m = schedule_first(&b->due)) && m->at_ns[SCHEDULE_DUE] <= run_ns) {
        schedule_remove(&b->due, m);
        for (uint32_t post = m->posts; post != MU_NONE;
             post = b->mailbox.posts[post].sibling_next) {
            mailbox_admit(&b->mailbox, post);
            tenants_wake(&b->registry, &b->places, b->mailbox.posts[post].agent);
        }
    }
}

/* --- its end ---------------------------------------------------------------------------------- */

void router_acknowledge(struct broker *b, uint32_t agent, uint64_t number)
{
    if (!mailbox_number_valid(&b->mailbox, agent, number)) {
        b->counters.malformed++;
        return;
    }
    if (!mailbox_is_begun(&b->mailbox, agent)) {
        return;
    }
    struct box *box = mailbox_box(&b->mailbox, agent);
    if (number <= box->acked) {
        return;
    }
    bool beyond = presence_is_beyond(b, agent);
    presence_seated(b, agent, number);
    while (box->acked < number) {
        struct mail *m = mailbox_pop(&b->mailbox, agent);
        m->passed_on = m->passed_on || beyond;
        journal_acknowledged(b, agent, m);
        *(beyond ? &b->liaison.count.passed_on : &b->counters.delivered) += 1;
        outcome_settle(b, m);
    }
    if (!presence_is_paced(b, agent)) {
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
    }
    tenants_wake(&b->registry, &b->places, agent);
}

void router_expire(struct broker *b, uint64_t mail_ns)
{
    struct mail *m;
    while ((m = schedule_first(&b->expiry)) && m->at_ns[SCHEDULE_EXPIRY] <= mail_ns) {
        schedule_remove(&b->expiry, m);
        uint32_t next = MU_NONE;
        store_keep(m);
        for (uint32_t post = m->posts; post != MU_NONE; post = next) {
            next = b->mailbox.posts[post].sibling_next;
            if (b->mailbox.posts[post].list != POST_FLIGHT) {
                mailbox_withdraw(&b->mailbox, post);
                b->counters.expired++;
                m->expired = true;
                outcome_settle(b, m);
            }
        }
        store_release(&b->store, m);
    }
}

/* --- on disk ---------------------------------------------------------------------------------- */

void router_stored(struct broker *b, struct mail *m)
{
    if (m->tell_stored && m->stored_ends_it) {
        outcome_end(b, m, muster_OUTCOME_STORED);
    } else if (m->tell_stored) {
        outcome_stored(b, m);
    }
    m->tell_stored = false;
}

void router_undo(struct broker *b, struct mail *m)
{
    uint32_t next = MU_NONE;
    for (uint32_t post = m->posts; post != MU_NONE; post = next) {
        next = b->mailbox.posts[post].sibling_next;
        mailbox_withdraw(&b->mailbox, post);
        b->counters.waiting--;
        b->counters.no_store++;
        m->unsettled--;
        booking_give_back(b, m);
    }
    MU_ASSERT(m->unsettled == 0);
    schedule_remove(&b->due, m);
    schedule_remove(&b->expiry, m);
    ages_remove(&b->ages, m);
    outcome_end(b, m, muster_OUTCOME_NO_STORE);
    store_release(&b->store, m);
}

bool router_restore(struct broker *b, struct mail *m, const char *waiting, uint64_t left_ns)
{
    struct audience to = {.count = 0};
    audience_of_names(b, waiting, m->sender, &to);
    m->order = ++b->orders;
    bool held = posting_is_held(b, m);
    b->counters.sent += to.count;
    /* It had its room: its sender's share, and the limits of boxes, do not take that. */
    if (to.count == 0 || !booking_restore(b, m, to.count)) {
        b->counters.box_full += to.count;
        store_release(&b->store, m);
        return false;
    }
    for (uint32_t i = 0; i < to.count; i++) {
        if (mailbox_put(&b->mailbox, to.agents[i], m, held) == MU_OK) {
            b->counters.waiting++;
            m->unsettled++;
        } else {
            b->counters.box_full++;
        }
    }
    booking_give_back(b, m);
    if (m->unsettled == 0) {
        store_release(&b->store, m);
        return false;
    }
    posting_schedule(b, m, held, left_ns);
    return true;
}
