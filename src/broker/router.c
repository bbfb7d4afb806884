/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/router.h"

#include "broker/booking.h"
#include "broker/border.h"
#include "broker/boxroom.h"
#include "broker/desk.h"
#include "broker/guard.h"
#include "broker/journal.h"
#include "broker/parts.h"
#include "broker/presence.h"
#include "broker/query.h"
#include "core/address.h"
#include "core/fields.h"

#include <string.h>

/* Whom a mail is for, each once. */
struct audience {
    uint32_t agents[REGISTRY_MAX];
    uint32_t count;
    uint32_t unknown; /* names that nobody ever had */
    uint32_t refused; /* those whom the sender may not direct: not among the agents */
    uint32_t veiled;  /* those outside the lock step that the sender is in; set by mail_book */
};

/* @return whether the agent lives beyond another broker */
static bool place_is_broker(const struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].process;
    return place != MU_NONE && b->places.at[place].is_broker;
}

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
    case muster_STATE_SUSPENDED: return place_is_broker(b, agent) ? GATE_OPEN : GATE_URGENT;
    case muster_STATE_MOVING: return place_is_broker(b, agent) ? GATE_OPEN : GATE_SHUT;
    case muster_STATE_ABSENT: break;
    }
    return GATE_SHUT;
}

/* --- receivers -------------------------------------------------------------------------------- */

/* Who is in the lock step does not see the broker's parts. */
static bool is_hidden(const struct broker *b, uint32_t agent, uint32_t sender)
{
    return agent != REGISTRY_BROKER && registry_is_own(agent) && presence_in_lockstep(b, sender);
}

static void audience_of_names(struct broker *b, const char *names, uint32_t sender,
                              struct audience *to)
{
    char name[MU_NAME_MAX + 1];
    uint64_t mark = ++b->registry.mark;
    while (*names && mu_address_next(&names, name)) {
        uint32_t agent = registry_find(&b->registry, name);
        if (agent == MU_NONE || is_hidden(b, agent, sender)) {
            to->unknown++;
        } else if (b->registry.agents[agent].mark != mark) {
            b->registry.agents[agent].mark = mark;
            to->agents[to->count++] = agent;
        }
    }
}

/* Those whom a resolver has named: the sender, and who is nobody, are left out; of the lock step
 * nobody can be among them but when a step ends. */
static void audience_of_answer(struct broker *b, const char *names, uint32_t sender,
                               struct audience *to)
{
    char name[MU_NAME_MAX + 1];
    struct mu_text read;
    uint64_t mark = ++b->registry.mark;
    bool open = !b->lockstep.on || b->lockstep.applying;
    mu_text_init(&read, name, sizeof name);
    to->count = to->unknown = to->refused = 0;
    while (mu_fields_next(&names, &read) || read.cut) {
        uint32_t agent = read.cut ? MU_NONE : registry_find(&b->registry, name);
        if (agent != MU_NONE && agent != sender && !registry_is_own(agent) &&
            b->registry.agents[agent].mark != mark && (open || !presence_in_lockstep(b, agent))) {
            b->registry.agents[agent].mark = mark;
            to->agents[to->count++] = agent;
        }
    }
}

static bool kind_is_addressed(enum mu_address_kind kind, muster_Kind of)
{
    return kind == MU_ADDRESS_ALL || (kind == MU_ADDRESS_ROBOTS && of == muster_KIND_ROBOT) ||
           (kind == MU_ADDRESS_SPECIAL && of == muster_KIND_SPECIAL);
}

/* Members of a group who are in the lock step, or who are not.  Who is one of the former is for
 * those inside to say, whatever another broker has said meanwhile. */
static void audience_of_members(struct broker *b, const char *group, bool inside, uint32_t sender,
                                struct audience *to)
{
    uint32_t place = 0;
    for (const char *name; (name = groups_member(&b->pages.groups, group, inside, &place));) {
        uint32_t agent = registry_find(&b->registry, name);
        if (agent != MU_NONE && agent != sender && pages_inside(b, agent) == inside) {
            to->agents[to->count++] = agent;
        }
    }
}

/* The members of a group, the absent ones, too.  Members of the lock step know no other groups than
 * those that are seen inside. */
static void audience_of_group(struct broker *b, const char *group, uint32_t sender,
                              struct audience *to)
{
    if (!groups_exists(&b->pages.groups, group, pages_inside(b, sender))) {
        to->unknown++;
        return;
    }
    if (b->lockstep.on) {
        audience_of_members(b, group, true, sender, to);
    }
    audience_of_members(b, group, false, sender, to);
}

