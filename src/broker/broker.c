/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/broker.h"

#include "broker/border.h"
#include "broker/parts.h"
#include "broker/presence.h"
#include "broker/router.h"
#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

static const uint64_t RESEND_AFTER_NS = 1000000000;
static const uint64_t HOLD_NS = 1500000000;

/* The broker's own line of the white pages. */
static void broker_enlist(struct broker *b, const struct broker_options *options)
{
    struct presence is = {
        .kind = muster_KIND_SPECIAL, .state = muster_STATE_RUNNING, .pid = options->pid};
    (void)mu_text_copy(is.host, sizeof is.host, options->host);
    uint32_t self = registry_add(&b->registry, "broker");
    MU_ASSERT(self == REGISTRY_BROKER);
    registry_seat(&b->registry, self, MU_NONE, "", &is, options->wall_ns);
}

struct broker *broker_open(const struct broker_options *options)
{
    struct broker *b = mu_startup_alloc(sizeof *b);
    (void)mu_text_copy(b->name, sizeof b->name, options->name);
    b->incarnation = options->incarnation;
    b->wall_ns = options->wall_ns;
    b->resend_after_ns = options->resend_after_ns ? options->resend_after_ns : RESEND_AFTER_NS;
    b->hold_ns = options->hold_ns ? options->hold_ns : HOLD_NS;
    registry_init(&b->registry);
    places_init(&b->places);
    store_init(&b->store);
    schedule_init(&b->due, SCHEDULE_DUE);
    schedule_init(&b->expiry, SCHEDULE_EXPIRY);
    mailbox_init(&b->mailbox, REGISTRY_MAX);
    receipts_init(&b->receipts, REGISTRY_MAX);
    lockstep_init(&b->lockstep, REGISTRY_MAX);
    courier_init(&b->courier);
    journal_init(&b->journal, options->has_store);
    b->mailbox.base = options->number_base;
    broker_enlist(b, options);
    return b;
}

/* Every call that changes something begins here. */
static void broker_enter(struct broker *b, uint64_t now_ns)
{
    MU_ASSERT(b->courier.open == MU_NONE); /* the last Delivery's fate is not known yet */
    runclock_set_now(&b->clock, now_ns);
}

void broker_registration(struct broker *b, const muster_Registration *r, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    presence_register(b, r);
}

void broker_gone(struct broker *b, const char *name, const char *process, bool crashed,
                 uint64_t now_ns)
{
    broker_enter(b, now_ns);
    uint32_t agent = border_string(name, MU_NAME_MAX) ? registry_find(&b->registry, name) : MU_NONE;
    if (agent == MU_NONE || agent == REGISTRY_BROKER) {
        return;
    }
    if (!process || process[0] == '\0') {
        presence_gone_unnamed(b, agent, crashed);
    } else if (border_string(process, MU_PROCESS_MAX)) {
        uint32_t place = places_find(&b->places, process);
        if (place != MU_NONE) {
            presence_gone(b, agent, place);
        }
    }
}

/* The reader is there, perhaps another one than before: it is told everything again. */
static void place_matched(struct broker *b, uint32_t place)
{
    struct place *at = &b->places.at[place];
    at->version_had = 0;
    for (uint32_t i = 0; i < at->agents_count; i++) {
        b->registry.agents[at->agents[i]].verdict_due = true;
        mailbox_repeat(&b->mailbox, at->agents[i]);
    }
    if (at->rostered || at->simulator) {
        at->step_due = true;
    }
    places_wake(&b->places, place);
}

void broker_matched(struct broker *b, const char *process, bool matched, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    if (!border_string(process, MU_PROCESS_MAX) || !places_name_valid(process)) {
        return;
    }
    uint32_t place = matched ? places_get(&b->places, process) : places_find(&b->places, process);
    if (place == MU_NONE) {
        return;
    }
    places_set_matched(&b->places, place, matched);
    if (matched) {
        place_matched(b, place);
        return;
    }
    struct place *at = &b->places.at[place];
    for (uint32_t i = 0; i < at->agents_count; i++) {
        mailbox_unwatch(&b->mailbox, at->agents[i]);
    }
    at->refusals_count = at->agents_count ? at->refusals_count : 0;
    places_tidy(&b->places, place);
}

