/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/delivery/delivery.h"

#include "broker/control/parts.h"
#include "core/sort.h"
#include "muster/memory.h"

#include <string.h>

void courier_init(struct courier *c)
{
    *c = (struct courier){.open = MU_NONE};
    c->parcels = mu_startup_array(COURIER_PARCELS, sizeof *c->parcels);
    c->receipts = mu_startup_array(COURIER_RECEIPTS, sizeof *c->receipts);
}

/* --- the interval ----------------------------------------------------------------------------- */

/* @return whether there is a directive to hand out, or anything to go out once more */
static bool box_is_urgent(struct broker *b, uint32_t agent)
{
    if (!mailbox_is_begun(&b->mailbox, agent)) {
        return false;
    }
    const struct box *box = mailbox_box(&b->mailbox, agent);
    uint32_t first = box->lists[POST_URGENT].head;
    if (box->out != MU_NONE || first == MU_NONE) {
        return box->out != MU_NONE;
    }
    bool may_go = !b->mailbox.posts[first].mail->journal_written || journal_room(b, agent) > 0;
    return may_go && box->lists[POST_FLIGHT].count < MU_WINDOW_MAX + MAILBOX_RESERVE &&
           names_gate(b, agent) != GATE_SHUT;
}

/* What cannot wait: an answer to a registration, a directive, what goes out once more. */
static bool place_is_urgent(struct broker *b, uint32_t place)
{
    const struct place *at = &b->places.at[place];
    if (at->refusals_count > 0 || at->roll_call_due) {
        return true;
    }
    for (uint32_t agent; (agent = tenants_stirred(&b->places, place)) != TENANTS_NONE;) {
        if (b->registry.agents[agent].verdict_due || box_is_urgent(b, agent)) {
            return true; /* it stays stirred until it is served */
        }
        tenants_calm(&b->registry, &b->places, agent);
    }
    return false;
}

/* @return whether the process is held until the courier wakes */
static bool place_hold(struct broker *b, uint32_t place)
{
    struct courier *c = &b->courier;
    struct place *at = &b->places.at[place];
    if (at->rostered || at->simulator || compose_is_awake(b, false) || place_is_urgent(b, place)) {
        return false;
    }
    c->held += !at->held;
    at->held = true;
    return true;
}

/* @return whether the process gets no more of a flood for now */
static bool place_pause(struct broker *b, uint32_t place)
{
    bool may = b->clock.now_ns < b->places.at[place].flooded_until_ns;
    return may && !place_is_urgent(b, place) && floods_hold(b, place);
}

static void courier_wake(struct broker *b)
{
    struct courier *c = &b->courier;
    if (c->awake || b->clock.now_ns < c->wake_ns) {
        return;
    }
    c->awake = true;
    for (uint32_t i = 0; i < b->places.top && c->held > 0; i++) {
        if (b->places.at[i].held) {
            b->places.at[i].held = false;
            places_wake(&b->places, i);
        }
    }
    c->held = 0;
}

/* All who may be served have been. */
static void courier_sleep(struct broker *b)
{
    struct courier *c = &b->courier;
    if (c->awake && c->worked) {
        c->count.wakings += c->interval_ns > 0;
        c->slept_ns = runclock_mail_ns(&b->clock);
        c->wake_ns = b->clock.now_ns + c->interval_ns;
        c->wake_ns = c->wake_ns < c->interval_ns ? UINT64_MAX : c->wake_ns;
    }
    c->awake = c->worked = false;
}

void courier_set_interval(struct broker *b, uint64_t interval_ns)
{
    b->courier.interval_ns = interval_ns;
    b->courier.wake_ns = b->clock.now_ns;
}

/* --- putting together ------------------------------------------------------------------------- */

bool courier_next(struct broker *b, const char **process, muster_Delivery *d)
{
    uint32_t place;
    courier_wake(b);
    if (circulars_next(b, d)) {
        b->courier.open = PLACES_ALL;
        b->courier.open_lockstep = false;
        b->courier.open_delay_ns = 0;
        *process = BUS_TO_ALL;
        return true;
    }
    while ((place = places_next(&b->places)) != MU_NONE) {
        const struct place *at = &b->places.at[place];
        if (!at->used || !at->matched || at->blocked) {
            continue;
        }
        b->courier.open = place;
        if (compose_fill_trip(b, place, d) || compose_fill_glance(b, place, d)) {
            *process = at->name;
            return true;
        }
        if (place_hold(b, place) || place_pause(b, place)) {
            b->courier.open = MU_NONE;
            continue;
        }
        if (compose_fill(b, place, d)) {
            *process = at->name;
            return true;
        }
        compose_return_passed_by(b); /* behind whoever is urgent, or until the courier wakes */
        if (b->courier.parts_count == COURIER_AGENTS) {
            places_wake(&b->places, place); /* more of them have not been looked at */
        }
        b->courier.parts_count = 0;
        b->courier.open = MU_NONE;
    }
    courier_sleep(b);
    return false;
}

