/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/lockstep.h"

#include "broker/control/parts.h"
#include "broker/mail/outcome.h"
#include "broker/membership/presence.h"
#include "broker/services/router.h"
#include "core/address.h"
#include "core/sort.h"
#include "muster/memory.h"

#include <string.h>

/* Mails that wait for the end of a step, in bytes of the store: from inside, and from outside. */
enum { OUTSIDE_BYTES = MU_STEP_BYTES_MAX / 4, STEP_BYTES = MU_STEP_BYTES_MAX - OUTSIDE_BYTES };

void lockstep_init(struct lockstep *l, uint32_t agents)
{
    *l = (struct lockstep){.simulator = MU_NONE};
    l->turns = mu_startup_array(agents, sizeof *l->turns);
    l->active = mu_startup_array(agents, sizeof *l->active);
}

/* --- collecting ------------------------------------------------------------------------------- */

static void list_append(struct mail_list *list, struct mail *m)
{
    m->next = NULL;
    if (list->last) {
        list->last->next = m;
    } else {
        list->first = m;
    }
    list->last = m;
    list->count++;
}

static struct mail *list_pop(struct mail_list *list)
{
    struct mail *m = list->first;
    if (m) {
        list->first = m->next;
        list->last = m->next ? list->last : NULL;
        list->count--;
    }
    return m;
}

static struct turn *turn_open(struct lockstep *l, uint32_t agent)
{
    struct turn *turn = &l->turns[agent];
    if (!turn->active) {
        turn->active = true;
        l->active[l->active_count++] = agent;
    }
    return turn;
}

void lockstep_open_turn(struct lockstep *l)
{
    uint32_t each = STEP_BYTES / (l->roster_count > 0 ? l->roster_count : 1);
    l->turn_bytes = each > STORE_RECORD_MAX ? each : STORE_RECORD_MAX;
}

static bool mail_is_durable(const struct mail *m)
{
    return m->letter.level != muster_LEVEL_RAM && m->letter.hops == 0;
}

static bool mail_is_for_many(const struct mail *m)
{
    bool is_for_names = mu_address_kind(m->letter.dst) == MU_ADDRESS_NAMES;
    return m->only == MU_NONE && !(is_for_names && !strchr(m->letter.dst, ','));
}

/* @return whom a mail is for alone, or MU_NONE */
static uint32_t mail_receiver(const struct broker *b, const struct mail *m)
{
    if (m->only != MU_NONE || mail_is_for_many(m)) {
        return m->only;
    }
    return registry_find(&b->registry, m->letter.dst);
}

/* Counts a mail from outside that is kept, or is kept no longer. */
static void outside_count(struct lockstep *l, const struct mail *m, uint32_t by)
{
    bool is_relayed = m->letter.hops > 0 && m->letter.level != muster_LEVEL_RAM;
    l->outside_waiting += by;
    l->turns[m->sender].many += mail_is_for_many(m) ? by : 0;
    if (m->kept_for != MU_NONE) {
        l->turns[m->kept_for].awaited += by;
        l->turns[m->kept_for].relayed += is_relayed ? by : 0;
    }
}

bool lockstep_keep(struct broker *b, struct mail *m, bool from_outside)
{
    struct lockstep *l = &b->lockstep;
    static const struct share_use most = {.mails = UINT32_MAX, .bytes = OUTSIDE_BYTES};
    static const struct share_use least = {.mails = UINT32_MAX, .bytes = OUTSIDE_BYTES / 64};
    struct turn *turn = turn_open(l, m->sender);
    struct share_use want = {.mails = 1, .bytes = store_bytes(m)};
    if (from_outside) {
        if (share_ask(&turn->outside_use, &l->outside_use, &want, &most, &least) != SHARE_FITS) {
            return false;
        }
        share_add(&turn->outside_use, &want);
        share_add(&l->outside_use, &want);
        m->kept_for = mail_receiver(b, m);
        outside_count(l, m, 1);
    } else if (want.bytes > l->turn_bytes) {
        return false;
    } else {
        l->turn_bytes -= want.bytes;
    }
    list_append(from_outside ? &turn->outside : &turn->mails, m);
    return true;
}

bool lockstep_keeps_before(const struct broker *b, const struct mail *m, uint32_t receiver)
{
    const struct lockstep *l = &b->lockstep;
    const struct turn *turn = &l->turns[m->sender];
    bool may_overtake = l->turns[receiver].awaited > 0 || mail_is_durable(m);
    return turn->many > 0 || (turn->outside.first && may_overtake);
}

