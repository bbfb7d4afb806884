/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Mail, receipts and lines that other brokers deliver to this one, and what it acknowledges.
 *
 * A mail from a neighbour is taken once, whatever becomes of it: what has no room, or may not be
 * carried out, is answered to its sender by way of the neighbour.
 */
#include "broker/membership/membership.h"

#include "broker/control/parts.h"
#include "core/name.h"

#include <string.h>

/* --- mail ------------------------------------------------------------------------------------- */

/* @return the sender of a mail, entered if it is new; MU_NONE: the white pages are full */
static uint32_t sender_of(struct broker *b, const char *src)
{
    uint32_t sender = registry_find(&b->registry, src);
    if (sender == MU_NONE && (sender = registry_add(&b->registry, src)) != MU_NONE) {
        registry_touch(&b->registry, sender);
    }
    if (sender != MU_NONE && !registry_is_own(sender) &&
        b->registry.agents[sender].process == MU_NONE) {
        struct agent *a = &b->registry.agents[sender];
        /* Its neighbour will say that it is there. */
        names_bearer_on(&b->registry, sender, BEARER_AWAITS);
        a->since_wall_ns = a->since_wall_ns ? a->since_wall_ns : clock_wall_ns(&b->clock);
    }
    return sender;
}

/* @return why it goes no further, or DELIVERED */
static muster_Outcome objection_to(struct broker *b, uint32_t agent, const muster_Mail *m)
{
    if (m->hops > MU_HOPS_MAX) {
        b->federation.count.hops_refused++;
        return muster_OUTCOME_REFUSED;
    }
    if (!mu_address_valid(m->dst)) {
        b->counters.malformed++;
        return muster_OUTCOME_REFUSED;
    }
    if (b->registry.agents[agent].named == NAMED_ENDED) {
        b->counters.sent++;
        b->counters.unknown_name++;
        return muster_OUTCOME_UNKNOWN_NAME;
    }
    if (m->level != muster_LEVEL_RAM && !journal_takes(b)) {
        b->counters.sent++;
        b->counters.no_store++;
        return muster_OUTCOME_NO_STORE;
    }
    return muster_OUTCOME_DELIVERED;
}

static void mail_take(struct broker *b, uint32_t agent, uint32_t sender, const muster_Mail *from)
{
    muster_Mail letter = *from;
    letter.hops++;
    letter.due_ns = -1; /* it has waited for its time already */
    muster_Outcome objection = objection_to(b, agent, &letter);
    if (objection != muster_OUTCOME_DELIVERED) {
        outcome_tell(b, sender, letter.seq, letter.seq, objection);
        return;
    }
    struct mail *m = pool_put(&b->pool, &letter);
    if (!m) {
        b->counters.sent++;
        b->counters.box_full++;
        ledger_alert(b, ALERT_BOX_FULL, REGISTRY_BROKER, sender);
        outcome_tell(b, sender, letter.seq, letter.seq, muster_OUTCOME_BOX_FULL);
        return;
    }
    m->sender = sender;
    m->payer = registry_is_own(sender) ? agent : sender;
    m->only = agent;
    route_from_outside(b, m);
}

static void item_take(struct broker *b, struct peer *p, const muster_Parcel *item)
{
    uint32_t agent = registry_find(&b->registry, item->box);
    uint32_t sender = sender_of(b, item->letter.src);
    if (agent == MU_NONE || registry_is_own(agent)) {
        b->counters.malformed++;
        return;
    }
    if (item->number <= p->boxes[agent].taken) {
        (void)mu_list_append(&p->acks, MU_LINKS(p->boxes, ack), agent);
        b->federation.count.repeated++;
        return;
    }
    if (item->number !=
        p->boxes[agent].taken + 1) { /* the neighbour will begin at the lost one again */
        b->gaps++;
        return;
    }
    (void)mu_list_append(&p->acks, MU_LINKS(p->boxes, ack), agent);
    p->boxes[agent].taken = item->number;
    b->federation.count.items_in++;
    if (sender == MU_NONE) { /* no room for its name: what follows must not wait until there is */
        b->counters.sent++;
        b->counters.box_full++;
        return;
    }
    mail_take(b, agent, sender, &item->letter);
}

/* What others have had from a box is not for us. */
static void verdict_take(struct broker *b, struct peer *p, const muster_Verdict *v)
{
    uint32_t agent = registry_find(&b->registry, v->agent);
    if (agent == MU_NONE || registry_is_own(agent)) {
        b->counters.malformed++;
    } else if (v->last_seq > p->boxes[agent].taken) {
        p->boxes[agent].taken = v->last_seq;
    }
}

/* --- receipts, groups, services --------------------------------------------------------------- */

