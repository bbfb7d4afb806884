/* SPDX-License-Identifier: Apache-2.0 */
/* The runtime's side of the promises: numbers, sending again, taking, acknowledging. */
#include "history.h"

#include <string.h>

#define RESEND_NS (1000 * MS)
#define BEAT_NS   (300 * MS)

struct actor *process_agent(struct history_process *p, int name)
{
    for (int seat = 0; p->alive && seat < SEATS; seat++) {
        if (p->seats[seat].name == name) {
            return &p->seats[seat];
        }
    }
    return NULL;
}

struct actor *agent_of(int name)
{
    for (int i = 0; i < PROCESSES; i++) {
        struct actor *a = process_agent(&history.processes[i], name);
        if (a && a->registered && !a->leaving) {
            return a;
        }
    }
    return NULL;
}

void agent_join(struct history_process *p, int seat, int name)
{
    struct actor *a = &p->seats[seat];
    memset(a, 0, sizeof *a);
    a->name = name;
    a->first_seq = a->next_seq = 1;
    a->life = ++history.sender_lives;
    HOLD(a->life < LIVES);
    a->state = muster_STATE_RUNNING;
    a->policy = history_chance(6) ? muster_BOX_DROP_OLDEST : muster_BOX_REFUSE_NEW;
    history.drops |= a->policy ? 1u << name : 0;
    a->box_mails = history_chance(6) ? 6 + history_roll(10) : 0;
    uint32_t *most = &history.asked_most[name];
    *most = a->box_mails > *most ? a->box_mails : *most;
    p->registration_due = true;
    history_note("%s joins in %s", history_name(name), p->name);
}

void process_forget(struct history_process *p)
{
    for (int name = 0; name < NAMES; name++) {
        p->seen[name] = muster_STATE_ABSENT;
    }
    memset(p->members, 0, sizeof p->members);
    memset(p->offers, 0, sizeof p->offers);
}

void process_begin(struct history_process *p)
{
    p->alive = true;
    p->incarnation = history.now_ns;
    p->ups_count = p->deliveries_count = 0;
    p->registration_due = true;
    for (int seat = 0; seat < SEATS; seat++) {
        p->seats[seat].name = NOBODY;
    }
    process_forget(p);
    p->copied_from = 0;
    p->has_ears = !history_chance(5);
    memset(&p->inbox, 0, sizeof p->inbox);
    history_note("%s begins%s", p->name, p->has_ears ? "" : " and hears no circulars");
}

void process_beat(struct history_process *p)
{
    if (history.now_ns - p->beat_ns >= BEAT_NS) {
        p->beat_ns = history.now_ns;
        p->registration_due = true;
    }
}

/* --- what it has sent ------------------------------------------------------------------------- */

bool agent_send(struct actor *a, uint32_t mail)
{
    if (a->waiting == OUTBOX) {
        return false;
    }
    a->outbox[a->waiting++] = (struct slot){.mail = mail, .seq = a->next_seq++};
    return true;
}

/* What a new sender has not sent yet is numbered after all that its name has sent before. */
static void numbers_continue(struct actor *a, uint64_t last_seq)
{
    uint64_t known = a->begun ? a->next_seq - 1 : a->first_seq - 1;
    if (last_seq <= known || a->unsent > 0) {
        return;
    }
    uint64_t shift = last_seq + 1 - a->first_seq;
    for (uint32_t i = 0; i < a->waiting; i++) {
        a->outbox[i].seq += shift;
    }
    a->first_seq += shift;
    a->next_seq += shift;
}

static void mails_confirm(struct actor *a, uint64_t first, uint64_t last)
{
    uint32_t gone = 0;
    for (uint32_t i = 0; i < a->waiting; i++) {
        struct slot *s = &a->outbox[i];
        s->confirmed = s->confirmed || (s->seq >= first && s->seq <= last);
    }
    while (gone < a->waiting && a->outbox[gone].confirmed) {
        gone++;
    }
    a->waiting -= gone;
    a->first_seq += gone;
    a->unsent -= gone < a->unsent ? gone : a->unsent;
    memmove(a->outbox, a->outbox + gone, a->waiting * sizeof a->outbox[0]);
}

static void mails_again(struct actor *a)
{
    for (uint32_t i = 0; i < a->waiting; i++) {
        a->outbox[i].again = a->outbox[i].sent;
    }
    a->unsent = 0;
}

/* --- what it is told -------------------------------------------------------------------------- */

/* Two may live with one name while the network has lost one of them. */
static void contest(const struct actor *a)
{
    for (int i = 0; i < PROCESSES * SEATS; i++) {
        const struct history_process *p = &history.processes[i / SEATS];
        const struct actor *other = &p->seats[i % SEATS];
        if (p->alive && other != a && other->name == a->name &&
            (other->begun || other->registered)) {
            history.contested[other->life] = history.contested[a->life] = true;
        }
    }
}

/* @return whether another one has sent mail of that name since the broker wrote the verdict: it had
 * the name back, and may be dead when this one reads that it was accepted */
static bool verdict_is_stale(const struct actor *a, uint64_t last_seq)
{
    for (uint32_t i = 0; i < history.mails; i++) {
        const struct entry *e = &history.ledger[i];
        if (e->src == a->name && e->sender_life != a->life && e->accepted > 0 &&
            e->life == history.life.number && e->seq > last_seq) {
            return true;
        }
    }
    return false;
}