/* A broadcast from inside the lock step does not go beyond the broker: who is there is known by
 * the wall clock. */
static bool is_too_far(const struct broker *b, uint32_t agent, uint32_t sender)
{
    return place_is_broker(b, agent) && presence_in_lockstep(b, sender);
}

/* A directive to all finds those, too, that want no broadcasts. */
static void audience_of(struct broker *b, const muster_Mail *letter, uint32_t sender,
                        struct audience *to)
{
    to->count = to->unknown = to->refused = 0;
    enum mu_address_kind kind = mu_address_kind(letter->dst);
    if (kind == MU_ADDRESS_NAMES) {
        audience_of_names(b, letter->dst, sender, to);
        return;
    }
    if (kind == MU_ADDRESS_GROUP) {
        audience_of_group(b, mu_address_rest(letter->dst), sender, to);
        return;
    }
    if (kind == MU_ADDRESS_SCHEME) {
        to->unknown += !resolve_is_possible(b, letter->dst);
        return;
    }
    for (uint32_t i = 0; i < b->registry.count; i++) {
        uint32_t agent = b->registry.order[i];
        const struct agent *a = &b->registry.agents[agent];
        if (!registry_is_own(agent) && agent != sender && a->process != MU_NONE &&
            kind_is_addressed(kind, a->is.kind) &&
            !(kind == MU_ADDRESS_ALL && a->is.no_broadcasts && letter->layer != 0) &&
            !is_too_far(b, agent, sender)) {
            to->agents[to->count++] = agent;
        }
    }
}

static void audience_of_mail(struct broker *b, const struct mail *m, struct audience *to)
{
    if (m->only == MU_NONE) {
        audience_of(b, &m->letter, m->sender, to);
        return;
    }
    to->unknown = to->refused = 0;
    to->count = 1;
    to->agents[0] = m->only;
}

bool router_meets_lockstep(struct broker *b, const struct mail *m)
{
    struct audience to;
    if (m->only == MU_NONE && mu_address_kind(m->letter.dst) == MU_ADDRESS_SCHEME) {
        return resolve_is_possible(b, m->letter.dst); /* only members of the lock step are asked */
    }
    audience_of_mail(b, m, &to);
    bool durable = m->letter.level != muster_LEVEL_RAM && m->letter.hops == 0;
    bool meets = lockstep_keeps_address(&b->lockstep, m->sender) ||
                 (durable && lockstep_keeps_durable(&b->lockstep, m->sender));
    for (uint32_t i = 0; i < to.count && !meets; i++) {
        /* What changes the broker itself takes effect between steps, too. */
        meets =
            presence_in_lockstep(b, to.agents[i]) ||
            (registry_is_own(to.agents[i]) && (m->letter.layer == 0 || query_changes_member(b, m)));
    }
    return meets;
}

/* --- what becomes of a mail ------------------------------------------------------------------- */

/* @return whether the news can wait: its sender sends what does not get through */
static bool news_can_wait(struct broker *b, uint32_t sender, muster_Outcome result)
{
    bool bad = result == muster_OUTCOME_BOX_FULL || result == muster_OUTCOME_DROPPED;
    return bad && !presence_in_lockstep(b, sender) &&
           pacer_holds(&b->pacer, sender, b->clock.now_ns);
}

void router_tell(struct broker *b, uint32_t sender, uint64_t first_seq, uint64_t last_seq,
                 muster_Outcome result)
{
    const struct agent *a = &b->registry.agents[sender];
    if (a->process == MU_NONE && !a->awaited) { /* the absent are told nothing, nor is the broker */
        return;
    }
    receipts_add(&b->receipts, sender, first_seq, last_seq, result);
    if (a->process != MU_NONE && !news_can_wait(b, sender, result)) {
        tenants_wake(&b->registry, &b->places, sender);
    }
}

static void tell_sender(struct broker *b, uint32_t sender, uint64_t seq, muster_Outcome result)
{
    router_tell(b, sender, seq, seq, result);
}

void router_tick(struct broker *b)
{
    uint32_t agent;
    while ((agent = pacer_next(&b->pacer, b->clock.now_ns)) != MU_NONE) {
        tenants_wake(&b->registry, &b->places, agent);
    }
}

/* The last word on a mail; what its other receivers do is not told any more. */
static void answer(struct broker *b, struct mail *m, muster_Outcome result)
{
    if (!m->answered) {
        if (result != muster_OUTCOME_DELIVERED && result != muster_OUTCOME_STORED) {
            journal_failed(b, m->sender, &m->letter);
        }
        m->answered = true;
        tell_sender(b, m->sender, m->letter.seq, result);
    }
}

