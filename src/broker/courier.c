/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/courier.h"

#include "broker/parts.h"
#include "broker/presence.h"
#include "broker/router.h"
#include "muster/memory.h"

void courier_init(struct courier *c)
{
    *c = (struct courier){.open = MU_NONE};
    c->parcels = mu_startup_array(COURIER_PARCELS, sizeof *c->parcels);
    c->receipts = mu_startup_array(COURIER_RECEIPTS, sizeof *c->receipts);
}

/* --- putting together ------------------------------------------------------------------------- */

/* Room that is left in a Delivery. */
struct room {
    uint32_t parcels;
    size_t bytes;
};

static uint32_t parcels_fill(struct broker *b, uint32_t agent, struct room *room,
                             muster_Delivery *d)
{
    struct box *box = mailbox_box(&b->mailbox, agent);
    mailbox_hand_out(&b->mailbox, agent, router_gate(b, agent));
    uint64_t number = box->acked + box->written;
    uint32_t count = 0;
    for (uint32_t i = box->out; i != MU_NONE && room->parcels > 0; i = b->mailbox.posts[i].next) {
        const struct mail *m = b->mailbox.posts[i].mail;
        if (m->bytes > room->bytes) { /* the content of the largest mail fits an empty Delivery */
            room->parcels = 0;
            break;
        }
        room->bytes -= m->bytes;
        room->parcels--;
        count++;
        d->parcels._buffer[d->parcels._length++] = (muster_Parcel){
            .box = b->registry.agents[agent].name, .number = number + count, .letter = m->letter};
    }
    return count;
}

static uint32_t receipts_fill(struct broker *b, uint32_t agent, muster_Delivery *d)
{
    const struct receipt_queue *q = receipts_of(&b->receipts, agent);
    uint32_t count = 0;
    for (uint32_t i = q->head; i != MU_NONE && d->receipts._length < COURIER_RECEIPTS;
         i = b->receipts.pool[i].next) {
        const struct receipt *r = &b->receipts.pool[i];
        d->receipts._buffer[d->receipts._length++] =
            (muster_Receipt){.agent = b->registry.agents[agent].name,
                             .first_seq = r->first_seq,
                             .last_seq = r->last_seq,
                             .result = r->result};
        count++;
    }
    return count;
}

static void verdicts_fill(struct broker *b, struct place *at, muster_Delivery *d)
{
    static char none[1];
    for (uint32_t i = 0; i < at->agents_count; i++) {
        struct agent *a = &b->registry.agents[at->agents[i]];
        if (a->verdict_due) {
            d->verdicts._buffer[d->verdicts._length++] =
                (muster_Verdict){.agent = a->name,
                                 .accepted = true,
                                 .last_seq = registry_last_seq(a),
                                 .broker_incarnation = b->incarnation,
                                 .reason = none};
        }
    }
    for (uint32_t i = 0; i < at->refusals_count; i++) {
        muster_Verdict *v = &d->verdicts._buffer[d->verdicts._length++];
        *v = (muster_Verdict){.agent = at->refusals[i].name, .broker_incarnation = b->incarnation};
        v->reason = (char *)(uintptr_t)at->refusals[i].reason; /* idlc has no const */
    }
}

/* In lock step the pages are of its members, and of who was there when it began: who else comes and
 * goes does so by the wall clock.  Onlookers, who want no broadcasts, are not shown at all. */
static bool line_is_shown(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    bool from_the_start = a->version <= b->lockstep.start_version && !a->is.no_broadcasts;
    return !b->courier.open_lockstep || from_the_start || presence_in_lockstep(b, agent);
}

/* Changes of the white pages since the last Delivery; in lock step, those of the last step. */
static void members_fill(struct broker *b, const struct place *at, muster_Delivery *d)
{
    const struct registry *r = &b->registry;
    uint64_t upto = b->courier.open_version;
    if (at->version_had >= upto) {
        return;
    }
    for (uint32_t i = 0; i < r->count; i++) {
        uint64_t version = r->agents[r->order[i]].version;
        if (version > at->version_had && version <= upto && line_is_shown(b, r->order[i])) {
            registry_line(r, r->order[i], b->name, &d->members._buffer[d->members._length++]);
        }
    }
}

static void outside_fill(struct broker *b, muster_Delivery *d)
{
    for (uint32_t i = 0; i < b->lockstep.told_count; i++) {
        d->outside._buffer[d->outside._length++] = b->lockstep.told[i]->letter;
    }
}

static void delivery_begin(struct courier *c, const struct place *at, muster_Delivery *d)
{
    *d = (muster_Delivery){.step = muster_STEP_NOW};
    d->process = (char *)(uintptr_t)at->name; /* idlc has no const; nobody writes there */
    d->parcels._buffer = c->parcels;
    d->receipts._buffer = c->receipts;
    d->verdicts._buffer = c->verdicts;
    d->members._buffer = c->members;
    d->outside._buffer = c->outside;
}

