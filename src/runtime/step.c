/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A control step in its fixed order: directives, percepts, mail, acting, one answer.
 *
 * docs/lockstep.md has the whole protocol; here is a process's side of it.
 */
#include "bus/percept.h"
#include "core/clock.h"
#include "runtime/process.h"

#include <string.h>

/* Mail that went out and has no answer after this long, by the wall, goes out again. */
static const uint64_t RESEND_NS = 1000000000;

/* @return whether an item is the next one of its box; then its number is noted */
static bool number_take(struct mu_agent *a, uint64_t number)
{
    if (number <= a->last_number) {
        ack_delay_add(&a->process->ack_delay, mu_clock_ns());
        a->acked_number = 0; /* it came again, so our acknowledgement was lost: say it again */
        return false;
    }
    /* Where a number is missing, the broker will begin there again; a new life begins anywhere. */
    if (a->in_order && number != a->last_number + 1) {
        return false;
    }
    ack_delay_add(&a->process->ack_delay, mu_clock_ns());
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
static bool item_take(struct mu_agent *a, const muster_Parcel *item)
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
    if (!number_take(a, item->number)) {
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
        p->fresh[i] = item_take(agent_find(p, item->box), item);
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
        struct mu_agent *a = agent_find(p, item->box);
        if (!p->fresh[i] || !a || (item->letter.layer == WIRE_DIRECTIVE) != directives) {
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

/* Robots without a body live through the step, too, in the order in which they came. */
static bool takes_tick(const struct mu_agent *a)
{
    return a->kind == MU_KIND_ROBOT && !a->embodied && a->state != MU_GONE &&
           a->name_state == NAME_ACCEPTED && a->handlers.on_beat;
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

/* --- the answer ------------------------------------------------------------------------------- */

static uint32_t acks_fill(mu_process *p)
{
    uint32_t count = 0;
    struct mu_agent *next = NULL;
    for (struct mu_agent *a = queue_first(p, QUEUE_ACK); a && count < p->acks_max; a = next) {
        next = queue_next(a, QUEUE_ACK);
        if (a->acked_number == a->last_number) {
            queue_remove(a, QUEUE_ACK);
            continue;
        }
        if (a->name_state != NAME_ACCEPTED) {
            continue; /* a broker that has not said yes does not know the box */
        }
        p->out_ackers[count] = a;
        p->acks[count++] =
            (muster_Ack){.box = a->name, .number = a->last_number, .handed = a->handed};
    }
    return count;
}

/* How many of these mails go into one Up: as many as PROCESS_UP_BYTES allow, and at least one. */
static uint32_t mails_bounded(const muster_Mail *mails, uint32_t count, size_t *room)
{
    for (uint32_t i = 0; i < count; i++) {
        size_t bytes = strlen(mails[i].content) + sizeof *mails;
        if (bytes > *room && i > 0) {
            *room = 0;
            return i;
        }
        *room -= bytes < *room ? bytes : *room;
    }
    return count;
}

static muster_Act act_of(struct mu_agent *a, bool answer)
{
    static char none[1];
    bool runs = a->state == MU_RUNNING;
    return (muster_Act){.agent = a->name,
                        .state = (muster_State)a->state,
                        .drives = runs ? a->speed.set
                                       : true, /* an agent that does not run stands still */
                        .forward_m_s = runs ? a->speed.forward_m_s : 0.0,
                        .turn_rad_s = runs ? a->speed.turn_rad_s : 0.0,
                        .paddles = runs ? (int32_t)a->paddles : 0,
                        .lift = runs ? (int32_t)a->lift : 0,
                        .senses = a->senses,
                        .firings = a->firings,
                        .rules = a->rules ? a->rules : none,
                        .first_seq = a->outbox.first_seq,
                        .goal = a->goal,
                        .replays = a->outbox.replays,
                        .diary = answer && a->note.at ? a->note.at : none};
}

/* The content of the Up that is being put together, and the room that is left in it. */
struct up_load {
    bool answer; /* to a step */
    uint32_t acts, mails;
    uint32_t left; /* mails */
    size_t room;   /* bytes of content */
};

static void act_add(mu_process *p, struct mu_agent *a, struct up_load *load)
{
    muster_Mail *from = &p->mails[load->mails];
    bool may_send = a->name_state == NAME_ACCEPTED && load->room > 0;
    uint32_t count = may_send ? outbox_unsent(&a->outbox, from, load->left) : 0;
    count = mails_bounded(from, count, &load->room);
    muster_Act *act = &p->acts[load->acts];
    *act = act_of(a, load->answer);
    act->mails = (dds_sequence_muster_Mail){
        ._maximum = count, ._length = count, ._buffer = from, ._release = false};
    a->act = load->acts;
    p->out_agents[load->acts++] = a;
    load->mails += count;
    load->left -= count;
}

/* The room of one agent in the answer to a step, or of all in another Up. */
static void load_begin(const mu_process *p, struct up_load *load)
{
    uint32_t left = p->mails_max - load->mails;
    load->left = left < PROCESS_UP_MAILS ? left : PROCESS_UP_MAILS;
    load->room = PROCESS_UP_BYTES;
}

/* Puts the next Up together: the answer to a step has an act of every agent, else those alone that
 * have mail.  @return whether there is any mail, acknowledgement, transfer or probe in it */
static bool up_fill(mu_process *p, int64_t step)
{
    struct up_load load = {.answer = step != muster_STEP_NOW};
    load_begin(p, &load);
    for (uint32_t i = 0; step != muster_STEP_NOW && i < p->agent_count; i++) {
        load_begin(p, &load);
        if (!life_is_elsewhere(&p->agents[i])) { /* another process answers for it */
            act_add(p, &p->agents[i], &load);
        }
    }
    for (struct mu_agent *a = step == muster_STEP_NOW ? queue_first(p, QUEUE_SEND) : NULL;
         a && load.left > 0 && load.room > 0; a = queue_next(a, QUEUE_SEND)) {
        act_add(p, a, &load);
    }
    uint32_t acks = acks_fill(p);
    p->out =
        (muster_Up){.process = p->name, .broker_incarnation = p->broker_incarnation, .step = step};
    p->out.acts._buffer = p->acts;
    p->out.acts._length = p->out.acts._maximum = load.acts;
    p->out.acks._buffer = p->acks;
    p->out.acks._length = p->out.acks._maximum = acks;
    bool transfers = transfers_fill(p, &p->out);
    bool probes = step == muster_STEP_NOW && probes_fill(p, &p->out);
    return load.mails > 0 || acks > 0 || transfers || probes;
}

/* The act of an agent has gone out; answer: to a step. */
static void act_sent(struct mu_agent *a, uint32_t mails, bool answer)
{
    if (mails > 0) {
        outbox_sent(&a->outbox, mails);
        agent_progress(a);
    }
    if (!outbox_has_unsent(&a->outbox)) {
        queue_remove(a, QUEUE_SEND);
    }
    a->speed.set = false;
    if (answer) { /* the simulator takes orders from nothing else */
        a->paddles = MU_PADDLES_KEEP;
        a->lift = MU_LIFT_KEEP;
    }
    mu_agent_fired(a, 0, "");
    if (answer && a->note.at) {
        mu_text_clear(&a->note);
    }
}

bool step_retry(mu_process *p)
{
    if (p->up_state != UP_PENDING) {
        return true;
    }
    if (bus_write(&p->up, &p->out) != MU_OK) {
        return false;
    }
    process_up_on(p, UP_WRITTEN);
    for (uint32_t i = 0; i < p->out.acts._length; i++) {
        act_sent(p->out_agents[i], p->acts[i].mails._length, p->out.step != muster_STEP_NOW);
    }
    for (uint32_t i = 0; i < p->out.acks._length; i++) {
        struct mu_agent *a = p->out_ackers[i];
        a->acked_number = p->acks[i].number;
        if (a->acked_number == a->last_number) {
            queue_remove(a, QUEUE_ACK);
        }
    }
    transfers_sent(p, p->out.trips._length);
    probes_sent(p, &p->out);
    if (!queue_first(p, QUEUE_ACK)) { /* else some did not fit in, and are due with the next Up */
        ack_delay_clear(&p->ack_delay, mu_clock_ns());
    }
    return true;
}

static void up_announce(mu_process *p, enum process_up_due due, int64_t step)
{
    if (p->before_up) {
        p->before_up(p->before_up_self, due, step);
    }
}

static void step_answer(mu_process *p, int64_t step)
{
    (void)up_fill(p, step);
    process_up_on(p, UP_ANSWERS);
    up_announce(p, UP_DUE, step);
    process_up_on(p, UP_GOES);
    (void)step_retry(p);
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
        up_announce(p, UP_WAS_SAID, d->step);
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
    up_announce(p, due, step);
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

void step_hello(mu_process *p)
{
    if (step_retry(p)) {
        (void)up_fill(p, muster_STEP_NOW);
        process_up_on(p, UP_GOES);
        (void)step_retry(p);
    }
}

static void unanswered_again(mu_process *p)
{
    struct mu_agent *a = queue_first(p, QUEUE_WAIT);
    uint64_t now_ns = a ? mu_clock_ns() : 0;
    for (; a && now_ns - a->progress_ns > RESEND_NS; a = queue_first(p, QUEUE_WAIT)) {
        queue_remove(a, QUEUE_WAIT);
        outbox_again(&a->outbox);
        if (a->name_state == NAME_ACCEPTED) {
            queue_add(a, QUEUE_SEND);
        }
    }
}

/* Acknowledgements wait a little for mail to go with, but not when their agent is about to leave,
 * or when a poll loop of the program's own decides when we are here again. */
static bool acks_are_due(const mu_process *p)
{
    return queue_first(p, QUEUE_ACK) &&
           (p->leaving > 0 || p->bus.wakes || ack_delay_due(&p->ack_delay, mu_clock_ns()));
}

static bool is_anything_to_say(const mu_process *p)
{
    return queue_first(p, QUEUE_SEND) || acks_are_due(p) || p->transfers.count > 0 ||
           p->probes.unsent > 0;
}

void step_say_transfers(mu_process *p)
{
    if (p->transfers.count > 0 && step_retry(p)) {
        p->out = (muster_Up){.process = p->name, .step = muster_STEP_NOW};
        (void)transfers_fill(p, &p->out);
        process_up_on(p, UP_GOES);
        (void)step_retry(p);
    }
}

void step_flush(mu_process *p)
{
    directory_settle(&p->directory);
    if (!step_retry(p)) {
        return; /* mail of a pending Up is marked as sent when that has gone: it must not move
                   before */
    }
    unanswered_again(p);
    if (is_anything_to_say(p)) {
        up_announce(p, UP_DUE, muster_STEP_NOW);
    }
    while (step_retry(p) && is_anything_to_say(p) && bus_writer_matches(&p->up) > 0 &&
           up_fill(p, muster_STEP_NOW)) {
        process_up_on(p, UP_GOES);
    }
}
