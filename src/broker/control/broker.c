/* SPDX-License-Identifier: Apache-2.0 */

#include "broker/control/broker.h"
#include "broker/control/parts.h"
#include "broker/control/step.h"
#include "broker/membership/membership.h"
#include "core/text.h"
#include "muster/memory.h"

#include <stdio.h>

static const uint64_t RESEND_AFTER_NS = 1000000000;
static const uint64_t HOLD_NS = 1500000000;

/* The broker's own lines of the white pages: itself, and its parts, which members of a run
 * are not shown. */
static void broker_enlist(struct broker *b, const struct broker_options *options)
{
    struct presence is = {
        .kind = muster_KIND_SPECIAL, .state = muster_STATE_RUNNING, .pid = options->pid};
    for (uint32_t own = 0; own < REGISTRY_OWN; own++) {
        char name[MU_NAME_MAX + 1];
        struct mu_text text;
        mu_text_init(&text, name, sizeof name);
        mu_text_format(&text, own ? "broker.%s" : "broker", metrics_part_name(own));
        uint32_t index = registry_add(&b->registry, name);
        MU_ASSERT(index == own);
        registry_seat(&b->registry, own, MU_NONE, "", &is, options->wall_ns);
        b->registry.agents[own].scope = scope_of_line(own != REGISTRY_BROKER);
        is.no_broadcasts = true;
    }
}

struct broker *broker_open(const struct broker_options *options)
{
    struct broker *b = mu_startup_alloc(sizeof *b);
    (void)mu_text_copy(b->name, sizeof b->name, options->name);
    (void)snprintf(b->place, sizeof b->place, "broker.%s", b->name);
    b->incarnation = options->incarnation;
    b->clock.wall_ns = options->wall_ns;
    b->resend_after_ns = options->resend_after_ns ? options->resend_after_ns : RESEND_AFTER_NS;
    b->hold_ns = options->hold_ns ? options->hold_ns : HOLD_NS;
    registry_init(&b->registry);
    processes_init(&b->processes);
    claims_init(&b->claims);
    pool_init(&b->pool);
    timers_init(&b->due, TIMERS_DUE);
    timers_init(&b->expiry, TIMERS_EXPIRY);
    timers_init(&b->replays, TIMERS_DUE);
    mailbox_init(&b->mailbox, REGISTRY_MAX);
    mailbox_set_defaults(&b->mailbox, options->box_policy, options->box_mails, options->box_bytes);
    quota_init(&b->quotas, REGISTRY_MAX);
    alerts_init(&b->alerts, REGISTRY_MAX);
    limiter_init(&b->limiter, REGISTRY_MAX);
    receipts_init(&b->receipts, REGISTRY_MAX);
    steps_init(&b->steps, REGISTRY_MAX);
    dispatch_init(&b->dispatch);
    snapshots_init(&b->snapshots);
    probes_init(&b->probes);
    view_init(&b->pages);
    resolve_init(&b->resolve, REGISTRY_MAX);
    trust_init(&b->trust);
    guard_attach(b);
    audit_init(&b->audit, options->audit);
    dispatch_set_interval(b, options->delivery_interval_ns);
    remote_init(&b->federation);
    retire_init(&b->retirement, options->name_expiry_ns);
    journal_init(&b->journal, options->has_store);
    b->mailbox.base = options->number_base;
    broker_enlist(b, options);
    return b;
}

/* Every call that changes something begins here. */
static void broker_enter(struct broker *b, uint64_t now_ns)
{
    MU_ASSERT(b->dispatch.open == MU_NONE); /* the last Delivery's fate is not known yet */
    clock_set_now(&b->clock, now_ns);
}

void broker_registration(struct broker *b, const muster_Registration *r, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    retire_tick(b);
    if (!validate_registration(r)) {
        b->counters.malformed++;
    } else if (r->is_broker || remote_is_broker(r->process)) {
        federation_hear(b, r);
    } else {
        registration_take(b, r);
    }
}

void broker_gone(struct broker *b, const char *process, uint32_t part, bool crashed,
                 uint64_t now_ns)
{
    broker_enter(b, now_ns);
    uint32_t place =
        validate_string(process, MU_PROCESS_MAX) ? processes_find(&b->processes, process) : MU_NONE;
    if (place != MU_NONE && b->processes.at[place].kind == PROCESS_BROKER) {
        federation_lose(b, place);
    } else if (place != MU_NONE) {
        registration_gone(b, place, part, crashed);
    }
}

/* The reader is there, perhaps another one than before: it is told everything again. */
static void place_matched(struct broker *b, uint32_t place)
{
    struct process *at = &b->processes.at[place];
    at->version_had = 0;
    steps_role_on(b, place, ROLE_IS_OWED);
    lifecycle_tell_again(b, place);
}