void broker_roster(struct broker *b, const muster_Roster *roster, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    if (border_roster(roster)) {
        lockstep_set_roster(b, roster);
    } else {
        b->counters.malformed++;
    }
}

/* --- what processes send ---------------------------------------------------------------------- */

/* When what an Up says takes effect. */
enum up_effect { EFFECT_NOW, EFFECT_STEP, EFFECT_STEP_AS_OUTSIDE };

/* @return the agent of that name, if it lives there, or MU_NONE */
static uint32_t agent_at(const struct broker *b, uint32_t place, const char *name)
{
    uint32_t agent = registry_find(&b->registry, name);
    bool there = agent != MU_NONE && b->registry.agents[agent].process == place;
    return there ? agent : MU_NONE;
}

static void mail_take(struct broker *b, uint32_t sender, const muster_Mail *letter,
                      enum up_effect effect)
{
    struct mail *m = router_admit(b, sender, letter);
    if (!m) {
        return;
    }
    if (effect == EFFECT_STEP) {
        lockstep_keep(&b->lockstep, m, false);
    } else if (effect == EFFECT_STEP_AS_OUTSIDE ||
               (b->lockstep.on && router_meets_lockstep(b, m))) {
        lockstep_keep(&b->lockstep, m, true);
    } else {
        (void)router_route(b, m);
    }
}

static void act_take(struct broker *b, uint32_t place, const muster_Act *act, enum up_effect effect)
{
    uint32_t agent = agent_at(b, place, act->agent);
    if (agent == MU_NONE) {
        b->counters.malformed += act->mails._length; /* in the name of somebody else */
        return;
    }
    if (effect == EFFECT_STEP) {
        lockstep_keep_state(&b->lockstep, agent, act->state);
    }
    for (uint32_t i = 0; i < act->mails._length; i++) {
        mail_take(b, agent, &act->mails._buffer[i], effect);
    }
}

static void ack_take(struct broker *b, uint32_t place, const muster_Ack *ack)
{
    uint32_t agent = agent_at(b, place, ack->box);
    if (agent == MU_NONE) {
        b->counters.malformed++;
    } else if (b->places.at[place].rostered) {
        lockstep_keep_ack(&b->lockstep, agent, ack->number);
    } else {
        router_acknowledge(b, agent, ack->number);
    }
}

void broker_up(struct broker *b, const muster_Up *up, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    bool good = border_up(up);
    uint32_t place =
        border_string(up->process, MU_PROCESS_MAX) ? places_find(&b->places, up->process) : MU_NONE;
    if (!good || place == MU_NONE) {
        b->counters.malformed++;
        if (place != MU_NONE && lockstep_wants(b, place, up->step)) {
            lockstep_answered(b, place); /* the others need not wait for a better answer */
        }
        return;
    }
    enum up_effect effect = EFFECT_NOW;
    if (b->places.at[place].rostered) {
        if (up->step != muster_STEP_NOW && !lockstep_wants(b, place, up->step)) {
            return;
        }
        effect = up->step == muster_STEP_NOW ? EFFECT_STEP_AS_OUTSIDE : EFFECT_STEP;
    }
    for (uint32_t i = 0; i < up->acks._length; i++) {
        ack_take(b, place, &up->acks._buffer[i]);
    }
    for (uint32_t i = 0; i < up->acts._length; i++) {
        act_take(b, place, &up->acts._buffer[i], effect);
    }
    if (effect == EFFECT_STEP) {
        lockstep_answered(b, place);
    }
}

/* --- time ------------------------------------------------------------------------------------- */

static uint64_t resend_deadline_ns(const struct broker *b)
{
    uint32_t agent = b->mailbox.watch_head;
    if (agent == MU_NONE) {
        return UINT64_MAX;
    }
    uint64_t since_ns = b->mailbox.boxes[agent].progress_ns;
    uint64_t until_ns = since_ns + b->resend_after_ns;
    return until_ns < since_ns ? UINT64_MAX : until_ns;
}

