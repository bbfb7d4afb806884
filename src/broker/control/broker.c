/* SPDX-License-Identifier: Apache-2.0 */

#include "broker/control/step.h"
#include "broker/membership/membership.h"
#include "core/name.h"
#include "muster/memory.h"

#include <stdio.h>

static const uint64_t NAME_EXPIRY_NS = 600000000000;

/* The broker's own lines of the white pages: itself, and its parts, which members of a run
 * are not shown. */
static void broker_enlist(struct broker *b, const struct broker_options *options)
{
    struct presence is = {
        .kind = muster_KIND_SPECIAL, .state = muster_STATE_RUNNING, .pid = options->pid};
    for (uint32_t own = 0; own < REGISTRY_OWN; own++) {
        char name[MU_NAME_MAX + 1];
        struct mu_text text = mu_text_in(name, sizeof name);
        mu_text_format(&text, own ? "broker.%s" : "broker", metrics_part_name(own));
        uint32_t index = registry_add(&b->registry, name);
        MU_ASSERT(index == own);
        registry_seat(&b->registry, own, MU_NONE, "", &is, options->wall_ns);
        b->registry.agents[own].scope = scope_of_line(own != REGISTRY_BROKER);
        is.no_broadcasts = true;
        registry_alias(&b->registry, own, mu_name_was(name));
    }
}

struct broker *broker_open(const struct broker_options *options)
{
    struct broker *b = mu_startup_alloc(sizeof *b);
    (void)mu_text_copy(b->name, sizeof b->name, options->name);
    (void)snprintf(b->place, sizeof b->place, "broker.%s", b->name);
    b->incarnation = options->incarnation;
    b->clock.wall_ns = options->wall_ns;
    registry_init(&b->registry, options->names ? options->names : MU_AGENTS_MAX);
    mu_table_init(&b->processes.names, MU_PROCESSES_MAX);
    mu_pool_init(&b->claims.pool, CLAIMS_MAX);
    pool_init(&b->pool);
    b->expiry.kind = TIMERS_EXPIRY;
    b->arrivals.kind = MAIL_BOXED;
    mailbox_init(&b->mailbox);
    b->mailbox.limits = options->boxes;
    mu_pool_init(&b->receipts.pool, MU_MAILS_MAX);
    b->steps.simulator = MU_NONE;
    b->dispatch.open = MU_NONE;
    b->snapshots.texts = mu_startup_array(MU_CAPSULES_MAX, MU_CAPSULE_MAX);
    lines_init(&b->pages.groups, LINES_GROUPS);
    lines_init(&b->pages.services, LINES_SERVICES);
    b->pages.services.told_to = &b->pages.subscriptions;
    mu_pool_init(&b->resolve.pool, RESOLVE_WAITS);
    b->resolve.soonest_ns = UINT64_MAX;
    trust_init(&b->trust);
    authorize_attach(b);
    b->audit.on = options->audit;
    dispatch_set_interval(b, options->delivery_interval_ns);
    b->bad_news.pause_ns = LIMITER_BAD_PAUSE_NS;
    b->good_news.pause_ns = options->receipt_pause_ns;
    b->federation.peers = mu_startup_array(MU_BROKERS_MAX, sizeof *b->federation.peers);
    b->retirement.expiry_ns = options->name_expiry_ns ? options->name_expiry_ns : NAME_EXPIRY_NS;
    b->journal.on = options->has_store;
    b->journal.awaits_ns = UINT64_MAX;
    b->mailbox.base = options->number_base;
    broker_enlist(b, options);
    return b;
}

void broker_registration(struct broker *b, const muster_Registration *r, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    retire_tick(b);
    if (!validate_process_name(r->process)) {
        b->counters.malformed++;
    } else if (r->is_broker || remote_name(r->process)) {
        federation_hear(b, r);
    } else {
        registration_take(b, r);
    }
}

void broker_gone(struct broker *b, const char *process, uint32_t part, bool crashed,
                 uint64_t now_ns)
{
    broker_enter(b, now_ns);
    uint32_t place = processes_find(&b->processes, process);
    if (place != MU_NONE && b->processes.at[place].kind == PROCESS_BROKER) {
        federation_lose(b, place);
    } else if (place != MU_NONE) {
        registration_gone(b, place, part, crashed);
    }
}

void broker_matched(struct broker *b, const char *process, bool matched, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    uint32_t place =
        matched ? processes_get(&b->processes, process) : processes_find(&b->processes, process);
    if (place == MU_NONE) {
        return;
    }
    struct process *at = &b->processes.at[place];
    processes_session_on(&b->processes, place, matched ? SESSION_MATCHED : SESSION_UNMATCHED);
    processes_turn_on(&b->processes, place, TURN_IS_RETRIED);
    if (matched) { /* perhaps by another reader than before: it is told everything again */
        at->version_had = 0;
        steps_role_on(b, place, ROLE_IS_OWED);
        lifecycle_tell_again(b, place);
        return;
    }
    PROCESSES_EACH_AGENT (b, agent, place) {
        mailbox_unwatch(&b->mailbox, agent);
    }
    at->refusals_count = at->agents_count ? at->refusals_count : 0;
    processes_tidy(&b->processes, place);
}

void broker_hears(struct broker *b, const char *process)
{
    uint32_t place = processes_find(&b->processes, process);
    if (place != MU_NONE && processes_is_matched(&b->processes.at[place])) {
        processes_session_on(&b->processes, place, SESSION_READS_MULTICASTS);
    }
}