static void tell_stored(struct broker *b, struct mail *m)
{
    if (!m->answered && !m->stored_told) {
        m->stored_told = true;
        tell_sender(b, m->sender, m->letter.seq, muster_OUTCOME_STORED);
    }
}

/* The last word on a mail that all receivers are through with, as far as it is known here: what
 * becomes of what another broker has taken over, that broker tells. */
static void answer_settled(struct broker *b, struct mail *m)
{
    if (m->stored_ends_it) {
        answer(b, m, muster_OUTCOME_STORED);
    } else if (m->dropped) {
        answer(b, m, muster_OUTCOME_DROPPED);
    } else if (m->expired) {
        answer(b, m, muster_OUTCOME_EXPIRED);
    } else if (m->passed_on) {
        tell_stored(b, m);
    } else {
        answer(b, m, muster_OUTCOME_DELIVERED);
    }
}

/* One receiver is through with it. */
static void settle(struct broker *b, struct mail *m)
{
    b->counters.waiting--;
    MU_ASSERT(m->unsettled > 0);
    m->unsettled--;
    booking_give_back(b, m);
    journal_settled(b, m);
    if (m->unsettled == 0) {
        schedule_remove(&b->due, m);
        schedule_remove(&b->expiry, m);
        ages_remove(&b->ages, m);
        answer_settled(b, m);
        store_release(&b->store, m);
    }
}

void router_acknowledge(struct broker *b, uint32_t agent, uint64_t number)
{
    struct box *box = mailbox_box(&b->mailbox, agent);
    if (!mailbox_number_valid(&b->mailbox, agent, number)) {
        b->counters.malformed++;
        return;
    }
    if (number <= box->acked) {
        return;
    }
    bool beyond = place_is_broker(b, agent);
    while (box->acked < number) {
        struct mail *m = mailbox_pop(&b->mailbox, agent);
        m->passed_on = m->passed_on || beyond;
        journal_acknowledged(b, agent, m);
        *(beyond ? &b->liaison.count.passed_on : &b->counters.delivered) += 1;
        settle(b, m);
    }
    if (!presence_in_lockstep(b, agent)) {
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
                settle(b, m);
            }
        }
        store_release(&b->store, m);
    }
}

/* --- on its way ------------------------------------------------------------------------------- */

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

static bool mail_must_wait(const struct broker *b, const struct mail *m)
{
    return m->letter.due_ns >= 0 &&
           (!b->clock.runs || (uint64_t)m->letter.due_ns > runclock_run_ns(&b->clock));
}

/* A mail goes out of a box to make room. */
static void post_drop(struct broker *b, uint32_t victim, uint32_t agent)
{
    struct mail *m = b->mailbox.posts[victim].mail;
    mailbox_withdraw(&b->mailbox, victim);
    b->counters.dropped++;
    booking_event(b, EVENT_DROPPED, agent, m->sender);
    m->dropped = true;
    settle(b, m);
}

/* What becomes of it outside the lock step, and when, is no business of those inside. */
static bool is_veiled(const struct broker *b, const struct mail *m, uint32_t agent)
{
    return !registry_is_own(agent) && presence_in_lockstep(b, m->sender) &&
           !presence_in_lockstep(b, agent);
}

/* Puts it into one box.  @return false when that has no room for it */
static bool post(struct broker *b, struct mail *m, uint32_t agent, bool held)
{
    uint32_t victim = MU_NONE;
    enum boxroom room = boxroom_ask(&b->mailbox, agent, m, &victim);
    for (; room == BOXROOM_DROP; room = boxroom_ask(&b->mailbox, agent, m, &victim)) {
        post_drop(b, victim, agent);
    }
    if (room != BOXROOM_FITS || mailbox_put(&b->mailbox, agent, m, held) != MU_OK) {
        booking_refused(b, m, agent, room == BOXROOM_OVER_SHARE ? SHARE_OVER : SHARE_FULL, 1);
        return false;
    }
    b->counters.waiting++;
    m->unsettled++;
    if (is_veiled(b, m, agent)) {
        mailbox_veil(&b->mailbox, m);
    }
    tenants_wake(&b->registry, &b->places, agent);
    return true;
}

static void put_on_schedules(struct broker *b, struct mail *m, bool held, uint64_t left_ns)
{
    uint64_t now_ns = runclock_mail_ns(&b->clock);
    ages_add(&b->ages, m, now_ns);
    if (held) {
        m->at_ns[SCHEDULE_DUE] = (uint64_t)m->letter.due_ns;
        schedule_add(&b->due, m);
    }
    if (m->letter.ttl_ns > 0 && now_ns + left_ns >= now_ns) {
        m->at_ns[SCHEDULE_EXPIRY] = now_ns + left_ns;
        schedule_add(&b->expiry, m);
    }
}

