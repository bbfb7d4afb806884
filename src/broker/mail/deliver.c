/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* Takes those outside out of it: they are not reached. */
static void recipients_unveil(const struct broker *b, const struct mail *m, struct recipients *to)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < to->count; i++) {
        if (!recipients_veils(&b->registry, m, to->agents[i])) {
            to->agents[kept++] = to->agents[i];
        }
    }
    to->count = kept;
}

static bool mail_book(struct broker *b, struct mail *m, struct recipients *to)
{
    to->veiled = 0;
    for (uint32_t i = 0; i < to->count; i++) {
        to->veiled += recipients_veils(&b->registry, m, to->agents[i]);
    }
    if (ledger_charge(b, m, to->count - to->veiled)) {
        if (to->veiled > 0 && !ledger_charge_veiled(b, m, to->veiled)) {
            recipients_unveil(b, m, to);
        }
        return true;
    }
    b->counters.box_full += to->veiled; /* the others have been counted */
    outcome_refuse(b, m, to->unknown, muster_OUTCOME_BOX_FULL);
    return false;
}

/* --- one box ---------------------------------------------------------------------------------- */

/* A mail goes out of a box to make room. */
static void post_drop(struct broker *b, uint32_t victim, uint32_t agent)
{
    struct mail *m = b->mailbox.posts[victim].mail;
    mailbox_withdraw(&b->mailbox, victim);
    b->counters.dropped++;
    ledger_alert(b, ALERT_DROPPED, agent, m->sender);
    mail_meets(m, FATE_DROPPED);
    outcome_settle(b, m);
}

/* Puts it into one box.  @return false when that has no room for it */
static bool post_put(struct broker *b, struct mail *m, uint32_t agent, bool held)
{
    uint32_t victim = MU_NONE;
    if (!b->mailbox.boxes[agent].begun) {
        names_tell_number(&b->registry, &b->processes, agent);
    }
    enum mailbox_room room = quota_box_ask(&b->mailbox, agent, m, &victim);
    for (; room == MAILBOX_ROOM_DROP; room = quota_box_ask(&b->mailbox, agent, m, &victim)) {
        post_drop(b, victim, agent);
    }
    if (room != MAILBOX_ROOM_FITS || mailbox_put(&b->mailbox, agent, m, held) != MU_OK) {
        ledger_refused(b, m, agent, room == MAILBOX_ROOM_OVER_QUOTA ? QUOTA_OVER : QUOTA_FULL, 1);
        return false;
    }
    if (recipients_veils(&b->registry, m, agent)) {
        mailbox_veil(&b->mailbox, m);
    }
    processes_wake_agent(b, agent);
    return true;
}

/* --- all of them ------------------------------------------------------------------------------ */

bool deliver_is_held(const struct broker *b, const struct mail *m)
{
    return m->letter.due_ns >= 0 &&
           (!b->clock.runs || (uint64_t)m->letter.due_ns > clock_run_ns(&b->clock));
}

static void deliver_schedule(struct broker *b, struct mail *m, bool held, uint64_t left_ns)
{
    uint64_t now_ns = clock_mail_ns(&b->clock);
    m->came_ns = now_ns;
    pool_list_append(&b->arrivals, m);
    if (held) {
        m->at_ns[TIMERS_DUE] = (uint64_t)m->letter.due_ns;
        timers_add(&b->due, m);
    }
    if (m->letter.ttl_ns > 0 && now_ns + left_ns >= now_ns) {
        m->at_ns[TIMERS_EXPIRY] = now_ns + left_ns;
        timers_add(&b->expiry, m);
    }
}