static void receipt_take(struct broker *b, const struct peer *p, const muster_Receipt *r)
{
    uint32_t agent = registry_find(&b->registry, r->agent);
    if (agent == MU_NONE || r->first_seq == 0 || r->first_seq > r->last_seq ||
        (unsigned)r->result > muster_OUTCOME_NO_STORE) {
        b->counters.malformed++;
        return;
    }
    const struct agent *a = &b->registry.agents[agent];
    b->federation.count.receipts_in++;
    bool goes_back = a->process != MU_NONE && strcmp(a->place, p->place) == 0;
    if (!goes_back && scope_is_told(b->registry.agents[agent].scope)) {
        outcome_tell(b, agent, r->first_seq, r->last_seq, r->result);
    }
}

static void lines_take(struct broker *b, const muster_Delivery *d)
{
    struct said said = view_said(b);
    said.stamp_ns = clock_wall_ns(&b->clock);
    for (uint32_t i = 0; i < d->memberships._length; i++) {
        const muster_Membership *m = &d->memberships._buffer[i];
        struct line_word w = {m->group, m->agent, m->joined, "", m->origin, 0, m->stamp_ns};
        b->counters.malformed += lines_merge(&b->pages.groups, &w, &said) == MU_MALFORMED;
    }
    for (uint32_t i = 0; i < d->offers._length; i++) {
        const muster_Offer *o = &d->offers._buffer[i];
        struct line_word w = {o->service, o->agent,    o->offered, o->attributes,
                              o->origin,  o->lease_ns, o->stamp_ns};
        b->counters.malformed += lines_merge(&b->pages.services, &w, &said) == MU_MALFORMED;
    }
    notify_tell(b);
}

/* The neighbour has not heard us for a while, or not yet in this life. */
static void roll_call_take(struct broker *b, const struct peer *p)
{
    uint32_t place = processes_find(&b->processes, p->place);
    announce_all(b);
    if (place != MU_NONE) {
        lifecycle_tell_again(b, place);
    }
}

void broker_delivery(struct broker *b, const muster_Delivery *d, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    retire_tick(b);
    if (!mu_name_valid(d->broker) || strcmp(d->process, b->place) != 0 ||
        strcmp(d->broker, b->name) == 0) {
        b->counters.malformed++;
        return;
    }
    struct peer *p = federation_meet(b, d->broker, d->broker_incarnation);
    if (!p) {
        return;
    }
    if (d->roll_call) {
        roll_call_take(b, p);
    }
    for (uint32_t i = 0; i < d->verdicts._length; i++) {
        verdict_take(b, p, &d->verdicts._buffer[i]);
    }
    for (uint32_t i = 0; i < d->parcels._length; i++) {
        item_take(b, p, &d->parcels._buffer[i]);
    }
    for (uint32_t i = 0; i < d->receipts._length; i++) {
        receipt_take(b, p, &d->receipts._buffer[i]);
    }
    lines_take(b, d);
}

/* --- acknowledgements ------------------------------------------------------------------------- */

/* Those whose mail this broker has as safely as it is asked to. */
static void acks_open(const struct broker *b, struct federation *l, const struct peer *p)
{
    MU_LIST_EACH (agent, &p->acks, MU_LINKS(p->boxes, ack)) {
        if (b->steps.turns[agent].relayed == 0 && l->acks_open_count < FEDERATION_ACKS) {
            l->acks_agents[l->acks_open_count] = agent;
            l->acks_open[l->acks_open_count++] =
                (muster_Ack){.box = sample_text(b->registry.agents[agent].name),
                             .number = p->boxes[agent].taken};
        }
    }
}

bool broker_up_next(struct broker *b, const char **peer, muster_Up *out)
{
    struct federation *l = &b->federation;
    l->acks_open_count = 0;
    for (uint32_t i = 0; i < l->peers_count && l->acks_open_count == 0; i++) {
        l->peer_open = i;
        acks_open(b, l, &l->peers[i]);
    }
    const struct peer *p = &l->peers[l->peer_open];
    uint32_t count = l->acks_open_count;
    *out = (muster_Up){.process = b->place,
                       .broker_incarnation = p->incarnation,
                       .step = muster_STEP_NOW,
                       .acks = {count, count, l->acks_open, false}};
    *peer = p->name;
    return count > 0;
}

void broker_up_sent(struct broker *b)
{
    struct federation *l = &b->federation;
    struct peer *p = &l->peers[l->peer_open];
    for (uint32_t i = 0; i < l->acks_open_count; i++) {
        (void)mu_list_remove(&p->acks, MU_LINKS(p->boxes, ack), l->acks_agents[i]);
    }
}
