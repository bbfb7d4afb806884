/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/membership.h"

#include "broker/control/parts.h"

#include <string.h>

void lifecycle_refuse_held(struct broker *b, uint32_t agent, uint32_t place, const char *home)
{
    char reason[MU_FIELD_MAX + 1];
    struct mu_text t = mu_text_in(reason, sizeof reason);
    mu_text_format(&t, "held by another participant%s%s", home[0] ? " at " : "", home);
    processes_refuse(&b->processes, place, b->registry.agents[agent].name, muster_REFUSAL_NAME_HELD,
                     reason);
}

static struct claim claim_take(struct broker *b, uint32_t index)
{
    struct claim claim = b->claims.at[index];
    claims_drop(&b->claims, &b->registry.agents[claim.agent].claims, index);
    b->processes.at[claim.process].claims--;
    return claim;
}

void lifecycle_end_claim(struct broker *b, uint32_t index)
{
    uint32_t place = claim_take(b, index).process;
    processes_tidy(&b->processes, place);
}

/* A copy of an agent that has set out anew since, or has stayed after all.  An agent that never
 * moved is another one of that name. */
static bool is_out_of_date(const struct presence *copy, const struct presence *now)
{
    return copy->epoch > 0 && copy->epoch < now->epoch;
}

/* Its holder waits for the name no longer, and may have moved on from copies that do. */
static void claims_review(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    uint32_t behind = MU_NONE;
    for (uint32_t i = mu_list_first(&a->claims); i != MU_NONE; i = behind) {
        behind = mu_list_next(MU_LINKS(b->claims.at, behind), i);
        if (b->claims.at[i].process == a->process) {
            lifecycle_end_claim(b, i);
        } else if (is_out_of_date(&b->claims.at[i].presence, &a->is)) {
            processes_refuse(&b->processes, b->claims.at[i].process, a->name,
                             muster_REFUSAL_OUT_OF_DATE, "out of date");
            lifecycle_end_claim(b, i);
        }
    }
}

/* All that wait for a name begin anew, in the order that they have. */
static void claims_renew(struct broker *b, uint32_t agent)
{
    struct mu_list *of = &b->registry.agents[agent].claims;
    for (uint32_t count = of->count; count > 0; count--) {
        struct claim claim = b->claims.at[mu_list_first(of)];
        claims_drop(&b->claims, of, mu_list_first(of));
        claim.until_ns = names_hold_end_ns(b);
        bool fits = claims_add(&b->claims, of, &claim);
        MU_ASSERT(fits);
    }
}

void lifecycle_claim(struct broker *b, struct claim *c)
{
    struct agent *a = &b->registry.agents[c->agent];
    uint32_t had = claims_find(&b->claims, &a->claims, c->process);
    c->until_ns = names_hold_end_ns(b);
    if (is_out_of_date(&c->presence, &a->is)) {
        processes_refuse(&b->processes, c->process, a->name, muster_REFUSAL_OUT_OF_DATE,
                         "out of date");
    } else if (had != MU_NONE) {
        b->claims.at[had].slot = c->slot;
        b->claims.at[had].presence = c->presence;
    } else if (claims_add(&b->claims, &a->claims, c)) {
        b->processes.at[c->process].claims++;
    } else {
        lifecycle_refuse_held(b, c->agent, c->process, a->is.home);
    }
}

/* The process that it has left may have gone before it was seen on its way: its snapshot was. */
bool lifecycle_is_copy(struct broker *b, uint32_t agent, const struct presence *is)
{
    bool is_known = is->epoch == b->registry.agents[agent].is.epoch;
    return is->epoch > 0 && (is_known || is->epoch == snapshots_epoch(b, agent));
}

/* @return the claim of the process for which the last bearer has set out, or MU_NONE */
static uint32_t copy_claim(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    MU_LIST_EACH (i, &a->claims, MU_LINKS(b->claims.at, behind)) {
        if (lifecycle_is_copy(b, agent, &b->claims.at[i].presence)) {
            return i;
        }
    }
    return MU_NONE;
}

/* A name without a bearer goes to the process that waits for it, if a run lets it. */
static void claims_grant(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    while (a->process == MU_NONE && a->claims.count > 0) {
        uint32_t copy = copy_claim(b, agent);
        struct claim heir = claim_take(b, copy != MU_NONE ? copy : mu_list_first(&a->claims));
        if (snapshots_overrule(b, agent, heir.process, &heir.presence)) {
            b->processes.at[heir.process].overruled = true;
            processes_tidy(&b->processes, heir.process);
        } else {
            lifecycle_seat(b, &heir);
        }
    }
}

