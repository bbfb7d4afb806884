/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* --- the interval ----------------------------------------------------------------------------- */

/* @return whether there is a directive to hand out, or anything to go out once more */
static bool box_is_urgent(struct broker *b, uint32_t agent)
{
    if (!b->mailbox.boxes[agent].begun) {
        return false;
    }
    const struct box *box = mailbox_box(&b->mailbox, agent);
    uint32_t first = mu_list_first(&box->lists[POST_URGENT].posts);
    if (box->out != MU_NONE || first == MU_NONE) {
        return box->out != MU_NONE;
    }
    bool may_go = !mail_is_written(b->mailbox.posts[first].mail) ||
                  journal_room(&b->journal, &b->mailbox, agent) > 0;
    return may_go && box->lists[POST_FLIGHT].posts.count < MU_WINDOW_MAX + MAILBOX_RESERVE &&
           names_gate(&b->registry, &b->processes, agent) != GATE_SHUT;
}

/* What cannot wait: an answer to a registration, a directive, what goes out once more. */
static bool process_is_urgent(struct broker *b, uint32_t place)
{
    const struct process *at = &b->processes.at[place];
    if (at->refusals_count > 0 || at->roll_call_due) {
        return true;
    }
    for (uint32_t agent; (agent = processes_stirred_agent(&b->processes, place)) != MU_NONE;) {
        if (b->registry.agents[agent].bearer == BEARER_OWED || box_is_urgent(b, agent)) {
            return true; /* it stays stirred until it is served */
        }
        processes_calm_agent(b, agent);
    }
    return false;
}

/* @return whether the process is held until the dispatcher wakes, or gets no more of a flood for
 * now */
static bool process_waits(struct broker *b, uint32_t place)
{
    const struct process *at = &b->processes.at[place];
    bool sleeps = !scope_is_paced(at->scope) && !dispatch_is_awake(&b->dispatch);
    bool pauses = pacing_is_due(at) && b->clock.now_ns < at->flooded_until_ns;
    if ((!sleeps && !pauses) || process_is_urgent(b, place)) {
        return false;
    }
    if (sleeps) {
        processes_turn_on(&b->processes, place, TURN_IS_HELD);
    }
    return sleeps || pacing_hold(b, place);
}

/* All whose turn stands so are looked at again. */
static void turns_wake(struct broker *b, enum turn_state turn, enum turn_event event)
{
    for (uint32_t i = 0; i < b->processes.top; i++) {
        if (b->processes.at[i].turn == turn) {
            processes_turn_on(&b->processes, i, event);
            processes_wake(&b->processes, i);
        }
    }
}

static void dispatch_wake(struct broker *b)
{
    struct dispatch *c = &b->dispatch;
    if (c->awake || b->clock.now_ns < c->wake_ns) {
        return;
    }
    c->awake = true;
    if (b->processes.held > 0) {
        turns_wake(b, TURN_HELD, TURN_ROUND_BEGINS);
    }
}

/* All that may be served have been. */
static void dispatch_sleep(struct broker *b)
{
    struct dispatch *c = &b->dispatch;
    if (c->awake && c->worked) {
        c->count.wakings += c->interval_ns > 0;
        c->slept_ns = clock_mail_ns(&b->clock);
        c->wake_ns = clock_after_ns(b->clock.now_ns, c->interval_ns);
    }
    c->awake = c->worked = false;
}

void dispatch_set_interval(struct broker *b, uint64_t interval_ns)
{
    b->dispatch.interval_ns = interval_ns;
    b->dispatch.wake_ns = b->clock.now_ns;
}

/* --- putting together ------------------------------------------------------------------------- */

/* Agents that had no room are first in the queue of the next Delivery; so are all if the network
 * has not taken this one. */
static void parts_return(struct broker *b, bool taken)
{
    struct dispatch *c = &b->dispatch;
    for (uint32_t i = 0; i < c->parts_count; i++) {
        if (!taken || c->parts[i].passed_by) {
            processes_wake_agent(b, c->parts[i].agent);
        }
    }
    c->parts_count = 0;
}

bool broker_next(struct broker *b, const char **process, muster_Delivery *d)
{
    uint32_t place;
    MU_ASSERT(b->dispatch.open == MU_NONE);
    dispatch_wake(b);
    if (b->multicast.count > 0 && multicast_next(b, d)) {
        b->dispatch.open = PROCESSES_ALL;
        b->dispatch.view = (struct steps_view){0};
        b->dispatch.open_delay_ns = 0;
        *process = BUS_TO_ALL;
        return true;
    }
    while ((place = processes_next(&b->processes)) != MU_NONE) {
        const struct process *at = &b->processes.at[place];
        if (!processes_is_matched(at) || at->turn == TURN_REFUSED) {
            continue;
        }
        b->dispatch.open = place;
        *process = at->name;
        if (b->snapshots.words_count + b->probes.words_count > 0 &&
            compose_fill_word(b, place, d)) {
            return true;
        }
        if (!process_waits(b, place)) {
            if (compose_fill(b, place, d)) {
                return true;
            }
            if (b->dispatch.parts_count == DISPATCH_AGENTS) {
                processes_wake(&b->processes, place); /* more of them have not been looked at */
            }
            parts_return(b, true); /* behind urgent ones, or until the dispatcher wakes */
        }
        b->dispatch.open = MU_NONE;
    }
    dispatch_sleep(b);
    return false;
}

/* --- the network's answer --------------------------------------------------------------------- */