/* --- the network's answer --------------------------------------------------------------------- */

/* @return the place that the last mail of a part came from, or MU_NONE */
static uint32_t part_from(struct broker *b, const struct courier_part *part)
{
    const struct box *box = mailbox_box(&b->mailbox, part->agent);
    uint32_t post = box->lists[POST_FLIGHT].tail;
    return post != MU_NONE ? b->registry.agents[b->mailbox.posts[post].mail->sender].process
                           : MU_NONE;
}

static void part_delivered(struct broker *b, const struct courier_part *part)
{
    receipts_drop(&b->receipts, part->agent, part->receipts);
    if (part->verdict) {
        b->registry.agents[part->agent].verdict_due = false;
    }
    if (!mailbox_is_begun(&b->mailbox, part->agent)) {
        return;
    }
    uint32_t again = mailbox_mark_written(&b->mailbox, part->agent, part->parcels);
    b->counters.resent += again;
    mailbox_take_back(&b->mailbox, part->agent);
    bool watched = mailbox_box(&b->mailbox, part->agent)->watched;
    if (!b->courier.open_lockstep && part->parcels > 0 && (again > 0 || !watched)) {
        mailbox_watch(&b->mailbox, part->agent, b->clock.now_ns);
    }
}

static void delivery_count(struct courier *c, uint32_t parcels)
{
    c->worked = c->worked || !c->open_lockstep;
    c->count.deliveries++;
    c->count.parcels += parcels;
    c->count.delay_ns += c->open_delay_ns;
    if (parcels > c->count.most_parcels) {
        c->count.most_parcels = parcels;
    }
}

void courier_delivered(struct broker *b)
{
    struct courier *c = &b->courier;
    MU_ASSERT(c->open != MU_NONE);
    if (c->open_trip || c->open_glance) {
        compose_end_word(b);
        return;
    }
    if (c->open == PLACES_ALL) {
        delivery_count(c, circulars_sent(b));
        c->count.circulars++;
        c->open = MU_NONE;
        return;
    }
    struct place *at = &b->places.at[c->open];
    uint32_t parcels = 0, from = MU_NONE;
    for (uint32_t i = 0; i < c->parts_count; i++) {
        parcels += c->parts[i].parcels;
        part_delivered(b, &c->parts[i]);
        from = c->parts[i].parcels > 0 ? part_from(b, &c->parts[i]) : from;
    }
    compose_return(b, true);
    delivery_count(c, parcels);
    floods_note_delivery(b, c->open, parcels, from);
    at->serial++;
    at->refusals_count = 0;
    at->roll_call_due = false;
    view_delivered(b, at);
    if (c->open_version > at->version_had) {
        at->version_had = c->open_version;
    }
    if (c->open_lockstep) {
        at->step_due = false;
        at->step_had = b->lockstep.step - 1;
        if (at->simulator) {
            barrier_told(b);
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
    c->count.blocked++;
    if (c->open == PLACES_ALL) {
        circulars_unsent(b);
        c->open = MU_NONE;
        return;
    }
    for (uint32_t i = 0; i < c->parts_count; i++) {
        mailbox_take_back(&b->mailbox, c->parts[i].agent);
    }
    compose_return(b, false);
    c->open_trip = c->open_glance = false;
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
    floods_tick(b);
    if (b->places.blocked == 0 || b->courier.retry_ns > b->clock.now_ns) {
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
    uint64_t wake_ns = b->courier.held > 0 ? b->courier.wake_ns : UINT64_MAX;
    uint64_t retry_ns = b->places.blocked > 0 ? b->courier.retry_ns : UINT64_MAX;
    uint64_t flood_ns = floods_deadline_ns(b);
    retry_ns = flood_ns < retry_ns ? flood_ns : retry_ns;
    return wake_ns < retry_ns ? wake_ns : retry_ns;
}