void lifecycle_tick(struct broker *b)
{
    while (lifecycle_deadline_ns(b) <= b->clock.now_ns) {
        uint32_t index = mu_list_first(&b->claims.list), agent = b->claims.at[index].agent;
        const struct agent *a = &b->registry.agents[agent];
        if (a->process == MU_NONE) {
            claims_grant(b, agent); /* the agent that the name was kept for has not come */
        } else {
            lifecycle_refuse_held(b, agent, b->claims.at[index].process, a->is.home);
            lifecycle_end_claim(b, index);
        }
    }
}

uint64_t lifecycle_deadline_ns(const struct broker *b)
{
    uint32_t first = mu_list_first(&b->claims.list);
    return first != MU_NONE ? b->claims.at[first].until_ns : UINT64_MAX;
}

/* The box obeys what its agent declares. */
static void box_follow(struct broker *b, uint32_t agent, const struct presence *is)
{
    if (memcmp(&is->box, &b->registry.agents[agent].is.box, sizeof is->box) != 0) {
        mailbox_box(&b->mailbox, agent)->limits = is->box;
    }
}

void lifecycle_tell_again(struct broker *b, uint32_t place)
{
    b->processes.at[place].groups_had = b->processes.at[place].services_had = 0;
    PROCESSES_EACH_AGENT (b, agent, place) {
        names_owe_verdict(b, agent);
        mailbox_repeat(&b->mailbox, agent);
        processes_wake_agent(b, agent);
    }
    processes_wake(&b->processes, place);
}

/* What the agent has had in its box before is for its new process to have again. */
void lifecycle_seat(struct broker *b, const struct claim *c)
{
    uint32_t agent = c->agent;
    processes_add_agent(b, c->process, c->slot, agent);
    processes_accept(&b->processes, c->process, b->registry.agents[agent].name);
    box_follow(b, agent, &c->presence);
    registry_seat(&b->registry, agent, c->process, b->processes.at[c->process].name, &c->presence,
                  clock_wall_ns(&b->clock));
    steps_rescope(b, agent);
    names_owe_verdict(b, agent);
    journal_agent(b, agent);
    mailbox_repeat(&b->mailbox, agent);
    names_changed(b);
    notify_presence(b, agent);
    processes_wake_agent(b, agent);
    claims_review(b, agent);
    snapshots_review(b, agent);
}

void lifecycle_move(struct broker *b, const struct claim *c)
{
    struct agent *a = &b->registry.agents[c->agent];
    uint32_t from = a->process;
    processes_remove_agent(b, c->agent);
    mailbox_unwatch(&b->mailbox, c->agent);
    a->left = b->processes.at[from].seat;
    a->left_wall_ns = a->is.since_wall_ns;
    a->passed = true;
    lifecycle_seat(b, c);
    processes_tidy(&b->processes, from);
}

void lifecycle_depart(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    uint32_t place = a->process;
    processes_remove_agent(b, agent);
    registry_unseat(&b->registry, agent, clock_wall_ns(&b->clock));
    steps_rescope(b, agent);
    a->passed = b->clock.mode == CLOCK_COMMITS;
    if (a->passed) {
        registry_named_on(&b->registry, agent, NAMED_DISPOSED_BY_STEP);
    }
    mailbox_unwatch(&b->mailbox, agent);
    mailbox_repeat(&b->mailbox, agent);
    if (b->processes.at[place].kind == PROCESS_BROKER) {
        /* It is only out of sight: what it is to be told waits. */
        names_bearer_on(&b->registry, agent, BEARER_AWAITS);
    } else if (a->let_go ||
               (processes_is_silent(&b->processes.at[place]) && a->claims.count == 0)) {
        outcome_await(b, agent);
    } else {
        receipts_drop(&b->receipts, agent, receipts_count(&b->receipts, agent));
    }
    retire_disposed(b, agent); /* before another agent gets the name */
    names_changed(b);
    notify_presence(b, agent);
    if (!clock_by_steps(&b->clock) && snapshots_epoch(b, agent) > 0) {
        names_hold(b, agent);
    }
    if (names_is_held(b, agent) && copy_claim(b, agent) == MU_NONE) {
        claims_renew(b, agent);
    } else {
        claims_grant(b, agent);
    }
    processes_tidy(&b->processes, place);
    lifecycle_review(b, agent);
}