/* Puts it into every box.  @return whether all is well; the sender is told if not */
static void post_to_all(struct broker *b, struct mail *m, const struct audience *to)
{
    bool held = mail_must_wait(b, m), all_fit = true, stored = held, veiled = to->veiled > 0;
    enum mailbox_gate needs = m->letter.layer == 0 ? GATE_URGENT : GATE_OPEN;
    for (uint32_t i = 0; i < to->count; i++) {
        uint32_t agent = to->agents[i];
        if (registry_is_own(agent)) {
            b->counters.delivered++;
            desk_take(b, agent, m);
        } else if (!post(b, m, agent, held)) {
            all_fit = all_fit && is_veiled(b, m, agent);
        } else {
            stored = stored || router_gate(b, agent) < needs;
        }
    }
    booking_give_back(b, m);
    if (to->refused > 0) {
        answer(b, m, muster_OUTCOME_REFUSED);
    } else if (to->unknown > 0) {
        answer(b, m, muster_OUTCOME_UNKNOWN_NAME);
    } else if (!all_fit) {
        answer(b, m, muster_OUTCOME_BOX_FULL);
    } else if (veiled && (m->unsettled == 0 || m->letter.level == muster_LEVEL_RAM)) {
        answer(b, m, muster_OUTCOME_STORED);
    } else if (veiled) {
        m->stored_ends_it = m->tell_stored = true;
    } else if (m->unsettled == 0) {
        answer(b, m, muster_OUTCOME_DELIVERED);
    } else if (stored && m->letter.level != muster_LEVEL_RAM) {
        m->tell_stored = true; /* when it is */
    } else if (stored) {
        tell_stored(b, m);
    }
    if (m->unsettled == 0) {
        store_release(&b->store, m);
    } else {
        put_on_schedules(b, m, held, m->letter.ttl_ns);
        journal_put(b, m);
    }
}

/* Those outside are not reached. */
static void audience_unveil(const struct broker *b, const struct mail *m, struct audience *to)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < to->count; i++) {
        if (!is_veiled(b, m, to->agents[i])) {
            to->agents[kept++] = to->agents[i];
        }
    }
    to->count = kept;
}

/* Books it on its sender's account with the store.  @return false: refused, counted, told */
static bool mail_book(struct broker *b, struct mail *m, struct audience *to)
{
    to->veiled = 0;
    for (uint32_t i = 0; i < to->count; i++) {
        to->veiled += is_veiled(b, m, to->agents[i]);
    }
    if (booking_take(b, m, to->count - to->veiled)) {
        if (to->veiled > 0 && !booking_take_veiled(b, m, to->veiled)) {
            audience_unveil(b, m, to);
        }
        return true;
    }
    b->counters.box_full += to->veiled; /* the others have been counted */
    answer(b, m, to->unknown > 0 ? muster_OUTCOME_UNKNOWN_NAME : muster_OUTCOME_BOX_FULL);
    store_release(&b->store, m);
    return false;
}

/* The disk has failed since it was admitted. */
static void mail_unstored(struct broker *b, struct mail *m, const struct audience *to)
{
    b->counters.no_store += to->count;
    answer(b, m, to->unknown > 0 ? muster_OUTCOME_UNKNOWN_NAME : muster_OUTCOME_NO_STORE);
    store_release(&b->store, m);
}

void router_stored(struct broker *b, struct mail *m)
{
    if (m->tell_stored && m->stored_ends_it) {
        answer(b, m, muster_OUTCOME_STORED);
    } else if (m->tell_stored) {
        tell_stored(b, m);
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
    answer(b, m, muster_OUTCOME_NO_STORE);
    store_release(&b->store, m);
}

bool router_restore(struct broker *b, struct mail *m, const char *waiting, uint64_t left_ns)
{
    struct audience to = {.count = 0};
    audience_of_names(b, waiting, m->sender, &to);
    m->order = ++b->orders;
    bool held = mail_must_wait(b, m);
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
    put_on_schedules(b, m, held, left_ns);
    return true;
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
        answer(b, m, muster_OUTCOME_BOX_FULL);
        store_release(&b->store, m);
    }
    return true;
}

