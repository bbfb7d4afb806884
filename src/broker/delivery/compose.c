/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/sort.h"

#include <string.h>

static bool is_paced(const struct broker *b)
{
    return scope_is_paced(b->dispatch.view.scope);
}

/* @return whether ordinary mail may go out */
static bool is_awake(const struct broker *b)
{
    return is_paced(b) ? b->dispatch.view.is_round : dispatch_is_awake(&b->dispatch);
}

/* @return how much longer a mail has waited than it had without an interval, at most */
static uint64_t mail_delay_ns(const struct broker *b, const struct mail *m)
{
    uint64_t now_ns = clock_mail_ns(&b->clock), since_ns = b->dispatch.slept_ns;
    if (is_paced(b)) {
        uint64_t round_ns = b->dispatch.view.round_ns;
        since_ns = now_ns > round_ns ? now_ns - round_ns : 0;
    }
    since_ns = since_ns > m->came_ns ? since_ns : m->came_ns;
    return m->letter.layer > 0 && now_ns > since_ns ? now_ns - since_ns : 0;
}

/* @return what is left of its time to live, for the next broker on its way */
static uint64_t ttl_left_ns(const struct broker *b, const struct mail *m)
{
    uint64_t mail_ns = clock_mail_ns(&b->clock), at_ns = m->at_ns[TIMERS_EXPIRY];
    if (at_ns == 0 || b->processes.at[b->dispatch.open].kind != PROCESS_BROKER) {
        return m->letter.ttl_ns;
    }
    return at_ns > mail_ns ? at_ns - mail_ns : 1;
}

/* @return whether all that may go to the agent now had room */
static bool items_fill(struct broker *b, struct dispatch_part *part, struct dispatch_room *room,
                       muster_Delivery *d)
{
    uint32_t agent = part->agent;
    if (!b->mailbox.boxes[agent].begun || scope_waits(b->registry.agents[agent].scope)) {
        return true;
    }
    struct box *box = mailbox_box(&b->mailbox, agent);
    enum mailbox_gate gate = names_gate(&b->registry, &b->processes, agent);
    bool awake = is_awake(b);
    mailbox_hand_out(&b->mailbox, agent, awake || gate < GATE_URGENT ? gate : GATE_URGENT,
                     journal_room(&b->journal, &b->mailbox, agent));
    uint64_t number = box->acked + box->written;
    uint32_t i = box->out;
    for (; i != MU_NONE && room->items > 0; i = mailbox_next(&b->mailbox, i)) {
        const struct mail *m = b->mailbox.posts[i].mail;
        if (m->bytes > room->bytes) { /* the content of the largest mail fits an empty Delivery */
            room->items = 0;
            break;
        }
        room->bytes -= m->bytes;
        room->items--;
        part->items++;
        if (b->dispatch.interval_ns > 0 && !b->mailbox.posts[i].sent) {
            b->dispatch.open_delay_ns += mail_delay_ns(b, m);
        }
        muster_Parcel *item = &d->parcels._buffer[d->parcels._length++];
        *item = (muster_Parcel){.box = b->registry.agents[agent].name,
                                .number = number + part->items,
                                .letter = m->letter};
        item->letter.again = m->letter.again || b->mailbox.posts[i].sent;
        item->letter.ttl_ns = ttl_left_ns(b, m);
    }
    return i == MU_NONE && (awake || gate < GATE_OPEN);
}

static uint32_t receipts_fill(struct broker *b, uint32_t agent, muster_Delivery *d)
{
    uint32_t before = d->receipts._length;
    MU_LIST_EACH (i, &b->receipts.queues[agent], MU_LINKS(b->receipts.at, link)) {
        const struct receipt *r = &b->receipts.at[i];
        if (d->receipts._length == DISPATCH_RECEIPTS) {
            break;
        }
        d->receipts._buffer[d->receipts._length++] =
            (muster_Receipt){.agent = b->registry.agents[agent].name,
                             .first_seq = r->first_seq,
                             .last_seq = r->last_seq,
                             .result = r->result};
    }
    return d->receipts._length - before;
}

/* @return what a verdict says of numbers: the last mail of the agent, for its process; what has
 * been had from its box, for another broker */
