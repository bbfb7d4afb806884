/* SPDX-License-Identifier: Apache-2.0 */

#include "broker/control/step.h"
#include "broker/membership/membership.h"

#include <string.h>

/* --- the end of a step ------------------------------------------------------------------------ */

/* A step ends: notes what has been counted until now.  What a process acknowledges later, when it
 * has seen that no step follows, may come before the lock step has ended, or after it. */
static void counts_note(struct broker *b)
{
    const muster_BrokerStatus *c = &b->counters;
    b->steps.so_far =
        (muster_LockstepEnd){.ended = b->steps.end.ended + 1,
                             .sent = c->sent,
                             .delivered = c->delivered,
                             .waiting = b->mailbox.posts_pool.live,
                             .expired = c->expired,
                             .refused = c->box_full + c->over_share + c->unknown_name + c->refused +
                                        c->dropped + c->no_store};
}

/* Everything of the step takes effect, and the next step begins. */
static void step_end(struct broker *b)
{
    struct steps *l = &b->steps;
    l->step++;
    b->clock.run_ns = (uint64_t)l->step * b->clock.step_ns;
    step_apply(b);
    counts_note(b);
    l->answered = 0;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        steps_role_on(b, l->roster[i], ROLE_STEP_ENDS);
    }
    l->awaits_moves = true;
    transfer_step_ended(b);
}

static bool step_is_complete(const struct steps *l)
{
    return l->roster_count > 0 && l->answered == l->roster_count && !l->held;
}

static void residents_have_heard(struct broker *b, uint32_t place)
{
    PROCESSES_EACH_AGENT (b, agent, place) {
        receipts_drop(&b->receipts, agent, b->receipts.told[agent]);
    }
}

void step_answered(struct broker *b, uint32_t place)
{
    struct steps *l = &b->steps;
    steps_role_on(b, place, ROLE_ANSWERS);
    residents_have_heard(b, place);
    l->answered++;
    if (step_is_complete(l)) {
        step_end(b);
    }
}

/* --- the roster ------------------------------------------------------------------------------- */

static void process_enter(struct broker *b, uint32_t place)
{
    steps_role_on(b, place, ROLE_JOINS);
    PROCESSES_EACH_AGENT (b, agent, place) {
        mailbox_unwatch(&b->mailbox, agent);
        processes_wake_agent(b, agent); /* its mail may have waited for this */
    }
}

/* The lock step lets go of a process; it has what it owes, or that is not wanted any more. */
static void process_leave(struct broker *b, uint32_t place)
{
    struct process *at = &b->processes.at[place];
    steps_role_on(b, place, ROLE_LEAVES);
    at->groups_had = at->services_had = 0; /* it was not shown all */
    if (!b->steps.held) {                  /* else its next life is to be told again */
        residents_have_heard(b, place);
    }
    at->roll_call_due = at->roll_call_due || at->overruled;
    at->overruled = false;
    PROCESSES_EACH_AGENT (b, agent, place) {
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
        processes_wake_agent(b, agent);
        if (clock_by_steps(&b->clock)) { /* members that stay are not shown its services any more */
            notify_presence(b, agent);
        }
    }
    lifecycle_settle(b, place);
    processes_wake(&b->processes, place);
    processes_tidy(&b->processes, place);
}

/* None of what an expelled process has done in this step takes effect.  If the run is held for its
 * next life, that says it again, and hears of it then. */
static void turns_drop(struct broker *b, uint32_t place)
{
    PROCESSES_EACH_AGENT (b, agent, place) {
        struct turn *turn = &b->steps.turns[agent];
        turn->has_ack = turn->has_state = false;
        struct mail *m = pool_list_pop(&turn->mails);
        if (m && m->letter.seq <= b->registry.agents[agent].seq.seen) {
            b->registry.agents[agent].seq.seen = m->letter.seq - 1; /* it was never said */
        }
        for (; m; m = pool_list_pop(&turn->mails)) {
            if (b->steps.held) {
                (void)mail_tell(m, TOLD_LAST);
            }
            outcome_drop(b, m);
        }
    }
}

static bool roster_names(const muster_Roster *roster, const struct process *at)
{
    for (uint32_t i = 0; i < roster->processes._length; i++) {
        if (strcmp(roster->processes._buffer[i], at->name) == 0) {
            return true;
        }
    }
    return false;
}

/* Lets go of the processes that a new roster does not name. */
static void roster_shrink(struct broker *b, const muster_Roster *roster)
{
    struct steps *l = &b->steps;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        uint32_t place = l->roster[i];
        if (roster_names(roster, &b->processes.at[place])) {
            l->roster[kept++] = place;
            continue;
        }
        l->answered -= role_next(l->members[place].role, ROLE_ANSWERS) == ROLES;
        PROCESSES_EACH_AGENT (b, agent, place) {
            b->registry.agents[agent].let_go = roster->held || b->registry.agents[agent].let_go;
        }
        turns_drop(b, place);
        process_leave(b, place);
    }
    l->roster_count = kept;
}

/* The others have not been told of these agents while they were outside. */
static void lines_tell(struct broker *b, uint32_t place)
{
    PROCESSES_EACH_AGENT (b, agent, place) {
        registry_touch(&b->registry, agent);
        groups_enter(&b->pages.groups, b->registry.agents[agent].name);
        notify_presence(b, agent);
    }
}

/* Takes in the processes that a new roster names. */
static void roster_grow(struct broker *b, const muster_Roster *roster, bool in_mid_run)
{
    struct steps *l = &b->steps;
    for (uint32_t i = 0; i < roster->processes._length; i++) {
        uint32_t place = processes_get(&b->processes, roster->processes._buffer[i]);
        if (place == MU_NONE) {
            b->counters.malformed++;
        } else if (!scope_is_inside(b->processes.at[place].scope)) {
            process_enter(b, place);
            l->roster[l->roster_count++] = place;
            if (in_mid_run) {
                lines_tell(b, place);
            }
        }
    }
}