void lifecycle_set_state(struct broker *b, uint32_t agent, muster_State state)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->is.state != state) {
        a->is.state = state;
        a->since_wall_ns = clock_wall_ns(&b->clock);
        registry_touch(&b->registry, agent);
        names_changed(b);
        processes_wake_agent(b, agent);
    }
}

/* What is said of it when a step has ended does not hide from the others what the step has changed.
 */
static void step_version_keep(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    uint64_t version = changelog_version(&b->registry.changes, agent);
    if (scope_is_inside(a->scope) && version <= b->steps.version) {
        a->step_version = version;
    }
}

/* A registration from the process that has the name already. */
void lifecycle_reregister(struct broker *b, struct claim *c)
{
    uint32_t agent = c->agent;
    struct agent *a = &b->registry.agents[agent];
    if (scope_is_inside(a->scope)) { /* the steps alone change it */
        c->presence.state = a->is.state;
    }
    if (a->resident.slot != c->slot) {
        processes_remove_agent(b, agent);
        processes_add_agent(b, c->process, c->slot, agent);
        processes_wake_agent(b, agent);
    }
    box_follow(b, agent, &c->presence);
    step_version_keep(b, agent);
    bool changed = registry_update(&b->registry, agent, &c->presence, clock_wall_ns(&b->clock));
    steps_rescope(b, agent);
    if (changed) {
        journal_agent(b, agent);
        names_changed(b);
        processes_wake_agent(b, agent);
    }
    claims_review(b, agent);
    snapshots_review(b, agent);
}

void lifecycle_settle(struct broker *b, uint32_t place)
{
    uint32_t next = MU_NONE;
    for (uint32_t agent = processes_first_agent(b, place); agent != MU_NONE; agent = next) {
        next = processes_next_agent(b, agent);
        if (b->registry.agents[agent].report == REPORT_GONE) {
            lifecycle_depart(b, agent);
        } else {
            lifecycle_review(b, agent);
        }
    }
}

static void route_use(struct broker *b, uint32_t agent, const struct peer *p)
{
    const struct route *route = &p->routes[agent];
    uint32_t from = b->registry.agents[agent].process;
    struct claim c = {.agent = agent,
                      .process = processes_find(&b->processes, p->place),
                      .slot = route->slot,
                      .presence = route->is};
    if (c.process != MU_NONE && from == c.process) {
        lifecycle_reregister(b, &c);
    } else if (c.process != MU_NONE) {
        (from == MU_NONE ? lifecycle_seat : lifecycle_move)(b, &c);
    }
}

/* @param echoes  routes that may be echoes will do, too, as for an agent that has had none for long
 * enough */
static void route_choose(struct broker *b, uint32_t agent, bool echoes)
{
    const struct agent *a = &b->registry.agents[agent];
    bool is_here = a->process != MU_NONE && b->processes.at[a->process].kind != PROCESS_BROKER;
    struct peer *p = remote_best_peer(b, agent);
    const struct route *route = p ? &p->routes[agent] : NULL;
    if (is_here) {
        if (route && route->is.since_wall_ns < a->is.since_wall_ns && !scope_is_inside(a->scope)) {
            /* An agent of this broker has to give its name to one that has had it longer. */
            b->federation.count.clashes++;
            lifecycle_refuse_held(b, agent, a->process, route->is.home);
            route_use(b, agent, p);
        }
        return;
    }
    bool same = p && a->process != MU_NONE && strcmp(a->place, p->place) == 0;
    bool is_fresh = a->process == MU_NONE && !remote_pauses(&b->federation, agent);
    if (route && !echoes && !is_fresh && remote_may_be_echo(a, route, same)) {
        route = NULL;
    }
    if (route) {
        route_use(b, agent, p);
    } else if (a->process != MU_NONE) {
        remote_hold_down(b, agent);
        lifecycle_depart(b, agent);
    }
}

void lifecycle_review(struct broker *b, uint32_t agent)
{
    if (b->federation.peers_there > 0) {
        route_choose(b, agent, false);
    }
}

void lifecycle_tick_routes(struct broker *b)
{
    while (remote_deadline_ns(b) <= b->clock.now_ns) {
        struct federation *l = &b->federation;
        route_choose(b, mu_list_take(&l->pausing, MU_LINKS(l->pauses, link)), true);
    }
}