void broker_matched(struct broker *b, const char *process, bool matched, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    if (!validate_string(process, MU_PROCESS_MAX) || !validate_process_name(process)) {
        return;
    }
    uint32_t place =
        matched ? processes_get(&b->processes, process) : processes_find(&b->processes, process);
    if (place == MU_NONE) {
        return;
    }
    processes_set_matched(&b->processes, place, matched);
    if (matched) {
        place_matched(b, place);
        return;
    }
    struct process *at = &b->processes.at[place];
    for (uint32_t agent = residents_first(&b->processes, place); agent != RESIDENTS_NONE;
         agent = residents_next(&b->registry, &b->processes, agent)) {
        mailbox_unwatch(&b->mailbox, agent);
    }
    at->refusals_count = at->agents_count ? at->refusals_count : 0;
    processes_tidy(&b->processes, place);
}

void broker_read_anew(struct broker *b, const char *process)
{
    uint32_t place = processes_find(&b->processes, process);
    if (place != MU_NONE && b->processes.at[place].kind == PROCESS_BROKER &&
        processes_is_matched(&b->processes.at[place])) {
        lifecycle_tell_again(b, place);
    }
}

void broker_hears(struct broker *b, const char *process)
{
    uint32_t place = processes_find(&b->processes, process);
    if (place != MU_NONE && processes_is_matched(&b->processes.at[place])) {
        processes_session_on(&b->processes, place, SESSION_READS_MULTICASTS);
    }
}

void broker_is_read(struct broker *b, uint32_t readers)
{
    multicast_read_by(b, readers);
}

/* --- what processes send ---------------------------------------------------------------------- */

/* @return the agent of that name, if it lives there, or MU_NONE */
static uint32_t agent_at(const struct broker *b, uint32_t place, const char *name)
{
    uint32_t agent = registry_find(&b->registry, name);
    bool there = agent != MU_NONE && b->registry.agents[agent].process == place;
    return there ? agent : MU_NONE;
}

static void mail_take(struct broker *b, uint32_t sender, const muster_Mail *letter,
                      enum steps_effect effect)
{
    struct mail *m = admit_mail(b, sender, letter);
    if (!m) {
        return;
    }
    if (effect == STEPS_REPLAY && deliver_is_held(b, m)) {
        step_keep_replay(b, m);
        return;
    }
    if (effect != STEPS_INSIDE && effect != STEPS_OUTSIDE) {
        route_from_outside(b, m);
    } else if (!steps_keep(b, m, effect == STEPS_OUTSIDE)) {
        settle_turn_away(b, m);
    }
}

/* What was sent when this broker was not there, or was not heard, is lost, and what follows may
 * arrive before it has been sent again: if that was taken, the lost ones would pass for had.
 * @return whether no mail is missing between those that have come, or were answered for, and this
 */