static void resend_tick(struct broker *b)
{
    while (resend_deadline_ns(b) <= b->clock.now_ns) {
        uint32_t agent = b->mailbox.watch_head;
        mailbox_repeat(&b->mailbox, agent);
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
        if (b->registry.agents[agent].process != MU_NONE) {
            places_wake(&b->places, b->registry.agents[agent].process);
        }
    }
}

void broker_tick(struct broker *b, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    presence_tick(b);
    resend_tick(b);
    courier_tick(b);
    journal_tick(b);
    if (!b->clock.lockstep) {
        router_expire(b, runclock_mail_ns(&b->clock));
        router_admit_due(b, runclock_run_ns(&b->clock));
    }
}

uint64_t broker_deadline_ns(const struct broker *b)
{
    uint64_t first_ns = presence_deadline_ns(b);
    uint64_t others[] = {resend_deadline_ns(b), courier_deadline_ns(b), UINT64_MAX, UINT64_MAX,
                         journal_deadline_ns(b)};
    const struct mail *due = schedule_first(&b->due);
    const struct mail *expiry = schedule_first(&b->expiry);
    if (due && b->clock.runs && !b->clock.lockstep) {
        others[2] = runclock_now_of_run_ns(&b->clock, due->at_ns[SCHEDULE_DUE]);
    }
    if (expiry && !b->clock.lockstep) {
        others[3] = runclock_now_of_mail_ns(&b->clock, expiry->at_ns[SCHEDULE_EXPIRY]);
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        first_ns = others[i] < first_ns ? others[i] : first_ns;
    }
    return first_ns;
}

/* --- deliveries, and what there is to see ----------------------------------------------------- */

bool broker_next(struct broker *b, const char **process, muster_Delivery *d)
{
    MU_ASSERT(b->courier.open == MU_NONE);
    return courier_next(b, process, d);
}

void broker_delivered(struct broker *b, uint64_t now_ns)
{
    runclock_set_now(&b->clock, now_ns);
    courier_delivered(b);
}

void broker_undelivered(struct broker *b)
{
    courier_undelivered(b);
}

const char *broker_process(const struct broker *b, uint32_t index)
{
    for (uint32_t i = 0; i < b->places.used_count && index < b->places.unmatched; i++) {
        const struct place *at = &b->places.at[b->places.used[i]];
        if (!at->matched && index-- == 0) {
            return at->name;
        }
    }
    return NULL;
}

bool broker_serves(const struct broker *b, const char *process)
{
    return places_find(&b->places, process) != MU_NONE;
}

void broker_status(const struct broker *b, muster_BrokerStatus *status)
{
    const struct broker_counters *c = &b->counters;
    *status = (muster_BrokerStatus){.agents = b->registry.present,
                                    .sent = c->sent,
                                    .delivered = c->delivered,
                                    .waiting = c->waiting,
                                    .expired = c->expired,
                                    .box_full = c->box_full,
                                    .unknown_name = c->unknown_name,
                                    .refused = c->refused,
                                    .duplicates_dropped = c->duplicates_dropped,
                                    .resent = c->resent,
                                    .malformed = c->malformed,
                                    .no_store = c->no_store};
    status->broker = (char *)(uintptr_t)b->name; /* idlc has no const; nobody writes there */
}

bool broker_member(const struct broker *b, uint32_t index, muster_Member *out)
{
    if (index >= b->registry.count) {
        return false;
    }
    registry_line(&b->registry, b->registry.order[index], b->name, out);
    return true;
}

bool broker_member_news(struct broker *b, muster_Member *out)
{
    uint32_t agent = registry_next_news(&b->registry);
    if (agent == MU_NONE) {
        return false;
    }
    registry_line(&b->registry, agent, b->name, out);
    return true;
}

uint32_t broker_samples_wanted(const struct broker *b)
{
    return lockstep_missing(&b->lockstep);
}