static void delivery_finish(muster_Delivery *d)
{
    d->parcels._maximum = d->parcels._length;
    d->receipts._maximum = d->receipts._length;
    d->verdicts._maximum = d->verdicts._length;
    d->members._maximum = d->members._length;
    d->outside._maximum = d->outside._length;
}

/* @return whether there is anything to say */
static bool delivery_fill(struct broker *b, uint32_t place, muster_Delivery *d)
{
    struct courier *c = &b->courier;
    struct place *at = &b->places.at[place];
    c->open_lockstep = at->rostered || at->simulator;
    if (c->open_lockstep && !at->step_due) {
        return false;
    }
    c->open_version = c->open_lockstep ? b->lockstep.version : b->registry.version;
    delivery_begin(c, at, d);
    if (c->open_lockstep) {
        d->step = b->lockstep.step - 1;
    }
    struct room room = {.parcels = MU_WINDOW_MAX, .bytes = COURIER_BYTES};
    for (uint32_t i = 0; i < at->agents_count; i++) {
        if (c->open_lockstep) { /* each box has its own room: none can starve another */
            room = (struct room){.parcels = MU_WINDOW_MAX + MAILBOX_RESERVE,
                                 .bytes = COURIER_BOX_BYTES};
        }
        c->parts[i].parcels = parcels_fill(b, at->agents[i], &room, d);
        c->parts[i].receipts = receipts_fill(b, at->agents[i], d);
    }
    verdicts_fill(b, at, d);
    members_fill(b, at, d);
    if (at->simulator) {
        outside_fill(b, d);
    }
    delivery_finish(d);
    return c->open_lockstep || d->parcels._length || d->receipts._length || d->verdicts._length ||
           d->members._length;
}

static void boxes_take_back(struct broker *b, const struct place *at)
{
    for (uint32_t i = 0; i < at->agents_count; i++) {
        mailbox_take_back(&b->mailbox, at->agents[i]);
    }
}

bool courier_next(struct broker *b, const char **process, muster_Delivery *d)
{
    uint32_t place;
    while ((place = places_next(&b->places)) != MU_NONE) {
        const struct place *at = &b->places.at[place];
        if (!at->used || !at->matched || at->blocked) {
            continue;
        }
        if (delivery_fill(b, place, d)) {
            b->courier.open = place;
            *process = at->name;
            return true;
        }
    }
    return false;
}

/* --- the network's answer --------------------------------------------------------------------- */

static void part_delivered(struct broker *b, uint32_t agent, const struct courier_part *part)
{
    uint32_t again = mailbox_mark_written(&b->mailbox, agent, part->parcels);
    b->counters.resent += again;
    mailbox_take_back(&b->mailbox, agent);
    bool watched = mailbox_box(&b->mailbox, agent)->watched;
    if (!b->courier.open_lockstep && part->parcels > 0 && (again > 0 || !watched)) {
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
    }
    receipts_drop(&b->receipts, agent, part->receipts);
    b->registry.agents[agent].verdict_due = false;
}

void courier_delivered(struct broker *b)
{
    struct courier *c = &b->courier;
    MU_ASSERT(c->open != MU_NONE);
    struct place *at = &b->places.at[c->open];
    for (uint32_t i = 0; i < at->agents_count; i++) {
        part_delivered(b, at->agents[i], &c->parts[i]);
    }
    at->refusals_count = 0;
    if (c->open_version > at->version_had) {
        at->version_had = c->open_version;
    }
    if (c->open_lockstep) {
        at->step_due = false;
        at->step_had = b->lockstep.step - 1;
        if (at->simulator) {
            lockstep_told(b);
        }
    } else {
        places_wake(&b->places, c->open); /* there may be more than one Delivery could hold */
    }
    c->open = MU_NONE;
}

void courier_undelivered(struct broker *b)
{
    struct courier *c = &b->courier;
    MU_ASSERT(c->open != MU_NONE);
    boxes_take_back(b, &b->places.at[c->open]);
    if (b->places.blocked == 0) {
        uint64_t now_ns = b->clock.now_ns;
        c->retry_ns =
            now_ns > UINT64_MAX - COURIER_RETRY_NS ? UINT64_MAX : now_ns + COURIER_RETRY_NS;
    }
    places_set_blocked(&b->places, c->open, true);
    c->open = MU_NONE;
}

void courier_tick(struct broker *b)
{
    if (courier_deadline_ns(b) > b->clock.now_ns) {
        return;
    }
    for (uint32_t i = 0; i < b->places.top; i++) {
        if (b->places.at[i].blocked) {
            places_set_blocked(&b->places, i, false);
            places_wake(&b->places, i);
        }
    }
}

uint64_t courier_deadline_ns(const struct broker *b)
{
    return b->places.blocked > 0 ? b->courier.retry_ns : UINT64_MAX;
}
