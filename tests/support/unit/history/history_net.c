/* SPDX-License-Identifier: Apache-2.0 */
#include "history.h"

#include "broker/control/parts.h"
#include "core/hash.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- registrations ---------------------------------------------------------------------------- */

void net_register(struct history_process *p)
{
    muster_Entry entries[SEATS];
    muster_Registration r = {.wire = muster_WIRE,
                             .process = p->name,
                             .broker = words(""),
                             .incarnation = p->incarnation,
                             .host = words("here"),
                             .pid = 1};
    for (int seat = 0; seat < SEATS; seat++) {
        const struct actor *a = &p->seats[seat];
        bool said = a->name != NOBODY;
        entries[seat] = (muster_Entry){
            .reason = words(""),
            .name = words(said ? history_name(a->name) : ""),
            .kind = said && a->name % 2 == 0 ? muster_KIND_ROBOT : muster_KIND_AGENT,
            .state = said && !a->leaving && !a->refused ? a->state : muster_STATE_ABSENT,
            .full = a->policy,
            .box_mails = a->box_mails,
            .since_wall_ns = said ? a->life + 1 : 0,
            .newcomer = said && a->incarnation == 0,
            .home = words("")};
    }
    r.agents._buffer = entries;
    r.agents._length = r.agents._maximum = SEATS;
    p->registration_due = false;
    broker_registration(history.life.b, &r, life_now_ns());
    for (int seat = 0; seat < SEATS; seat++) {
        struct actor *a = &p->seats[seat];
        if (a->leaving) { /* it has said so */
            a->name = NOBODY;
            a->leaving = a->registered = false;
        }
    }
}

void net_match(void)
{
    for (int i = 0; i < PROCESSES; i++) {
        struct history_process *p = &history.processes[i];
        const struct processes *served = &history.life.b->processes;
        uint32_t place = processes_find(served, p->name);
        if (place != MU_NONE && !processes_is_matched(&served->at[place]) && p->alive &&
            p->reaches && !history_chance(3)) {
            history_note("%s has matched", p->name);
            p->hears = false;
            broker_matched(history.life.b, p->name, true, life_now_ns());
        }
    }
}

void net_lose(struct history_process *p, bool crashed)
{
    p->hears = false;
    if (!history.life.b) {
        return;
    }
    if (history_chance(2)) {
        broker_matched(history.life.b, p->name, false, life_now_ns());
        broker_gone(history.life.b, p->name, 0, crashed, life_now_ns());
    } else {
        broker_gone(history.life.b, p->name, 0, crashed, life_now_ns());
        broker_matched(history.life.b, p->name, false, life_now_ns());
    }
}

/* --- Ups -------------------------------------------------------------------------------------- */

static const char *const performatives[ASKS] = {"group-create", "group-join", "group-leave",
                                                "advertise",    "withdraw",   "find-service"};

static void dst_of(const struct entry *e, char *to, size_t size)
{
    size_t len = 0;
    to[0] = '\0';
    switch (e->to) {
    case TO_ALL: snprintf(to, size, "all"); return;
    case TO_ROBOTS: snprintf(to, size, "robots"); return;
    case TO_BROKER: snprintf(to, size, "broker"); return;
    case TO_GROUP: snprintf(to, size, "group:g%d", e->key); return;
    case TO_NAMES: break;
    }
    for (int name = 0; name < NAMES; name++) {
        if (e->addressed & 1u << name) {
            len +=
                (size_t)snprintf(to + len, size - len, "%s%s", len ? "," : "", history_name(name));
        }
    }
    if (e->to_unknown) {
        snprintf(to + len, size - len, "%sstranger", len ? "," : "");
    }
}

static void content_of(const struct entry *e, uint32_t mail, char *to, size_t size)
{
    if (e->to != TO_BROKER) {
        snprintf(to, size, "%lu", (unsigned long)mail);
    } else if (e->asks <= ASK_LEAVE) {
        snprintf(to, size, "g%d", e->key);
    } else if (e->asks == ASK_ADVERTISE) {
        snprintf(to, size, "s%d \"role=x\" %.4f", e->key, (double)e->ttl_ns / 1e9);
    } else {
        snprintf(to, size, "s%d", e->key);
    }
}