bool lockstep_keeps_relayed(const struct lockstep *l, uint32_t agent)
{
    return l->turns[agent].relayed > 0;
}

void lockstep_keep_ack(struct lockstep *l, uint32_t agent, uint64_t number)
{
    struct turn *turn = turn_open(l, agent);
    if (!turn->has_ack || number > turn->ack) {
        turn->ack = number;
    }
    turn->has_ack = true;
}

void lockstep_keep_state(struct lockstep *l, uint32_t agent, muster_State state)
{
    struct turn *turn = turn_open(l, agent);
    turn->has_state = true;
    turn->state = state;
}

bool lockstep_wants(const struct broker *b, uint32_t place, int64_t step)
{
    const struct place *at = &b->places.at[place];
    return at->rostered && !at->answered && step == b->lockstep.step;
}

bool lockstep_awaits(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    return b->lockstep.on && b->lockstep.held && a->is.kind == muster_KIND_ROBOT &&
           !b->places.at[a->process].rostered;
}

/* --- the end of a step ------------------------------------------------------------------------ */

static int agent_compare(const void *x, const void *y, const void *registry)
{
    const uint32_t *one = x, *other = y;
    const struct registry *r = registry;
    return strcmp(r->agents[*one].name, r->agents[*other].name);
}

/* Who was collected first depends on the clock; what takes effect first does not. */
static void turns_order(struct broker *b)
{
    struct lockstep *l = &b->lockstep;
    mu_sort(l->active, l->active_count, sizeof *l->active, agent_compare, &b->registry);
}

/* The next step begins with those of whom something is left. */
static void turns_close(struct lockstep *l)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < l->active_count; i++) {
        struct turn *turn = &l->turns[l->active[i]];
        turn->active = turn->outside.first != NULL;
        if (turn->active) {
            l->active[kept++] = l->active[i];
        }
    }
    l->active_count = kept;
}

static void acks_apply(struct broker *b)
{
    for (uint32_t i = 0; i < b->lockstep.active_count; i++) {
        uint32_t agent = b->lockstep.active[i];
        struct turn *turn = &b->lockstep.turns[agent];
        if (turn->has_ack) {
            turn->has_ack = false;
            router_acknowledge(b, agent, turn->ack);
        }
    }
}

static void states_apply(struct broker *b)
{
    for (uint32_t i = 0; i < b->lockstep.active_count; i++) {
        uint32_t agent = b->lockstep.active[i];
        struct turn *turn = &b->lockstep.turns[agent];
        if (!turn->has_state) {
            continue;
        }
        turn->has_state = false;
        if (b->registry.agents[agent].process == MU_NONE) {
            continue;
        }
        if (turn->state == muster_STATE_ABSENT) {
            presence_depart(b, agent);
        } else {
            presence_set_state(b, agent, turn->state);
        }
    }
}

static void mails_apply(struct broker *b)
{
    for (uint32_t i = 0; i < b->lockstep.active_count; i++) {
        struct turn *turn = &b->lockstep.turns[b->lockstep.active[i]];
        for (struct mail *m = list_pop(&turn->mails); m; m = list_pop(&turn->mails)) {
            (void)router_route(b, m);
        }
    }
}

static void outside_take(struct broker *b, struct turn *turn)
{
    struct lockstep *l = &b->lockstep;
    struct mail *m = list_pop(&turn->outside);
    outside_count(l, m, UINT32_MAX); /* one less */
    struct share_use less = {.mails = 1, .bytes = store_bytes(m)};
    share_subtract(&turn->outside_use, &less);
    share_subtract(&l->outside_use, &less);
    store_keep(m);
    if (router_route(b, m)) {
        l->told[l->told_count++] = m;
    } else {
        store_release(&b->store, m);
    }
}

/* @return how many mails of one sender have room in a step if all who have some get as much */
static uint32_t outside_share(const struct lockstep *l)
{
    uint32_t senders = 0;
    for (uint32_t i = 0; i < l->active_count; i++) {
        senders += l->turns[l->active[i]].outside.first != NULL;
    }
    return senders < LOCKSTEP_OUTSIDE_MAX ? LOCKSTEP_OUTSIDE_MAX / (senders + !senders) : 1;
}

/* @return how many have room beyond the shares: of who comes first by name */
static uint32_t outside_spare(const struct lockstep *l, uint32_t share)
{
    uint32_t used = l->told_count;
    for (uint32_t i = 0; i < l->active_count; i++) {
        uint32_t count = l->turns[l->active[i]].outside.count;
        used += count < share ? count : share;
    }
    return used < LOCKSTEP_OUTSIDE_MAX ? LOCKSTEP_OUTSIDE_MAX - used : 0;
}