static uint64_t verdict_number(struct broker *b, uint32_t agent)
{
    return b->processes.at[b->dispatch.open].kind == PROCESS_BROKER
               ? mailbox_box(&b->mailbox, agent)->acked
               : remote_begin_seq(b, agent);
}

static void welcome_add(struct broker *b, struct dispatch_part *part, muster_Delivery *d)
{
    struct agent *a = &b->registry.agents[part->agent];
    part->verdict = a->bearer == BEARER_OWED;
    if (part->verdict) {
        d->verdicts._buffer[d->verdicts._length++] =
            (muster_Verdict){.agent = a->name,
                             .accepted = true,
                             .last_seq = verdict_number(b, part->agent),
                             .broker_incarnation = b->incarnation,
                             .reason = sample_text("")};
    }
}

static void refusals_fill(struct broker *b, struct process *at, muster_Delivery *d)
{
    for (uint32_t i = 0; i < at->refusals_count; i++) {
        struct refusal *r = &at->refusals[i];
        d->verdicts._buffer[d->verdicts._length++] =
            (muster_Verdict){.agent = r->name,
                             .code = r->code,
                             .reason = r->reason,
                             .broker_incarnation = b->incarnation};
    }
}

/* Inside, the pages are of members, of those that have ended, too, and of agents that were there
 * when the run began: all others come and go by the wall clock.  Onlookers, which want no
 * broadcasts, are not shown at all. */
static bool line_is_shown(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    bool from_the_start =
        changelog_version(&b->registry.changes, agent) <= b->dispatch.view.start_version &&
        !a->is.no_broadcasts && a->is.home[0] == '\0';
    return !is_paced(b) || from_the_start || a->named == NAMED_ENDS_WITH_RUN ||
           scope_is_inside(a->scope);
}

/* @return whether a step has changed a line since the last Delivery, and more was said of it since
 */
static bool line_is_of_step(const struct broker *b, uint32_t agent, uint64_t version_had)
{
    uint64_t version = b->registry.agents[agent].step_version;
    return is_paced(b) && version > version_had && version <= b->dispatch.open_version;
}

static int member_compare(const void *x, const void *y, const void *context)
{
    (void)context;
    const muster_Member *one = x, *other = y;
    return strcmp(one->name, other->name);
}

/* Changes of the white pages since the last Delivery; inside, those of the last step. */
static void members_fill(struct broker *b, const struct process *at, muster_Delivery *d)
{
    const struct changelog *c = &b->registry.changes;
    uint64_t upto = b->dispatch.open_version;
    if (at->version_had >= upto ||
        at->kind == PROCESS_BROKER) { /* which is told by the announcement */
        return;
    }
    /* With its first agent it learns which broker this is, and forgets what another one has told.
     */
    if (at->agents_count == 0 && !is_paced(b)) {
        b->dispatch.open_version = at->version_had;
        return;
    }
    CHANGELOG_EACH (i, c, at->version_had) {
        uint64_t version = changelog_version(c, i);
        if (version > upto && !line_is_of_step(b, i, at->version_had)) {
            continue;
        }
        if (d->members._length == DISPATCH_MEMBERS) { /* the rest comes next time */
            b->dispatch.open_version = version > upto ? upto : version - 1;
            return;
        }
        if (line_is_shown(b, i)) {
            registry_line(&b->registry, i, b->name, &d->members._buffer[d->members._length++]);
        }
    }
}

static void outside_fill(struct broker *b, muster_Delivery *d)
{
    const struct steps_view *view = &b->dispatch.view;
    for (uint32_t i = 0; i < view->told_count; i++) {
        d->outside._buffer[d->outside._length++] = view->told[i]->letter;
    }
}

static void delivery_begin(struct broker *b, const struct process *at, muster_Delivery *d)
{
    struct dispatch *c = &b->dispatch;
    *d = (muster_Delivery){.broker = b->name,
                           .broker_incarnation = b->incarnation,
                           .step = muster_STEP_NOW,
                           .roll_call = at->roll_call_due,
                           .seat = at->seat,
                           .serial = at->serial + 1,
                           .parcels = {DISPATCH_ITEMS, 0, c->items, false},
                           .receipts = {DISPATCH_RECEIPTS, 0, c->receipts, false},
                           .verdicts = {DISPATCH_VERDICTS, 0, c->verdicts, false},
                           .members = {DISPATCH_MEMBERS, 0, c->members, false},
                           .outside = {STEPS_OUTSIDE_MAX, 0, c->outside, false},
                           .memberships = {MU_MEMBERSHIPS_MAX, 0, b->pages.memberships, false},
                           .offers = {MU_SERVICES_MAX, 0, b->pages.offers, false}};
    d->process = sample_text(at->name);
}