static bool mail_is_next(struct broker *b, uint32_t sender, uint64_t first_seq, uint64_t seq)
{
    struct agent *a = &b->registry.agents[sender];
    if (first_seq > 0 && seq > first_seq && seq - 1 > a->came_seq) {
        b->counters.gaps++;
        return false;
    }
    a->came_seq = seq > a->came_seq ? seq : a->came_seq;
    return true;
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
        snapshots_heard(b, agent, place);
    } else if (act->replays) {
        effect = STEPS_REPLAY;
    }
    if (effect == STEPS_INSIDE && !scope_is_inside(registry_scope(&b->registry, agent))) {
        effect = STEPS_NOW; /* it speaks in its turn, but from outside */
    }
    if (act->mails._length > 0) {
        pacing_note_speaker(b, place);
    }
    for (uint32_t i = 0; i < act->mails._length; i++) {
        const muster_Mail *letter = &act->mails._buffer[i];
        if (mail_is_next(b, agent, act->first_seq, letter->seq)) {
            mail_take(b, agent, letter, effect);
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
    snapshots_heard(b, agent, place);
    if (scope_is_inside(b->processes.at[place].scope)) {
        steps_keep_ack(&b->steps, agent, ack->number);
    } else {
        settle_acknowledge(b, agent, ack->number);
    }
}

/* Each life without a store counts its boxes from 1.  What was said to an earlier one would end
 * mail that was not received yet; of what has come from this one, its receiver will say so. */
static void acks_take(struct broker *b, uint32_t place, const muster_Up *up)
{
    if (up->broker_incarnation != b->incarnation) {
        b->counters.astray += up->acks._length;
        return;
    }
    for (uint32_t i = 0; i < up->acks._length; i++) {
        ack_take(b, place, &up->acks._buffer[i]);
    }
}

void broker_up(struct broker *b, const muster_Up *up, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    bool good = validate_up(up);
    uint32_t place = validate_string(up->process, MU_PROCESS_MAX)
                         ? processes_find(&b->processes, up->process)
                         : MU_NONE;
    enum steps_effect effect = place != MU_NONE ? steps_effect(b, place, up->step) : STEPS_IGNORED;
    if (!good || place == MU_NONE) {
        b->counters.malformed++;
        if (effect == STEPS_INSIDE) {
            step_answered(b, place); /* the others need not wait for a better answer */
        }
        return;
    }
    if (effect == STEPS_IGNORED) {
        return;
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

/* --- other brokers -----------------------------------------------------------------------------
 */

void broker_peers(struct broker *b, uint32_t count, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    announce_to(b, count);
}

void broker_delivery(struct broker *b, const muster_Delivery *d, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    retire_tick(b);
    relay_take(b, d);
}

bool broker_announcement(struct broker *b, muster_Registration *out)
{
    return announce_next(b, out);
}

void broker_announced(struct broker *b)
{
    announce_done(b);
}

bool broker_up_next(struct broker *b, const char **peer, muster_Up *out)
{
    return relay_up_next(b, peer, out);
}

void broker_up_sent(struct broker *b)
{
    relay_up_sent(b);
}

/* --- time ------------------------------------------------------------------------------------- */

static uint64_t resend_deadline_ns(const struct broker *b)
{
    uint32_t agent = mailbox_watched(&b->mailbox);
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
        uint32_t agent = mailbox_watched(&b->mailbox);
        mailbox_repeat(&b->mailbox, agent);
        names_tell_number(b, agent); /* what said so may be what was lost */
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
        residents_wake(&b->registry, &b->processes, agent);
    }
}

void broker_tick(struct broker *b, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    lifecycle_tick(b);
    resend_tick(b);
    outcome_tick(b);
    dispatch_tick(b);
    transfer_tick(b);
    settle_tick(b);
    lifecycle_tick_routes(b);
    announce_tick(b);
    retire_tick(b);
    if (!clock_by_steps(&b->clock)) {
        settle_expire(b, clock_mail_ns(&b->clock));
        notify_expire(b, clock_mail_ns(&b->clock));
        route_resolve_expire(b, clock_mail_ns(&b->clock));
        settle_admit_due(b, clock_run_ns(&b->clock));
    }
}

static uint64_t earliest_ns(const uint64_t *times_ns, size_t count)
{
    uint64_t first_ns = UINT64_MAX;
    for (size_t i = 0; i < count; i++) {
        first_ns = times_ns[i] < first_ns ? times_ns[i] : first_ns;
    }
    return first_ns;
}

/* What ends on the mail clock.  @return in broker time */
static uint64_t mail_deadline_ns(const struct broker *b)
{
    const struct mail *expiry = timers_first(&b->expiry);
    const uint64_t times_ns[] = {expiry ? expiry->at_ns[TIMERS_EXPIRY] : UINT64_MAX,
                                 view_deadline_mail_ns(b), resolve_deadline_mail_ns(b)};
    uint64_t first_ns = earliest_ns(times_ns, sizeof times_ns / sizeof times_ns[0]);
    return first_ns != UINT64_MAX ? clock_now_of_mail_ns(&b->clock, first_ns) : UINT64_MAX;
}

/* @return when held mail is due, in broker time */
static uint64_t due_deadline_ns(const struct broker *b)
{
    const struct mail *due = timers_first(&b->due);
    return due && b->clock.runs ? clock_now_of_run_ns(&b->clock, due->at_ns[TIMERS_DUE])
                                : UINT64_MAX;
}

uint64_t broker_deadline_ns(const struct broker *b)
{
    bool by_steps = clock_by_steps(&b->clock); /* then the end of a step does it */
    const uint64_t times_ns[] = {lifecycle_deadline_ns(b),
                                 resend_deadline_ns(b),
                                 dispatch_deadline_ns(b),
                                 snapshots_deadline_ns(b),
                                 limiter_deadline_ns(&b->limiter),
                                 settle_deadline_ns(b),
                                 remote_deadline_ns(b),
                                 announce_deadline_ns(b),
                                 retire_deadline_ns(b),
                                 by_steps ? UINT64_MAX : mail_deadline_ns(b),
                                 by_steps ? UINT64_MAX : due_deadline_ns(b)};
    return earliest_ns(times_ns, sizeof times_ns / sizeof times_ns[0]);
}

/* --- deliveries, and what there is to see ----------------------------------------------------- */

bool broker_next(struct broker *b, const char **process, muster_Delivery *d)
{
    MU_ASSERT(b->dispatch.open == MU_NONE);
    return dispatch_next(b, process, d);
}

void broker_delivered(struct broker *b, uint64_t now_ns)
{
    clock_set_now(&b->clock, now_ns);
    dispatch_delivered(b);
}

void broker_undelivered(struct broker *b)
{
    dispatch_undelivered(b);
}

const char *broker_process(const struct broker *b, uint32_t index)
{
    const struct processes *p = &b->processes;
    return index < p->unmatched_count ? p->at[p->unmatched[index]].name : NULL;
}

bool broker_serves(const struct broker *b, const char *process)
{
    return processes_find(&b->processes, process) != MU_NONE;
}

bool broker_takes_names(const struct broker *b)
{
    return registry_has_room(&b->registry);
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
                                    .dropped = c->dropped,
                                    .over_share = c->over_share,
                                    .no_store = c->no_store,
                                    .stored = b->pool.mails,
                                    .oldest_ns =
                                        arrivals_oldest_ns(&b->arrivals, clock_mail_ns(&b->clock))};
    steps_last_end(&b->steps, status);
    status->broker = sample_text(b->name);
}

bool broker_part(struct broker *b, uint32_t part, muster_PartStatus *status)
{
    const struct metric *c;
    uint32_t count = 0;
    if (part < 1 || part >= PARTS_END) {
        return false;
    }
    for (size_t i = 0; (c = metrics_at(i)); i++) {
        if (c->part == part) {
            b->part_counters[count++] =
                (muster_Counter){.name = sample_text(c->name), .value = metrics_value(b, c)};
        }
    }
    *status = (muster_PartStatus){.broker = b->name, .part = b->registry.agents[part].name};
    status->counters._buffer = b->part_counters;
    status->counters._length = status->counters._maximum = count;
    return true;
}

mu_result broker_policy(struct broker *b, const char *text, const char *file,
                        struct mu_fault *fault)
{
    return trust_read(&b->trust, text, file, fault);
}

bool broker_audit_next(struct broker *b, struct audit_record *out)
{
    return audit_next(&b->audit, out);
}

void broker_audit_failed(struct broker *b)
{
    b->audit.failed++;
}

bool broker_member(const struct broker *b, uint32_t index, muster_Member *out)
{
    if (index >= b->registry.live) {
        return false;
    }
    registry_line(&b->registry, b->registry.order[index], b->name, out);
    return true;
}

static void line_write(const struct broker *b, uint32_t agent, char to[BROKER_LINE_MAX])
{
    muster_Member m;
    struct mu_text t;
    registry_line(&b->registry, agent, b->name, &m);
    mu_text_init(&t, to, BROKER_LINE_MAX);
    mu_text_format(&t, "%s %s %s %s %s %s %lu %llu%s%s", m.name, validate_kind_word(m.kind),
                   validate_state_word(m.state), m.broker, m.process[0] ? m.process : "-",
                   m.host[0] ? m.host : "-", (unsigned long)m.pid,
                   (unsigned long long)m.since_wall_ns, m.reason[0] ? " " : "", m.reason);
}

bool broker_page_news(struct broker *b, muster_Page *out)
{
    uint32_t part = registry_next_page(&b->registry);
    if (part == MU_NONE) {
        return false;
    }
    uint32_t first = part * REGISTRY_PAGE;
    uint32_t count = b->registry.count - first;
    count = count < REGISTRY_PAGE ? count : REGISTRY_PAGE;
    uint32_t lines = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (b->registry.agents[first + i].name[0] != '\0') {
            line_write(b, first + i, b->page_text[lines]);
            b->page[lines] = b->page_text[lines];
            lines++;
        }
    }
    *out = (muster_Page){.broker = b->name, .part = part};
    out->lines._buffer = b->page;
    out->lines._length = out->lines._maximum = lines;
    return true;
}

void broker_page_untold(struct broker *b, const muster_Page *page)
{
    registry_mark_page(&b->registry, page->part);
}

bool broker_event_next(struct broker *b, muster_BrokerEvent *out)
{
    struct alert event;
    if (!alerts_next(&b->alerts, b->clock.now_ns, &event)) {
        return false;
    }
    *out = (muster_BrokerEvent){.agent = b->registry.agents[event.agent].name,
                                .sender = b->registry.agents[event.sender].name,
                                .count = event.count,
                                .wall_ns = b->clock.wall_ns + event.at_ns};
    out->broker = sample_text(b->name);
    out->kind = sample_text(alerts_kind_word(event.kind));
    return true;
}

uint32_t broker_samples_wanted(const struct broker *b)
{
    return b->probes.count > 0 ? 1 : steps_missing(&b->steps);
}

bool broker_by_steps(const struct broker *b)
{
    return clock_by_steps(&b->clock);
}