/* --- what processes send ---------------------------------------------------------------------- */

/* @return the agent of that name, if it lives there, or MU_NONE */
static uint32_t agent_at(const struct broker *b, uint32_t place, const char *name)
{
    uint32_t agent = registry_find(&b->registry, name);
    bool there = agent != MU_NONE && b->registry.agents[agent].process == place;
    return there ? agent : MU_NONE;
}

/* What was sent when this broker was not there, or was not heard, is lost, and what follows may
 * arrive before it has been sent again: if that was taken, the lost ones would pass for had.
 * @return whether no mail is missing between those that have come, or were answered for, and this
 */
static bool mail_is_next(struct broker *b, uint32_t sender, uint64_t first_seq, uint64_t seq)
{
    struct agent *a = &b->registry.agents[sender];
    if (first_seq > 0 && seq > first_seq && seq - 1 > a->seq.came) {
        b->gaps++;
        return false;
    }
    a->seq.came = seq > a->seq.came ? seq : a->seq.came;
    return true;
}

static void bearer_heard(struct broker *b, uint32_t agent, uint32_t place)
{
    if (b->snapshots.count > 0) {
        snapshots_heard(b, agent, place);
    }
}

static void act_take(struct broker *b, uint32_t place, const muster_Act *act,
                     enum steps_effect effect)
{
    uint32_t agent = agent_at(b, place, act->agent);
    if (agent == MU_NONE) {
        b->counters.malformed += act->mails._length; /* in the name of another agent */
        return;
    }
    if (effect == STEPS_INSIDE) {
        steps_keep_state(&b->steps, agent, act->state);
        bearer_heard(b, agent, place);
    } else if (act->replays) {
        effect = STEPS_REPLAY;
    }
    if (effect == STEPS_INSIDE && !view_inside(b, agent)) {
        effect = STEPS_NOW; /* it speaks in its turn, but from outside */
    }
    if (act->mails._length > 0) {
        pacing_note_speaker(&b->pacing, place, b->clock.now_ns);
    }
    for (uint32_t i = 0; i < act->mails._length; i++) {
        const muster_Mail *letter = &act->mails._buffer[i];
        if (mail_is_next(b, agent, act->first_seq, letter->seq)) {
            route_letter(b, agent, letter, effect);
        }
    }
}

static void ack_take(struct broker *b, uint32_t place, const muster_Ack *ack)
{
    uint32_t agent = agent_at(b, place, ack->box);
    if (agent == MU_NONE) { /* of another broker: the agent lives elsewhere by now */
        b->counters.malformed += b->processes.at[place].kind != PROCESS_BROKER;
        return;
    }
    bearer_heard(b, agent, place);
    if (scope_is_inside(b->processes.at[place].scope)) {
        steps_keep_ack(&b->steps, agent, ack->number);
    } else {
        outcome_acknowledge(b, agent, ack->number);
    }
}

/* Each life without a store counts its boxes from 1.  What was said to an earlier one would end
 * mail that was not received yet; of what has come from this one, its receiver will say so. */
static void acks_take(struct broker *b, uint32_t place, const muster_Up *up)
{
    if (up->broker_incarnation != b->incarnation) {
        b->astray += up->acks._length;
        return;
    }
    for (uint32_t i = 0; i < up->acks._length; i++) {
        ack_take(b, place, &up->acks._buffer[i]);
    }
}

/* Mails are looked at one by one. */
static bool up_makes_sense(const muster_Up *up)
{
    bool good = true;
    for (uint32_t i = 0; i < up->acts._length && good; i++) {
        good = (unsigned)up->acts._buffer[i].state <= muster_STATE_ABSENT;
    }
    for (uint32_t i = 0; i < up->trips._length && good; i++) {
        good = up->trips._buffer[i].slot < MU_LOCAL_AGENTS_MAX;
    }
    return good;
}

void broker_up(struct broker *b, const muster_Up *up, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    uint32_t place = processes_find(&b->processes, up->process);
    enum steps_effect effect =
        place != MU_NONE ? steps_effect(&b->steps, place, up->step) : STEPS_IGNORED;
    if (place == MU_NONE || !up_makes_sense(up)) {
        b->counters.malformed++;
        if (effect == STEPS_INSIDE) {
            step_answered(b, place); /* the others need not wait for a better answer */
        }
        return;
    }
    if (effect == STEPS_IGNORED) {
        return;
    }
    if (processes_is_silent(&b->processes.at[place])) { /* it was missed, and lives */
        processes_call_roll(&b->processes, place);
    }
    steps_open_turn(&b->steps);
    acks_take(b, place, up);
    for (uint32_t i = 0; i < up->acts._length && b->processes.at[place].kind != PROCESS_BROKER;
         i++) {
        act_take(b, place, &up->acts._buffer[i], effect);
    }
    for (uint32_t i = 0; i < up->trips._length; i++) {
        transfer_hear(b, place, &up->trips._buffer[i], effect == STEPS_INSIDE);
    }
    for (uint32_t i = 0; i < up->glances._length; i++) {
        probes_hear(b, place, &up->glances._buffer[i]);
    }
    if (effect == STEPS_INSIDE) {
        step_answered(b, place);
    }
}

bool broker_takes_names(const struct broker *b)
{
    return b->registry.ordinary.live < b->registry.ordinary.size;
}