/* Those that have room go in order of (sender, number), as a recording is put in again. */
static void outside_apply(struct broker *b)
{
    struct lockstep *l = &b->lockstep;
    uint32_t share = outside_share(l), spare = outside_spare(l, share);
    for (uint32_t i = 0; i < l->active_count && l->outside_waiting > 0; i++) {
        struct turn *turn = &l->turns[l->active[i]];
        uint32_t left = share;
        while (turn->outside.first && left + spare > 0 && l->told_count < LOCKSTEP_OUTSIDE_MAX) {
            outside_take(b, turn);
            *(left > 0 ? &left : &spare) -= 1;
        }
    }
}

void lockstep_keep_replay(struct broker *b, struct mail *m)
{
    if (b->replays.count == SHARE_MAILS_MAX) {
        router_turn_away(b, m);
        return;
    }
    m->at_ns[SCHEDULE_DUE] = (uint64_t)m->letter.due_ns;
    m->order = ++b->orders;
    schedule_add(&b->replays, m);
    outcome_stored(b, m);
}

/* The run that they are of is over. */
static void replays_drop(struct broker *b)
{
    for (struct mail *m; (m = schedule_first(&b->replays));) {
        schedule_remove(&b->replays, m);
        router_drop(b, m);
    }
}

/* What came in with this step when it was recorded comes in with it again. */
static void replays_keep(struct broker *b, uint64_t run_ns)
{
    for (struct mail *m = schedule_first(&b->replays); m && m->at_ns[SCHEDULE_DUE] <= run_ns;
         m = schedule_first(&b->replays)) {
        schedule_remove(&b->replays, m);
        if (!lockstep_keep(b, m, true)) {
            router_turn_away(b, m);
        }
    }
}

void lockstep_told(struct broker *b)
{
    struct lockstep *l = &b->lockstep;
    while (l->told_count > 0) {
        store_release(&b->store, l->told[--l->told_count]);
    }
}

static void step_apply(struct broker *b)
{
    b->lockstep.applying = true;
    replays_keep(b, runclock_run_ns(&b->clock));
    turns_order(b);
    acks_apply(b);
    router_expire(b, runclock_mail_ns(&b->clock));
    pages_expire(b, runclock_mail_ns(&b->clock));
    states_apply(b);
    mails_apply(b);
    outside_apply(b);
    router_resolve_expire(b, runclock_mail_ns(&b->clock));
    turns_close(&b->lockstep);
    router_admit_due(b, runclock_run_ns(&b->clock));
    b->lockstep.applying = false;
}

static uint64_t step_time_ns(const struct lockstep *l, int64_t step)
{
    return (uint64_t)step * l->step_ns;
}

static void delivery_owe(struct broker *b, uint32_t place)
{
    b->places.at[place].step_due = true;
    places_wake(&b->places, place);
}

void lockstep_release(struct broker *b)
{
    struct lockstep *l = &b->lockstep;
    if (!l->awaits_moves) {
        return;
    }
    l->awaits_moves = false;
    l->version = b->registry.changes.version;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        delivery_owe(b, l->roster[i]);
    }
    delivery_owe(b, l->simulator);
}

/* Everything of the step takes effect, and the next step begins. */
static void step_end(struct broker *b)
{
    struct lockstep *l = &b->lockstep;
    runclock_step(&b->clock, step_time_ns(l, l->step + 1));
    step_apply(b);
    l->step++;
    l->answered = 0;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        b->places.at[l->roster[i]].answered = false;
    }
    l->awaits_moves = true;
    if (!depot_step_ended(b)) {
        lockstep_release(b);
    }
}

static bool step_is_complete(const struct lockstep *l)
{
    return l->roster_count > 0 && l->answered == l->roster_count && !l->held;
}

uint32_t lockstep_missing(const struct lockstep *l)
{
    return l->on && l->roster_count > l->answered ? l->roster_count - l->answered : 1;
}

void lockstep_answered(struct broker *b, uint32_t place)
{
    struct lockstep *l = &b->lockstep;
    b->places.at[place].answered = true;
    l->answered++;
    if (step_is_complete(l)) {
        step_end(b);
    }
}

/* --- the roster ------------------------------------------------------------------------------- */