/* One mail reaches the broker. */
static void feed_mail(struct history_process *p, const struct up_mail *from)
{
    uint32_t mail = from->mail;
    const struct entry *e = &history.ledger[mail];
    int name = e->src;
    char dst[256], content[64], reply_with[16] = "";
    dst_of(e, dst, sizeof dst);
    content_of(e, mail, content, sizeof content);
    bool asks = e->to == TO_BROKER;
    if (asks && e->asks == ASK_FIND) {
        snprintf(reply_with, sizeof reply_with, "%lu", (unsigned long)mail);
    }
    muster_Mail m = {.src = words(history_name(e->src)),
                     .since_wall_ns = e->sender_life + 1,
                     .seq = from->seq,
                     .dst = dst,
                     .layer = e->layer,
                     .performative = words(asks ? performatives[e->asks] : "do"),
                     .language = words(""),
                     .ontology = words(""),
                     .reply_with = reply_with,
                     .in_reply_to = words(""),
                     .conversation = words(""),
                     .priority = e->priority,
                     .level = e->level,
                     .again = from->again,
                     .due_ns = e->due_ns,
                     .ttl_ns = asks ? 0 : e->ttl_ns,
                     .content = content};
    muster_Act act = {.agent = words(history_name(name)),
                      .state = muster_STATE_RUNNING,
                      .rules = words(""),
                      .first_seq = from->first_seq};
    act.mails = (dds_sequence_muster_Mail){._length = 1, ._maximum = 1, ._buffer = &m};
    muster_Up up = {.process = p->name, .step = muster_STEP_NOW};
    up.acts = (dds_sequence_muster_Act){._length = 1, ._maximum = 1, ._buffer = &act};
    muster_BrokerStatus was = life_status();
    muster_Member member;
    bool there = life_member(name, &member) && member.state != muster_STATE_ABSENT &&
                 strcmp(member.process, p->name) == 0;
    if (!there) {
        broker_up(history.life.b, &up, life_now_ns());
        HOLD(life_status().malformed == was.malformed + 1 && life_status().sent == was.sent);
        return;
    }
    history_note("%s/%llu #%lu to %s%s: %s %s", m.src, (unsigned long long)from->seq,
                 (unsigned long)mail, dst, from->again ? " again" : "", m.performative, content);
    uint64_t gaps = history.life.b->gaps;
    broker_up(history.life.b, &up, life_now_ns());
    muster_BrokerStatus is = life_status();
    if (history.life.b->gaps > gaps) { /* it waits for one that was lost */
        HOLD(is.sent == was.sent && is.waiting == was.waiting);
        return;
    }
    ledger_offer(mail, from->again, &was, &is);
}

/* One acknowledgement reaches the broker: this life of it, or one of which its sender has not heard
 * that it is over. */
static void feed_ack(const struct history_process *p, const struct up_ack *from)
{
    muster_Ack ack = {
        .box = words(history_name(from->name)), .number = from->number, .handed = from->handed};
    muster_Up up = {.process = words(p->name),
                    .broker_incarnation = from->incarnation,
                    .step = muster_STEP_NOW};
    up.acks = (dds_sequence_muster_Ack){._length = 1, ._maximum = 1, ._buffer = &ack};
    bool is_late = from->incarnation != history.life.incarnation;
    history_note("%s has up to %llu%s", ack.box, (unsigned long long)from->number,
                 is_late ? " of an earlier life" : "");
    uint64_t delivered = life_status().delivered;
    broker_up(history.life.b, &up, life_now_ns());
    HOLD(!is_late || life_status().delivered == delivered);
    history.seen.astray += is_late;
}

void net_feed(struct history_process *p)
{
    struct up up = p->ups[0];
    bool twice = !history.is_quiet && history.loses && history_chance(12) && p->ups_count < QUEUE;
    p->ups_count--;
    memmove(&p->ups[0], &p->ups[1], p->ups_count * sizeof p->ups[0]);
    for (uint32_t i = 0; i < up.acks_count; i++) {
        feed_ack(p, &up.acks[i]);
    }
    for (uint32_t i = 0; i < up.mails_count; i++) {
        feed_mail(p, &up.mails[i]);
    }
    if (twice) {
        p->ups[p->ups_count++] = up;
    }
}

/* --- Deliveries ------------------------------------------------------------------------------- */

void net_parcel_copy(const muster_Mail *m, uint64_t number, struct item *to)
{
    *to = (struct item){.box = NOBODY,
                        .src = history_name_index(m->src),
                        .number = number,
                        .since = m->since_wall_ns,
                        .seq = m->seq,
                        .priority = m->priority,
                        .layer = m->layer,
                        .again = m->again,
                        .text = mu_hash_string(m->content)};
    bool of_broker = to->src == NOBODY;
    HOLD(!of_broker || strcmp(m->src, "broker") == 0);
    to->mail = (uint32_t)strtoul(of_broker ? m->in_reply_to : m->content, NULL, 10);
    HOLD(to->mail < history.mails);
}