void deliver_conclude(struct broker *b, struct mail *m, const struct recipients *to,
                      const struct delivered *done)
{
    bool is_ram = m->letter.level == muster_LEVEL_RAM;
    if (to->refused > 0) {
        outcome_end(b, m, muster_OUTCOME_REFUSED);
    } else if (to->unknown > 0) {
        outcome_end(b, m, muster_OUTCOME_UNKNOWN_NAME);
    } else if (!done->fits) {
        outcome_end(b, m, muster_OUTCOME_BOX_FULL);
    } else if (to->veiled > 0 && (m->posts.count == 0 || is_ram)) {
        outcome_end(b, m, muster_OUTCOME_STORED);
    } else if (to->veiled > 0) {
        m->stored_ends_it = m->tell_stored = true;
    } else if (m->posts.count == 0) {
        outcome_end(b, m, muster_OUTCOME_DELIVERED);
    } else if (done->stored && !is_ram) {
        m->tell_stored = true; /* when it is */
    } else if (done->stored) {
        outcome_stored(b, m);
    }
    pool_release(&b->pool, m);
}

struct delivered deliver_put(struct broker *b, struct mail *m, struct recipients *to)
{
    bool held = deliver_is_held(b, m);
    struct delivered done = {.fits = true, .stored = held};
    if (!mail_book(b, m, to)) {
        return done;
    }
    enum mailbox_gate needs = m->letter.layer == 0 ? GATE_URGENT : GATE_OPEN;
    for (uint32_t i = 0; i < to->count; i++) {
        uint32_t agent = to->agents[i];
        if (registry_is_own(agent)) {
            done.handlers = true;
        } else if (!post_put(b, m, agent, held)) {
            done.fits = done.fits && recipients_veils(&b->registry, m, agent);
        } else {
            done.stored = done.stored || names_gate(&b->registry, &b->processes, agent) < needs;
        }
    }
    if (m->posts.count < to->count || m->posts.count == 0 || to->veiled > 0) {
        ledger_settle(b, m); /* it is in fewer boxes than were booked, or on both accounts */
    }
    pool_keep(m); /* what a handler answers may drop it from all boxes again */
    if (m->posts.count == 0) {
        pool_release(&b->pool, m);
    } else {
        deliver_schedule(b, m, held, m->letter.ttl_ns);
        if (b->journal.on) {
            journal_put(b, m);
        }
    }
    done.boxes = m->posts.count;
    if (!done.handlers) {
        deliver_conclude(b, m, to, &done);
    }
    return done;
}

void deliver_send(struct broker *b, uint32_t receiver, const muster_Mail *letter)
{
    struct recipients to;
    to.count = 1;
    to.unknown = to.refused = 0;
    to.agents[0] = receiver;
    struct mail *m = pool_put(&b->pool, letter);
    b->counters.sent++;
    if (!m) {
        b->counters.box_full++;
        ledger_alert(b, ALERT_BOX_FULL, REGISTRY_BROKER, REGISTRY_BROKER);
        return;
    }
    m->sender = REGISTRY_BROKER;
    m->payer = receiver; /* an agent that asks much must not use up what answers to others need */
    m->order = ++b->orders;
    (void)deliver_put(b, m, &to);
}

bool deliver_restore(struct broker *b, struct mail *m, const char *waiting, uint64_t left_ns)
{
    struct recipients to = {.count = 0};
    recipients_of_names(b, waiting, m->sender, &to);
    m->order = ++b->orders;
    bool held = deliver_is_held(b, m);
    b->counters.sent += to.count;
    /* It had its room: its sender's share, and the limits of boxes, do not take that. */
    if (to.count == 0 || !ledger_restore(b, m, to.count)) {
        b->counters.box_full += to.count;
        pool_release(&b->pool, m);
        return false;
    }
    for (uint32_t i = 0; i < to.count; i++) {
        bool fits = mailbox_put(&b->mailbox, to.agents[i], m, held) == MU_OK;
        b->counters.box_full += !fits;
    }
    ledger_settle(b, m);
    if (m->posts.count == 0) {
        pool_release(&b->pool, m);
        return false;
    }
    deliver_schedule(b, m, held, left_ns);
    return true;
}