/* Takes agents out of the process's queue, and puts them in order of name. */
static void parts_take(struct broker *b, uint32_t place)
{
    struct dispatch *c = &b->dispatch;
    c->parts_count = 0;
    while (c->parts_count < DISPATCH_AGENTS && processes_agent_waits(&b->processes, place)) {
        uint32_t agent = processes_pop_agent(b, place);
        c->parts[c->parts_count++] = (struct dispatch_part){.agent = agent};
    }
    mu_sort(c->parts, c->parts_count, sizeof c->parts[0], registry_compare, &b->registry);
}

static void parts_fill(struct broker *b, muster_Delivery *d)
{
    struct dispatch *c = &b->dispatch;
    bool flooded = pacing_is_due(&b->processes.at[c->open]) && pacing_is_flooded(b, c->open);
    struct dispatch_room room = {.items = flooded ? PACING_MAILS : MU_WINDOW_MAX,
                                 .bytes = DISPATCH_BYTES};
    for (uint32_t i = 0; i < c->parts_count; i++) {
        struct dispatch_part *part = &c->parts[i];
        if (is_paced(b)) { /* each box has its own room: none can starve another */
            uint32_t left = DISPATCH_ITEMS - d->parcels._length;
            uint32_t most = MU_WINDOW_MAX + MAILBOX_RESERVE;
            room = (struct dispatch_room){.items = left < most ? left : most,
                                          .bytes = DISPATCH_BOX_BYTES};
        }
        part->passed_by = !items_fill(b, part, &room, d);
        bool some = receipts_count(&b->receipts, part->agent) > 0;
        if (some && !scope_waits(b->registry.agents[part->agent].scope)) {
            part->receipts = receipts_fill(b, part->agent, d);
            part->passed_by |= part->receipts < receipts_count(&b->receipts, part->agent);
        }
        welcome_add(b, part, d);
    }
}

bool compose_fill(struct broker *b, uint32_t place, muster_Delivery *d)
{
    struct dispatch *c = &b->dispatch;
    struct process *at = &b->processes.at[place];
    c->view = (struct steps_view){
        .scope = at->scope, .step = muster_STEP_NOW, .version = b->registry.changes.version};
    if (scope_is_paced(at->scope) && !steps_view(b, place, c->interval_ns, &c->view)) {
        return false;
    }
    c->open_version = c->view.version;
    c->open_delay_ns = 0;
    delivery_begin(b, at, d);
    d->step = c->view.step;
    parts_take(b, place);
    parts_fill(b, d);
    refusals_fill(b, at, d);
    members_fill(b, at, d);
    if (is_paced(b)) { /* in which order they changed depends on the wall clock */
        mu_sort(c->members, d->members._length, sizeof c->members[0], member_compare, NULL);
    }
    if (view_open(&b->pages, at)) {
        view_fill(b, at, d);
    }
    outside_fill(b, d);
    return is_paced(b) || d->parcels._length || d->receipts._length || d->verdicts._length ||
           d->members._length || d->memberships._length || d->offers._length || d->roll_call;
}

bool compose_fill_word(struct broker *b, uint32_t place, muster_Delivery *d)
{
    struct dispatch *c = &b->dispatch;
    if (snapshots_next(b, place, &c->trip)) {
        c->open_word = WORD_TRIP;
    } else if (probes_next(b, place, &c->probe)) {
        c->open_word = WORD_PROBE;
    } else {
        return false;
    }
    delivery_begin(b, &b->processes.at[place], d);
    d->roll_call = false;
    if (c->open_word == WORD_TRIP) {
        d->trips._buffer = &c->trip;
        d->trips._length = d->trips._maximum = 1;
    } else {
        d->serial = 0; /* it waits for nothing */
        d->glances._buffer = &c->probe;
        d->glances._length = d->glances._maximum = 1;
    }
    return true;
}