/* @return the process that the last mail of a part came from, or MU_NONE */
static uint32_t part_from(struct broker *b, const struct dispatch_part *part)
{
    const struct box *box = mailbox_box(&b->mailbox, part->agent);
    uint32_t post = mu_list_last(&box->lists[POST_FLIGHT].posts);
    return post != MU_NONE ? b->registry.agents[b->mailbox.posts[post].mail->sender].process
                           : MU_NONE;
}

static void part_delivered(struct broker *b, const struct dispatch_part *part)
{
    /* In a run, the next life of its process hears them again if this one dies before it answers.
     */
    if (scope_is_inside(b->dispatch.view.scope)) {
        b->receipts.told[part->agent] = part->receipts;
    } else if (part->receipts > 0) {
        receipts_drop(&b->receipts, part->agent, part->receipts);
        limiter_told(&b->good_news, part->agent, b->clock.now_ns);
    }
    if (part->verdict) {
        names_bearer_on(&b->registry, part->agent, BEARER_TELLS);
    }
    if (!b->mailbox.boxes[part->agent].begun) {
        return;
    }
    bool paced = scope_is_paced(b->dispatch.view.scope);
    b->counters.resent += mailbox_mark_written(&b->mailbox, part->agent, part->items,
                                               paced ? MAILBOX_UNWATCHED : b->clock.now_ns);
}

static void delivery_count(struct dispatch *c, uint32_t items)
{
    c->worked = c->worked || !scope_is_paced(c->view.scope);
    c->count.deliveries++;
    c->count.items += items;
    c->count.delay_ns += c->open_delay_ns;
    if (items > c->count.most_items) {
        c->count.most_items = items;
    }
}

/* A Delivery with a word about an agent on its way, or of a probe, is out. */
static void word_end(struct broker *b)
{
    struct dispatch *c = &b->dispatch;
    if (c->open_word == WORD_TRIP) {
        b->processes.at[c->open].serial++;
        snapshots_sent(b);
    } else {
        probes_sent(b);
    }
    processes_wake(&b->processes, c->open);
    c->open_word = WORD_NONE;
}

/* One Delivery may not have held all. */
static void process_go_on(struct broker *b, const struct process *at, uint32_t place)
{
    if (processes_agent_waits(&b->processes, place) || !view_has_told(&b->pages, at) ||
        changelog_after(&b->registry.changes, at->version_had) != MU_NONE) {
        processes_wake(&b->processes, place);
    }
}

static void parts_delivered(struct broker *b, struct process *at)
{
    struct dispatch *c = &b->dispatch;
    uint32_t items = 0, from = MU_NONE;
    for (uint32_t i = 0; i < c->parts_count; i++) {
        items += c->parts[i].items;
        part_delivered(b, &c->parts[i]);
        from = c->parts[i].items > 0 ? part_from(b, &c->parts[i]) : from;
    }
    parts_return(b, true);
    delivery_count(c, items);
    pacing_note_delivery(at, items, from, b->clock.now_ns);
    at->serial++;
    at->refusals_count = 0;
    at->roll_call_due = false;
    view_delivered(&b->pages, at);
    if (c->open_version > at->version_had) {
        at->version_had = c->open_version;
    }
    if (scope_is_paced(c->view.scope)) {
        steps_delivered(b, c->open);
    } else {
        process_go_on(b, at, c->open);
    }
}

void broker_delivered(struct broker *b, uint64_t now_ns)
{
    struct dispatch *c = &b->dispatch;
    clock_set_now(&b->clock, now_ns);
    MU_ASSERT(c->open != MU_NONE);
    if (c->open_word != WORD_NONE) {
        word_end(b);
    } else if (c->open == PROCESSES_ALL) {
        delivery_count(c, multicast_sent(b));
        c->count.multicasts++;
    } else {
        parts_delivered(b, &b->processes.at[c->open]);
    }
    c->open = MU_NONE;
}

static void process_undelivered(struct broker *b)
{
    struct dispatch *c = &b->dispatch;
    for (uint32_t i = 0; i < c->parts_count; i++) {
        mailbox_take_back(&b->mailbox, c->parts[i].agent);
    }
    parts_return(b, false);
    c->open_word = WORD_NONE;
    if (b->processes.refused == 0) {
        c->retry_ns = clock_after_ns(b->clock.now_ns, DISPATCH_RETRY_NS);
    }
    processes_turn_on(&b->processes, c->open, TURN_IS_REFUSED);
}

void broker_undelivered(struct broker *b)
{
    struct dispatch *c = &b->dispatch;
    MU_ASSERT(c->open != MU_NONE);
    c->count.blocked++;
    (c->open == PROCESSES_ALL ? multicast_unsent : process_undelivered)(b);
    c->open = MU_NONE;
}

void dispatch_tick(struct broker *b)
{
    pacing_tick(b);
    if (b->processes.refused > 0 && b->dispatch.retry_ns <= b->clock.now_ns) {
        turns_wake(b, TURN_REFUSED, TURN_IS_RETRIED);
    }
}

uint64_t dispatch_deadline_ns(const struct broker *b)
{
    uint64_t wake_ns = b->processes.held > 0 ? b->dispatch.wake_ns : UINT64_MAX;
    uint64_t retry_ns = b->processes.refused > 0 ? b->dispatch.retry_ns : UINT64_MAX;
    uint64_t flood_ns = pacing_deadline_ns(b);
    retry_ns = flood_ns < retry_ns ? flood_ns : retry_ns;
    return wake_ns < retry_ns ? wake_ns : retry_ns;
}