bool router_go_on(struct broker *b, struct mail *m, const char *names)
{
    struct audience to;
    if (names) {
        audience_of_answer(b, names, m->sender, &to);
        to.unknown = to.count == 0 ? 1 : 0; /* an address that nobody fits */
    } else {
        audience_of_mail(b, m, &to);
        bool unresolved = m->only == MU_NONE && mu_address_kind(m->letter.dst) == MU_ADDRESS_SCHEME;
        to.unknown = unresolved ? 1 : to.unknown;
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
    } else if (mail_book(b, m, &to)) {
        post_to_all(b, m, &to);
    }
    return goes_on;
}

void router_turn_away(struct broker *b, struct mail *m)
{
    struct audience to;
    audience_of_mail(b, m, &to);
    b->counters.sent += to.count + to.unknown;
    b->counters.unknown_name += to.unknown;
    booking_refused(b, m, REGISTRY_BROKER, SHARE_OVER, to.count);
    answer(b, m, to.unknown > 0 ? muster_OUTCOME_UNKNOWN_NAME : muster_OUTCOME_BOX_FULL);
    store_release(&b->store, m);
}

void router_drop(struct broker *b, struct mail *m)
{
    struct audience to;
    audience_of_mail(b, m, &to);
    b->counters.sent += to.count + to.unknown;
    b->counters.unknown_name += to.unknown;
    b->counters.dropped += to.count;
    answer(b, m, muster_OUTCOME_DROPPED);
    store_release(&b->store, m);
}

void router_post(struct broker *b, uint32_t receiver, const muster_Mail *letter)
{
    struct audience to; /* too large to be cleared for every answer */
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
    if (mail_book(b, m, &to)) {
        post_to_all(b, m, &to);
    }
}

/* Has the broker had this mail before?  What an earlier life of it has had is known of durable mail
 * alone, and asked only of what may have come to that life. */
static bool was_had(const struct broker *b, uint32_t sender, const muster_Mail *letter,
                    muster_Outcome *outcome)
{
    const struct agent *a = &b->registry.agents[sender];
    *outcome = muster_OUTCOME_DUPLICATE;
    const struct mail *m = journal_find(&b->journal, sender, letter->seq);
    if (letter->seq <= a->seen_seq) {
        /* Its answer is still to come, and a sender that hears of a duplicate asks no more: what
         * is on disk already is said to be there, lest this life ends before the answer. */
        if (m && m->journal_written && !presence_in_lockstep(b, sender)) {
            *outcome = muster_OUTCOME_STORED;
        }
        return true;
    }
    if (!letter->again || letter->level == muster_LEVEL_RAM || letter->seq > a->durable_seq) {
        return false;
    }
    if (m) {
        *outcome = muster_OUTCOME_STORED;
    } else if (letter->seq > a->failed_seq) {
        *outcome = muster_OUTCOME_DELIVERED; /* of the others, how they ended is not known */
    }
    return true;
}

/* There is no room for it, whoever it is for. */
static void turn_away(struct broker *b, uint32_t sender, const muster_Mail *letter,
                      uint64_t *counter, muster_Outcome outcome)
{
    struct audience to;
    audience_of(b, letter, sender, &to);
    b->counters.sent += to.count + to.unknown;
    *counter += to.count + to.unknown;
    journal_failed(b, sender, letter);
    tell_sender(b, sender, letter->seq, outcome);
}

struct mail *router_admit(struct broker *b, uint32_t sender, const muster_Mail *letter)
{
    struct agent *a = &b->registry.agents[sender];
    if (!border_string(letter->src, MU_NAME_MAX) || strcmp(letter->src, a->name) != 0) {
        b->counters.malformed++;
        return NULL;
    }
    muster_Outcome had;
    if (was_had(b, sender, letter, &had)) {
        b->counters.duplicates_dropped++;
        tell_sender(b, sender, letter->seq, had);
        return NULL;
    }
    a->seen_seq = letter->seq;
    journal_seq(b, sender);
    if (!border_mail(letter)) {
        b->counters.malformed++;
        journal_failed(b, sender, letter);
        tell_sender(b, sender, letter->seq, muster_OUTCOME_REFUSED);
        return NULL;
    }
    if (letter->level != muster_LEVEL_RAM && !journal_takes(b)) {
        turn_away(b, sender, letter, &b->counters.no_store, muster_OUTCOME_NO_STORE);
        return NULL;
    }
    struct mail *m = store_put(&b->store, letter);
    if (!m) {
        booking_event(b, EVENT_BOX_FULL, REGISTRY_BROKER, sender);
        turn_away(b, sender, letter, &b->counters.box_full, muster_OUTCOME_BOX_FULL);
        return NULL;
    }
    m->sender = m->payer = sender;
    return m;
}
