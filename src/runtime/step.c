/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A control step in its fixed order: directives, percepts, mail, acting, one answer.
 *
 * docs/lockstep.md has the whole protocol; here is a process's side of it.
 */
#include "bus/wire/percept.h"
#include "core/clock.h"
#include "runtime/process.h"

#include <string.h>

/* @return whether an item is the next one of its box; then its number is noted */
static bool number_take(struct mu_agent *a, uint64_t number, uint64_t now_ns)
{
    if (number <= a->last_number) {
        ack_delay_add(&a->process->ack_delay, now_ns);
        a->acked_number = 0; /* it came again, so our acknowledgement was lost: say it again */
        return false;
    }
    /* Where a number is missing, the broker will begin there again; a new life begins anywhere. */
    if (a->in_order && number != a->last_number + 1) {
        return false;
    }
    ack_delay_add(&a->process->ack_delay, now_ns);
    a->in_order = true;
    a->last_number = number;
    return true;
}

/* @return whether it has only begun: mail before its verdict was for an earlier agent of its name,
 * and may begin behind a mail that came when no such agent was there */
static bool awaits_verdict(const struct mu_agent *a)
{
    return a->name_state != NAME_ACCEPTED && !a->in_order;
}

/* @return whether an item is to be handed over; either way it is acknowledged */
static bool item_take(struct mu_agent *a, const muster_Parcel *item, uint64_t now_ns)
{
    const muster_Mail *m = &item->letter;
    /* Mail to an agent that has begun to move is for its next life. */
    if (!a || a->state == MU_GONE || a->state == MU_MOVING || awaits_verdict(a)) {
        return false;
    }
    if (a->name_state != NAME_REFUSED) {
        queue_add(a, QUEUE_ACK);
    }
    bool had = item->number <= a->last_number;
    if (!number_take(a, item->number, now_ns)) {
        if (had && !dedup_has(a->dedup, m)) {
            dedup_add(a->dedup, m); /* by an earlier life of the agent */
        }
        return false;
    }
    /* Mail through another broker may have come by two routes; each broker numbers its own mail. */
    bool may_repeat = m->again || (m->hops > 0 && strcmp(m->src, "broker") != 0);
    if (may_repeat && dedup_has(a->dedup, m)) {
        a->repeats++;
        return false;
    }
    dedup_add(a->dedup, m);
    a->handed++;
    return true;
}

/* Marks the items that are to be handed over.  @return how many items were looked at */
static uint32_t items_mark(mu_process *p, const muster_Delivery *d)
{
    uint32_t count = d->parcels._length < PROCESS_ITEMS ? d->parcels._length : PROCESS_ITEMS;
    for (uint32_t i = 0; i < count; i++) {
        const muster_Parcel *item = &d->parcels._buffer[i];
        p->fresh[i] = item_take(agent_find(p, item->box), item, p->now_ns);
    }
    return count;
}

/* @return whether a directive behind the item has been carried out already */
static bool is_overtaken(const muster_Delivery *d, const muster_Parcel *item)
{
    for (uint32_t i = 0; i < d->parcels._length; i++) {
        const muster_Parcel *other = &d->parcels._buffer[i];
        if (other->letter.layer == WIRE_DIRECTIVE && other->number > item->number &&
            strcmp(other->box, item->box) == 0) {
            return true;
        }
    }
    return false;
}

/* An agent that left in the middle of its mail leaves the rest for its next life.  Mail that a
 * directive has overtaken is gone, or the next life would get the directive, too. */
static void item_give_back(struct mu_agent *a, const muster_Delivery *d, const muster_Parcel *item)
{
    if (is_overtaken(d, item)) {
        return;
    }
    a->handed--;
    if (item->number <= a->last_number) {
        a->last_number = item->number - 1;
    }
}

/* Hands over the marked directives, or the marked mails. */
static void items_hand(mu_process *p, const muster_Delivery *d, uint32_t count, bool directives)
{
    for (uint32_t i = 0; i < count; i++) {
        const muster_Parcel *item = &d->parcels._buffer[i];
        bool is_due = p->fresh[i] && (item->letter.layer == WIRE_DIRECTIVE) == directives;
        struct mu_agent *a = is_due ? agent_find(p, item->box) : NULL;
        if (!a) {
            continue;
        }
        if (a->state == MU_GONE) {
            item_give_back(a, d, item);
        } else if (directives) {
            agent_directive(a, item);
        } else {
            agent_mail(a, item);
        }
    }
}