static void place_enter(struct broker *b, uint32_t place)
{
    struct place *at = &b->places.at[place];
    at->rostered = true;
    at->answered = false;
    at->step_due = false;
    at->step_had = INT64_MIN;
    for (uint32_t agent = tenants_first(&b->places, place); agent != TENANTS_NONE;
         agent = tenants_next(&b->registry, &b->places, agent)) {
        mailbox_unwatch(&b->mailbox, agent);
        tenants_wake(&b->registry, &b->places, agent); /* its mail may have waited for this */
    }
}

/* The lock step lets go of a process; it has what it owes, or nobody wants that any more. */
static void place_leave(struct broker *b, uint32_t place)
{
    struct place *at = &b->places.at[place];
    at->rostered = false;
    at->answered = false;
    at->step_due = false;
    pages_forget_told(at); /* it was not shown all */
    at->roll_call_due = at->roll_call_due || at->overruled;
    at->overruled = false;
    for (uint32_t agent = tenants_first(&b->places, place); agent != TENANTS_NONE;
         agent = tenants_next(&b->registry, &b->places, agent)) {
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
        tenants_wake(&b->registry, &b->places, agent);
        if (b->lockstep.on) { /* those who stay are not shown its services any more */
            pages_presence(b, agent);
        }
    }
    presence_settle(b, place);
    places_wake(&b->places, place);
    places_tidy(&b->places, place);
}

/* None of what an expelled process has done in this step takes effect. */
static void turns_drop(struct broker *b, uint32_t place)
{
    for (uint32_t agent = tenants_first(&b->places, place); agent != TENANTS_NONE;
         agent = tenants_next(&b->registry, &b->places, agent)) {
        struct turn *turn = &b->lockstep.turns[agent];
        turn->has_ack = turn->has_state = false;
        struct mail *m = list_pop(&turn->mails);
        if (m && m->letter.seq <= b->registry.agents[agent].seen_seq) {
            b->registry.agents[agent].seen_seq = m->letter.seq - 1; /* it was never said */
        }
        for (; m; m = list_pop(&turn->mails)) {
            router_drop(b, m);
        }
    }
}

static bool roster_names(const muster_Roster *roster, const struct place *at)
{
    for (uint32_t i = 0; i < roster->processes._length; i++) {
        if (strcmp(roster->processes._buffer[i], at->name) == 0) {
            return true;
        }
    }
    return false;
}

static void tenants_let_go(struct broker *b, uint32_t place)
{
    for (uint32_t agent = tenants_first(&b->places, place); agent != TENANTS_NONE;
         agent = tenants_next(&b->registry, &b->places, agent)) {
        b->registry.agents[agent].let_go = true;
    }
}

/* Lets go of the processes that a new roster does not name. */
static void roster_shrink(struct broker *b, const muster_Roster *roster)
{
    struct lockstep *l = &b->lockstep;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        uint32_t place = l->roster[i];
        if (roster_names(roster, &b->places.at[place])) {
            l->roster[kept++] = place;
            continue;
        }
        l->answered -= b->places.at[place].answered;
        if (roster->held) {
            tenants_let_go(b, place);
        }
        turns_drop(b, place);
        place_leave(b, place);
    }
    l->roster_count = kept;
}

/* The others have not been told of these agents while they were outside. */
static void lines_tell(struct broker *b, uint32_t place)
{
    for (uint32_t agent = tenants_first(&b->places, place); agent != TENANTS_NONE;
         agent = tenants_next(&b->registry, &b->places, agent)) {
        registry_touch(&b->registry, agent);
        pages_enter(b, agent);
    }
}

/* Takes in the processes that a new roster names. */
static void roster_grow(struct broker *b, const muster_Roster *roster, bool in_mid_run)
{
    struct lockstep *l = &b->lockstep;
    for (uint32_t i = 0; i < roster->processes._length; i++) {
        uint32_t place = places_get(&b->places, roster->processes._buffer[i]);
        if (place == MU_NONE) {
            b->counters.malformed++;
        } else if (!b->places.at[place].rostered) {
            place_enter(b, place);
            l->roster[l->roster_count++] = place;
            if (in_mid_run) {
                lines_tell(b, place);
            }
        }
    }
}

/* Whoever's mail waited for a process that was to come gets it. */
static void lockstep_hold(struct broker *b, bool held)
{
    bool ends = b->lockstep.held && !held;
    b->lockstep.held = held;
    for (uint32_t agent = 0; ends && agent < b->registry.count; agent++) {
        if (!presence_in_lockstep(b, agent)) {
            tenants_wake(&b->registry, &b->places, agent);
        }
    }
}