static void verdict_take(struct history_process *p, struct actor *a, bool accepted,
                         uint64_t last_seq, uint64_t incarnation)
{
    if (a->refused == accepted) {
        a->refused = !accepted;
        p->registration_due = true;
    }
    bool was_registered = a->registered;
    a->registered = accepted;
    if (!accepted) {
        return;
    }
    if (a->incarnation != 0 && a->incarnation != incarnation) {
        a->last_number = a->acked_number = 0;
        was_registered = true;
    }
    if (was_registered) { /* what it has sent may be lost */
        mails_again(a);
        a->earlier_end = a->next_seq;
    }
    a->incarnation = incarnation;
    a->in_order = false;
    contest(a);
    history.contested[a->life] |= verdict_is_stale(a, last_seq);
    if (a->first_seq >= a->earlier_end) {
        numbers_continue(a, last_seq);
    }
    a->progress_ns = history.now_ns;
}

static bool ring_has(const struct actor *a, const struct item *p)
{
    for (uint32_t i = 0; i < TAKEN; i++) {
        bool same_life = a->ring[i].since == p->since || a->ring[i].since == 0 || p->since == 0;
        if (a->ring[i].seq == p->seq && a->ring[i].src == p->src && same_life) {
            return p->seq != 0;
        }
    }
    return false;
}

/* @return for whom a delivery item is; of a multicast, who was in that seat when it was written; or
 * NULL */
static struct actor *parcel_agent(struct history_process *p, const struct delivery *d,
                                  const struct item *item)
{
    if (!d->is_circular) {
        return process_agent(p, item->box);
    }
    struct actor *a = &p->seats[item->seat];
    return a->name != NOBODY && a->registered && a->accepted_serial < d->serial ? a : NULL;
}

static void item_take(struct actor *a, const struct item *p, uint32_t life)
{
    if (!a->registered && !a->in_order) {
        return; /* it was for one of its name who has left */
    }
    if (p->number <= a->last_number || (a->in_order && p->number != a->last_number + 1)) {
        history_note("%s does not take %llu after %llu", history_name(a->name),
                     (unsigned long long)p->number, (unsigned long long)a->last_number);
    }
    if (p->number <= a->last_number) {
        a->acked_number = 0; /* our acknowledgement was lost */
        return;
    }
    if (a->in_order && p->number != a->last_number + 1) {
        return; /* the broker will begin where one is missing */
    }
    a->in_order = true;
    a->last_number = p->number;
    if (p->again && ring_has(a, p)) {
        history.seen.repeats++;
        return;
    }
    a->ring[a->ring_next].src = p->src;
    a->ring[a->ring_next].since = p->since;
    a->ring[a->ring_next].seq = p->seq;
    a->ring_next = (a->ring_next + 1) % TAKEN;
    a->handed++;
    ledger_hand(a, p, life);
}

void process_take(struct history_process *p, const struct delivery *d)
{
    for (uint32_t i = 0; i < d->verdicts_count; i++) {
        struct actor *a = process_agent(p, d->verdicts[i].name);
        if (a) {
            history_note("%s in %s: %s", history_name(a->name), p->name,
                         d->verdicts[i].accepted ? "accepted" : "refused");
            verdict_take(p, a, d->verdicts[i].accepted, d->verdicts[i].last_seq,
                         d->verdicts[i].incarnation);
            a->accepted_serial = d->serial;
        }
    }
    for (uint32_t i = 0; i < d->receipts_count; i++) {
        struct actor *a = process_agent(p, d->receipts[i].name);
        if (!a) {
            continue;
        }
        mails_confirm(a, d->receipts[i].first, d->receipts[i].last);
        a->progress_ns = history.now_ns;
        for (uint64_t seq = d->receipts[i].first; seq <= d->receipts[i].last; seq++) {
            if (a->begun && d->receipts[i].last >= a->own_seq) {
                ledger_told(a, seq, d->receipts[i].result, d->life);
            }
        }
    }
    for (uint32_t i = 0; i < d->parcels_count; i++) {
        const struct item *item = &d->parcels[i];
        struct actor *a = parcel_agent(p, d, item);
        if (a && !a->leaving) {
            item_take(a, item, d->life);
        }
    }
}

/* --- what it says ----------------------------------------------------------------------------- */

static void up_add_mails(struct actor *a, int seat, struct up *up)
{
    for (; a->registered && a->unsent < a->waiting && up->mails_count < UP_MAILS; a->unsent++) {
        struct slot *s = &a->outbox[a->unsent];
        up->mails[up->mails_count].seat = seat;
        up->mails[up->mails_count].mail = s->mail;
        up->mails[up->mails_count].seq = s->seq;
        up->mails[up->mails_count].first_seq = a->first_seq;
        up->mails[up->mails_count++].again = s->again;
        history.ledger[s->mail].seq = s->seq;
        a->own_seq = a->begun ? a->own_seq : s->seq;
        a->begun = s->sent = true;
        a->progress_ns = history.now_ns;
        history.seen.again += s->again;
    }
}

void process_flush(struct history_process *p)
{
    if (p->ups_count == QUEUE || !p->reaches || !history.life.b) {
        return;
    }
    struct up *up = &p->ups[p->ups_count];
    up->mails_count = up->acks_count = 0;
    for (int seat = 0; seat < SEATS; seat++) {
        struct actor *a = &p->seats[seat];
        if (a->name == NOBODY || a->leaving) {
            continue;
        }
        if (a->unsent > 0 && history.now_ns - a->progress_ns > RESEND_NS) {
            mails_again(a);
        }
        up_add_mails(a, seat, up);
        if (a->acked_number != a->last_number) {
            up->acks[up->acks_count++] = (struct up_ack){.name = a->name,
                                                         .number = a->last_number,
                                                         .handed = a->handed,
                                                         .incarnation = a->incarnation};
            a->acked_number = a->last_number;
        }
    }
    p->ups_count += up->mails_count + up->acks_count > 0;
}