/* The run is held for a process that is to come, or is so no longer: agents whose mail waited for
 * that get it. */
static void lockstep_hold(struct broker *b, bool held)
{
    bool ends = b->steps.held && !held;
    b->steps.held = held;
    for (uint32_t agent = REGISTRY_OWN; agent < b->registry.count; agent++) {
        steps_rescope(b, agent);
        if (ends && !view_inside(b, agent)) {
            processes_wake_agent(b, agent);
        }
    }
}

static void lockstep_end(struct broker *b)
{
    struct steps *l = &b->steps;
    l->end = l->so_far;
    l->awaits_moves = false;
    transfer_run_over(b, scope_refuses_move(SCOPE_RUN, SCOPE_OPEN));
    do { /* nothing that was admitted is lost */
        steps_told(b);
        step_apply(b);
    } while (l->outside_use.mails > 0);
    steps_told(b);
    clock_start(&b->clock, 0, clock_run_ns(&b->clock));
    lockstep_hold(b, false);
    step_drop_replays(b);
    uint32_t count = l->roster_count, simulator = l->simulator;
    l->roster_count = l->answered = 0;
    l->simulator = MU_NONE;
    steps_role_on(b, simulator, ROLE_LEAVES);
    for (uint32_t i = 0; i < count; i++) {
        b->processes.at[l->roster[i]].version_had =
            0; /* and of those outside, it has missed changes */
        process_leave(b, l->roster[i]);
    }
    notify_run(b, false);
    processes_wake(&b->processes, simulator);
    processes_tidy(&b->processes, simulator);
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
    struct steps *l = &b->steps;
    run_forget(b);
    route_resolve_expire(b, UINT64_MAX); /* no question from before belongs to it */
    clock_start(&b->clock, roster->step_ns, (uint64_t)roster->step * roster->step_ns);
    lockstep_hold(b, roster->held);
    l->step = roster->step;
    l->simulator = simulator;
    steps_role_on(b, simulator, ROLE_SIMULATES);
    roster_grow(b, roster, false);
    outcome_admit_due(b, clock_run_ns(&b->clock));
    counts_note(b);
    l->version = l->start_version = b->registry.changes.version;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        struct process *at = &b->processes.at[l->roster[i]];
        at->version_had = at->groups_had = at->services_had = 0; /* the whole pages, as of now */
    }
    notify_run(b, true);
}

/* A run that goes on with other processes.  The simulator may be a step ahead: it has an answer
 * that did not come here, and which the process's next life says again. */
static void lockstep_change(struct broker *b, const muster_Roster *roster)
{
    struct steps *l = &b->steps;
    lockstep_hold(b, roster->held);
    roster_shrink(b, roster);
    roster_grow(b, roster, true);
    if (step_is_complete(l)) {
        step_end(b);
    }
}

/* Each process gets the Delivery before the current step, and gets it once. */
static void deliveries_owe(struct broker *b)
{
    struct steps *l = &b->steps;
    for (uint32_t i = 0; i <= l->roster_count; i++) {
        uint32_t place = i < l->roster_count ? l->roster[i] : l->simulator;
        if (l->members[place].step_had != l->step - 1) {
            steps_owe_delivery(b, place);
        }
    }
}

static void roster_take(struct broker *b, const muster_Roster *roster)
{
    struct steps *l = &b->steps;
    bool same = clock_by_steps(&b->clock) &&
                strcmp(b->processes.at[l->simulator].name, roster->simulator) == 0;
    if (!roster->lockstep) {
        if (same) {
            lockstep_end(b);
        }
        if (!clock_by_steps(&b->clock)) {
            uint64_t steps = roster->step > 0 ? (uint64_t)roster->step : 0;
            clock_start(&b->clock, 0, steps * roster->step_ns);
        }
        return;
    }
    /* The simulator may not have heard yet that the step before has ended. */
    bool goes_on = same && roster->step_ns == b->clock.step_ns && roster->step >= l->step - 1 &&
                   roster->step <= l->step + 1;
    if (goes_on) {
        lockstep_change(b, roster);
    } else {
        uint32_t simulator = processes_get(&b->processes, roster->simulator);
        if (simulator == MU_NONE) {
            b->counters.malformed++;
            return;
        }
        if (clock_by_steps(&b->clock)) {
            lockstep_end(b);
            simulator =
                processes_get(&b->processes, roster->simulator); /* it may have been let go */
        }
        lockstep_start(b, roster, simulator);
    }
    deliveries_owe(b);
}

/* @return whether a run can be at that step: if it goes by steps, they are counted and timed */
static bool step_is_good(int64_t step, uint64_t step_ns, bool by_steps)
{
    if (step < 0 || step_ns == 0) {
        return !by_steps;
    }
    return (uint64_t)step + 2 <= (uint64_t)INT64_MAX / step_ns;
}

/* @return whether these can be the processes of a run; its simulator is none of them */
static bool members_are_good(const char *simulator, char *const *processes, uint32_t count)
{
    bool good = validate_process_name(simulator);
    for (uint32_t i = 0; i < count && good; i++) {
        good = validate_process_name(processes[i]) && strcmp(processes[i], simulator) != 0;
    }
    return good;
}

void broker_roster(struct broker *b, const muster_Roster *roster, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    if (step_is_good(roster->step, roster->step_ns, roster->lockstep) &&
        members_are_good(roster->simulator, roster->processes._buffer, roster->processes._length)) {
        roster_take(b, roster);
    } else {
        b->counters.malformed++;
    }
}