/* What comes from now on comes by the clock. */
static void counters_keep(struct broker *b)
{
    const struct broker_counters *c = &b->counters;
    b->lockstep_end =
        (muster_LockstepEnd){.ended = b->lockstep_end.ended + 1,
                             .sent = c->sent,
                             .delivered = c->delivered,
                             .waiting = c->waiting,
                             .expired = c->expired,
                             .refused = c->box_full + c->over_share + c->unknown_name + c->refused +
                                        c->dropped + c->no_store};
}

static void lockstep_end(struct broker *b)
{
    struct lockstep *l = &b->lockstep;
    counters_keep(b);
    l->awaits_moves = false;
    depot_lockstep_over(b);
    do { /* nothing that was admitted is lost */
        lockstep_told(b);
        step_apply(b);
    } while (l->outside_waiting > 0);
    lockstep_told(b);
    l->on = false;
    lockstep_hold(b, false);
    replays_drop(b);
    uint32_t count = l->roster_count, simulator = l->simulator;
    l->roster_count = l->answered = 0;
    l->simulator = MU_NONE;
    b->places.at[simulator].simulator = false;
    b->places.at[simulator].step_due = false;
    for (uint32_t i = 0; i < count; i++) {
        b->places.at[l->roster[i]].version_had =
            0; /* and of those outside, it has missed changes */
        place_leave(b, l->roster[i]);
    }
    pages_thaw(b);
    places_wake(&b->places, simulator);
    places_tidy(&b->places, simulator);
}

/* What an earlier run did with names is nothing to the next. */
static void run_forget(struct broker *b)
{
    for (uint32_t agent = 0; agent < b->registry.count; agent++) {
        b->registry.agents[agent].let_go = false;
        b->registry.agents[agent].passed = false;
        b->registry.agents[agent].left = MU_NONE;
    }
}

static void lockstep_start(struct broker *b, const muster_Roster *roster, uint32_t simulator)
{
    struct lockstep *l = &b->lockstep;
    run_forget(b);
    router_resolve_give_up(b);
    l->on = true;
    l->held = roster->held;
    l->step = roster->step;
    l->step_ns = roster->step_ns;
    l->simulator = simulator;
    b->places.at[simulator].simulator = true;
    b->places.at[simulator].step_had = INT64_MIN;
    roster_grow(b, roster, false);
    runclock_start(&b->clock, true, step_time_ns(l, l->step));
    router_admit_due(b, runclock_run_ns(&b->clock));
    l->version = l->start_version = b->registry.changes.version;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        b->places.at[l->roster[i]].version_had = 0; /* the whole pages, as of now */
        pages_forget_told(&b->places.at[l->roster[i]]);
    }
    pages_freeze(b);
}

/* A run that goes on with other processes, from this step or the next. */
static void lockstep_change(struct broker *b, const muster_Roster *roster)
{
    struct lockstep *l = &b->lockstep;
    lockstep_hold(b, roster->held);
    roster_shrink(b, roster);
    roster_grow(b, roster, true);
    if (roster->step > l->step || step_is_complete(l)) {
        step_end(b);
    }
}

/* Each process gets the Delivery before the current step, and gets it once. */
static void deliveries_owe(struct broker *b)
{
    struct lockstep *l = &b->lockstep;
    for (uint32_t i = 0; i <= l->roster_count; i++) {
        uint32_t place = i < l->roster_count ? l->roster[i] : l->simulator;
        if (b->places.at[place].step_had != l->step - 1) {
            delivery_owe(b, place);
        }
    }
}

void lockstep_set_roster(struct broker *b, const muster_Roster *roster)
{
    struct lockstep *l = &b->lockstep;
    bool same = l->on && strcmp(b->places.at[l->simulator].name, roster->simulator) == 0;
    if (!roster->lockstep) {
        if (same) {
            lockstep_end(b);
        }
        if (!l->on) {
            uint64_t steps = roster->step > 0 ? (uint64_t)roster->step : 0;
            runclock_start(&b->clock, false, steps * roster->step_ns);
        }
        return;
    }
    /* The simulator may not have heard yet that the step before has ended. */
    bool goes_on = same && roster->step_ns == l->step_ns && roster->step >= l->step - 1 &&
                   roster->step <= l->step + 1;
    if (goes_on) {
        lockstep_change(b, roster);
    } else {
        uint32_t simulator = places_get(&b->places, roster->simulator);
        if (simulator == MU_NONE) {
            b->counters.malformed++;
            return;
        }
        if (l->on) {
            lockstep_end(b);
            simulator = places_get(&b->places, roster->simulator); /* it may have been let go */
        }
        lockstep_start(b, roster, simulator);
    }
    deliveries_owe(b);
}