/* Takes changes of the groups and the yellow pages, and tells standing queries of them. */
static void directory_take(mu_process *p, const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->memberships._length; i++) {
        directory_set_membership(&p->directory, &d->memberships._buffer[i]);
    }
    for (uint32_t i = 0; i < d->offers._length; i++) {
        directory_set_offer(&p->directory, &d->offers._buffer[i]);
    }
    directory_settle(&p->directory);
}

static void verdicts_take(mu_process *p, const muster_Delivery *d)
{
    if (d->verdicts._length > 0) {
        uint64_t incarnation = d->verdicts._buffer[0].broker_incarnation;
        if (p->broker_incarnation != 0 && p->broker_incarnation != incarnation) {
            members_clear(&p->members);
            directory_clear(&p->directory, false);
        }
        p->broker_incarnation = incarnation;
    }
    for (uint32_t i = 0; i < d->verdicts._length; i++) {
        struct mu_agent *a = agent_find(p, d->verdicts._buffer[i].agent);
        if (a) {
            agent_verdict(a, &d->verdicts._buffer[i]);
        }
    }
    if (d->roll_call) {
        roll_mark_all(p);
    }
}

/* Before any mail went out, a receipt is for an earlier agent of the name. */
static void receipt_note(struct outbox *box, const muster_Receipt *r)
{
    if (!box->begun) {
        return;
    }
    if (r->result == muster_OUTCOME_DUPLICATE) {
        outbox_had(box, r->first_seq, r->last_seq);
    } else if (r->result == muster_OUTCOME_STORED) {
        outbox_confirm(box, r->first_seq, r->last_seq);
    } else {
        outbox_end(box, r->first_seq, r->last_seq);
    }
}

static void receipts_take(mu_process *p, const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->receipts._length; i++) {
        const muster_Receipt *r = &d->receipts._buffer[i];
        struct mu_agent *a = agent_find(p, r->agent);
        if (!a) {
            continue;
        }
        bool is_answer = r->result != muster_OUTCOME_DUPLICATE;
        returns_take(a, r);
        receipt_note(&a->outbox, r);
        resolver_retry(a);
        agent_progress(a);
        /* Only the runtime sends a mail twice; its real outcome is still to come.  Receipts for an
         * earlier process of that name are not for this one. */
        bool ours = a->outbox.begun && r->last_seq >= a->outbox.own_seq;
        if (a->handlers.on_receipt && ours && is_answer) {
            a->handlers.on_receipt(a->handlers.self, a, r->first_seq, r->last_seq,
                                   (enum mu_outcome)r->result);
        }
    }
}

static void percept_set(struct mu_percept *out, const muster_Sense *sense,
                        const muster_Percept *robot)
{
    *out = (struct mu_percept){.step = sense->step, .time_ns = sense->time_ns};
    percept_unpack(out, robot);
}

/* A process that watches sees the whole world. */
static void world_take(mu_process *p, const muster_Sense *sense)
{
    uint32_t count = sense->robots._length < MU_ROBOTS_MAX ? sense->robots._length : MU_ROBOTS_MAX;
    for (uint32_t i = 0; i < count; i++) {
        percept_set(&p->bodies[i], sense, &sense->robots._buffer[i]);
    }
    for (uint32_t i = 0; i < p->agent_count; i++) {
        struct mu_agent *a = &p->agents[i];
        if (a->state != MU_GONE && a->handlers.on_world) {
            a->handlers.on_world(a->handlers.self, a, p->bodies, count);
        }
    }
}

/* Agents without a body live through the step, too, in the order in which they came. */
static bool takes_tick(const struct mu_agent *a)
{
    bool may = a->kind == MU_KIND_AGENT || a->kind == MU_KIND_ROBOT;
    return may && !a->embodied && a->state != MU_GONE && a->name_state == NAME_ACCEPTED &&
           a->handlers.on_beat;
}

static void ticks_take(mu_process *p)
{
    for (uint32_t i = 0; i < p->agent_count; i++) {
        struct mu_agent *a = &p->agents[i];
        if (takes_tick(a)) {
            a->handlers.on_beat(a->handlers.self, a, &a->percept);
        }
    }
}