void net_parcel_check(const struct history_process *p, int box, const struct item *item)
{
    struct life *l = &history.life;
    muster_Member m;
    HOLD(box != NOBODY && life_member(box, &m) && strcmp(m.process, p->name) == 0);
    uint64_t *highest = &l->highest[box];
    if (*highest != 0 && item->number <= *highest) {
        HOLD(item->number > l->acked[box]);
        return;
    }
    HOLD(*highest == 0 || item->number == *highest + 1);
    HOLD(m.state == muster_STATE_RUNNING || item->layer == 0);
    *highest = item->number;
}

static void news_copy(struct history_process *p, const muster_Delivery *from)
{
    if (from->verdicts._length > 0) {
        uint64_t incarnation = from->verdicts._buffer[0].broker_incarnation;
        if (p->copied_from != 0 && p->copied_from != incarnation) {
            process_forget(p);
        }
        p->copied_from = incarnation;
    }
    for (uint32_t i = 0; i < from->members._length; i++) {
        int name = history_name_index(from->members._buffer[i].name);
        if (name != NOBODY) {
            p->seen[name] = from->members._buffer[i].state;
        }
    }
    for (uint32_t i = 0; i < from->memberships._length; i++) {
        const muster_Membership *m = &from->memberships._buffer[i];
        int name = history_name_index(m->agent);
        names *group = &p->members[m->group[1] - '0'];
        if (name != NOBODY) {
            *group = m->joined ? *group | 1u << name : *group & ~(1u << name);
        }
    }
    for (uint32_t i = 0; i < from->offers._length; i++) {
        const muster_Offer *o = &from->offers._buffer[i];
        names one = 1u << history_name_index(o->agent), *all = &p->offers[o->service[1] - '0'];
        *all = o->offered ? *all | one : *all & ~one;
    }
}

static void delivery_copy(struct history_process *p, const muster_Delivery *from)
{
    struct delivery *to = inbox_add(p, false);
    HOLD(from->parcels._length <= PARCELS && from->receipts._length <= RECEIPTS &&
         from->verdicts._length <= VERDICTS);
    to->chair = from->seat;
    to->serial = from->serial;
    many_count(p, from->seat, from->serial);
    to->parcels_count = from->parcels._length;
    to->receipts_count = from->receipts._length;
    to->verdicts_count = from->verdicts._length;
    for (uint32_t i = 0; i < to->parcels_count; i++) {
        const muster_Parcel *item = &from->parcels._buffer[i];
        net_parcel_copy(&item->letter, item->number, &to->parcels[i]);
        to->parcels[i].box = history_name_index(item->box);
        net_parcel_check(p, to->parcels[i].box, &to->parcels[i]);
    }
    for (uint32_t i = 0; i < to->receipts_count; i++) {
        const muster_Receipt *r = &from->receipts._buffer[i];
        to->receipts[i].name = history_name_index(r->agent);
        to->receipts[i].first = r->first_seq;
        to->receipts[i].last = r->last_seq;
        to->receipts[i].result = r->result;
    }
    for (uint32_t i = 0; i < to->verdicts_count; i++) {
        const muster_Verdict *v = &from->verdicts._buffer[i];
        to->verdicts[i].name = history_name_index(v->agent);
        to->verdicts[i].accepted = v->accepted;
        to->verdicts[i].last_seq = v->last_seq;
        to->verdicts[i].incarnation = v->broker_incarnation;
    }
    if (from->roll_call) {
        p->registration_due = true;
    }
    news_copy(p, from);
}

void net_deliver(void)
{
    const char *name;
    muster_Delivery d;
    while (broker_next(history.life.b, &name, &d)) {
        if (strcmp(name, BUS_TO_ALL) == 0) {
            many_deliver(&d);
            continue;
        }
        struct history_process *p = &history.processes[strtol(name + 1, NULL, 10)];
        HOLD(strcmp(name, p->name) == 0);
        bool lost = history.loses && !history.is_quiet && history_chance(6);
        if (lost || !p->alive || p->deliveries_count >= QUEUE) {
            broker_undelivered(history.life.b);
            continue;
        }
        if (d.parcels._length + d.receipts._length + d.verdicts._length + d.members._length) {
            history_note("to %s: %lu parcels, %lu receipts, %lu verdicts, %lu pages", name,
                         (unsigned long)d.parcels._length, (unsigned long)d.receipts._length,
                         (unsigned long)d.verdicts._length, (unsigned long)d.members._length);
        }
        delivery_copy(p, &d);
        broker_delivered(history.life.b, life_now_ns());
    }
}