/* Gives every agent its percept of this step: one without a body only has the time. */
static void percepts_set(mu_process *p, const muster_Sense *sense)
{
    for (uint32_t i = 0; i < p->agent_count; i++) {
        struct mu_agent *a = &p->agents[i];
        a->embodied = false;
        a->percept = (struct mu_percept){
            .robot = a->name, .step = sense->step, .time_ns = sense->time_ns, .battery_share = -1};
    }
    for (uint32_t i = 0; i < sense->robots._length; i++) {
        struct mu_agent *a = agent_find(p, sense->robots._buffer[i].robot);
        if (a) {
            a->embodied = true;
            percept_set(&a->percept, sense, &sense->robots._buffer[i]);
        }
    }
}

static void percepts_take(mu_process *p, const muster_Sense *sense)
{
    if (p->role == PROCESS_WATCH) {
        world_take(p, sense);
        return;
    }
    percepts_set(p, sense);
    for (uint32_t i = 0; i < sense->robots._length; i++) {
        struct mu_agent *a = agent_find(p, sense->robots._buffer[i].robot);
        if (a && a->handlers.on_step) {
            a->handlers.on_step(a->handlers.self, a, &a->percept);
        }
    }
    ticks_take(p);
}

static void agent_act(struct mu_agent *a)
{
    if (a->state == MU_RUNNING && a->handlers.on_act) {
        a->handlers.on_act(a->handlers.self, a, &a->percept);
    }
}

static void agents_act(mu_process *p, const muster_Sense *sense)
{
    for (uint32_t i = 0; i < sense->robots._length && p->role != PROCESS_WATCH; i++) {
        struct mu_agent *a = agent_find(p, sense->robots._buffer[i].robot);
        if (a) {
            agent_act(a);
        }
    }
    for (uint32_t i = 0; i < p->agent_count; i++) {
        if (takes_tick(&p->agents[i])) {
            agent_act(&p->agents[i]);
        }
    }
}

void step_take_delivery(mu_process *p, const muster_Delivery *d, const muster_Sense *sense)
{
    transfers_take(p, d);
    probes_take(p, d);
    verdicts_take(p, d);
    for (uint32_t i = 0; i < d->members._length; i++) {
        members_set(&p->members, &d->members._buffer[i]);
    }
    directory_take(p, d);
    receipts_take(p, d);
    uint32_t count = items_mark(p, d);
    /* Directives come first, whatever order the box has: no rule delays them. */
    items_hand(p, d, count, true);
    if (sense) {
        percepts_take(p, sense);
    }
    items_hand(p, d, count, false);
}

static void step_end(mu_process *p, const muster_Sense *sense)
{
    if (p->transfers.on_step_end) {
        p->transfers.on_step_end(p->transfers.self);
    }
    step_answer(p, sense->step);
    if (p->transfers.on_answered) {
        p->transfers.on_answered(p->transfers.self);
    }
}

/* Takes the mail of the step before; the first of a lock step has the whole pages. */
static void step_begin(mu_process *p, const muster_Sense *sense, const muster_Delivery *d)
{
    if (p->steps != PROCESS_LIVED) {
        members_clear(&p->members);
        directory_clear(&p->directory, true);
        (void)process_step_on(p, STEP_LIVED);
        step_announce(p, UP_WAS_SAID, d->step);
    }
    step_take_delivery(p, d, sense);
}

void step_repeat(mu_process *p, enum process_up_due due)
{
    int64_t step = p->mail->step;
    if (due == UP_AGAIN_FOR_BROKER) {
        step_begin(p, NULL, p->mail);
        step++;
    }
    step_announce(p, due, step);
    step_answer(p, step);
}

void step_live(mu_process *p, const muster_Sense *sense, const muster_Delivery *d)
{
    step_begin(p, sense, d);
    agents_act(p, sense);
    step_end(p, sense);
}

void step_live_freely(mu_process *p, const muster_Sense *sense)
{
    percepts_take(p, sense);
    while (p->mail) {
        step_take_delivery(p, p->mail, NULL);
        inbox_next(p);
    }
    agents_act(p, sense);
    step_end(p, sense);
}
