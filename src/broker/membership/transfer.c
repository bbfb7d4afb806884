/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/membership.h"

#include "broker/control/parts.h"
#include "core/sort.h"

#include <string.h>

/* An agent that is absent for so long has no source that would take it back, or host that has only
 * not said yet that it has it. */
static const uint64_t ORPHAN_NS = 2000000000;

/* --- on the way ------------------------------------------------------------------------------- */

static void step_release(struct broker *b)
{
    if (b->snapshots.holding == 0) {
        steps_release(b);
    }
}

/* @return why an agent cannot be handed to the host that it names, or NULL */
static const char *objection(const struct broker *b, uint32_t host, bool in_step)
{
    const struct agent *a = host != MU_NONE ? &b->registry.agents[host] : NULL;
    if (!a || a->is.kind != muster_KIND_HOST) {
        return "unknown-host";
    }
    if (a->process == MU_NONE ||
        (a->report == REPORT_GONE && !in_step)) { /* inside it may be slow only */
        return "host-absent";
    }
    return scope_refuses_move(scope_of_word(in_step), b->processes.at[a->process].scope);
}

/* Keeps a snapshot, if nothing is wrong with it; agent: MU_NONE: of a new one.  @return it, or
 * NULL: refused, and the process is told */
static struct snapshot *deposit_keep(struct broker *b, uint32_t place, const muster_Trip *trip,
                                     uint32_t agent, const char *wrong)
{
    struct snapshot *c =
        wrong ? NULL : snapshots_add(b, agent, trip->agent, trip->epoch, trip->text);
    if (c) {
        c->state = trip->state;
        c->source = place;
        c->host = registry_find(&b->registry, trip->host);
    } else {
        b->snapshots.refused++;
        snapshots_refuse_copy(b, place, registry_find(&b->registry, trip->asker), trip->agent,
                              trip->epoch, wrong ? wrong : "depot-full");
    }
    return c;
}

static void deposit_take(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step)
{
    uint32_t agent = registry_find(&b->registry, trip->agent);
    uint32_t host = registry_find(&b->registry, trip->host);
    if (agent == MU_NONE || b->registry.agents[agent].process != place || trip->epoch == 0) {
        b->counters.malformed++;
        return;
    }
    const char *wrong = scope_refuses_move(b->processes.at[place].scope, scope_of_word(in_step));
    wrong = wrong ? wrong : objection(b, host, in_step);
    struct snapshot *c = deposit_keep(b, place, trip, agent, wrong);
    if (!c) {
        return;
    }
    (void)mu_text_copy(c->home, sizeof c->home, b->processes.at[place].name);
    c->in_step = in_step;
    if (in_step) {
        c->phase = SNAPSHOT_STEP;
    } else if (b->processes.at[b->registry.agents[host].process].kind == PROCESS_BROKER) {
        snapshots_tell(b, c, place, muster_TRIP_STORED, "");
    } else {
        snapshots_send(b, c);
    }
}

/* Outside, a clone or an agent that is launched goes to its host in pieces. */
static void new_take(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step)
{
    uint32_t asker = registry_find(&b->registry, trip->asker);
    if (asker == MU_NONE || b->registry.agents[asker].process != place ||
        registry_objection(trip->agent, muster_KIND_ROBOT)) {
        b->counters.malformed++;
        return;
    }
    const char *wrong = scope_refuses_move(scope_of_word(true), scope_of_word(in_step));
    struct snapshot *c = deposit_keep(b, place, trip, MU_NONE, wrong);
    if (c) {
        c->asker = asker;
        c->phase = SNAPSHOT_STEP;
    }
}

/* @return whether an agent that moves has its name where it set out from */
static bool is_at_home(const struct broker *b, const struct snapshot *c)
{
    const struct agent *a = &b->registry.agents[c->agent];
    return a->process != MU_NONE && strcmp(b->processes.at[a->process].name, c->home) == 0;
}

/* The agent is at its host from now on. */
static void seat_take(struct broker *b, struct snapshot *c, struct claim *to)
{
    const struct agent *host = &b->registry.agents[c->host];
    bool free = b->registry.agents[to->agent].process == MU_NONE;
    to->process = c->target;
    to->presence.pid = host->is.pid;
    (void)mu_text_copy(to->presence.host, sizeof to->presence.host, host->name);
    (free ? lifecycle_seat : lifecycle_move)(b, to);
    b->registry.agents[to->agent].report = REPORT_AWAITED;
    b->snapshots.taken++;
    b->snapshots.holding--;
    c->seated = true;
    snapshots_tell(b, c, c->source, muster_TRIP_TAKEN, "");
    snapshots_tell(b, c, b->steps.simulator, muster_TRIP_TAKEN, "");
    c->phase = SNAPSHOT_KEPT;
}

static void seat_refuse(struct broker *b, struct snapshot *c, const char *reason)
{
    snapshots_refuse_copy(b, c->target, MU_NONE, c->name, c->epoch, reason);
    snapshots_refuse(b, c, reason);
    if (c->phase != SNAPSHOT_FREE) {
        snapshots_drop(b, c); /* the agent goes on as another process has it */
    }
}

/* The name goes from one process of a run to another, at once.  The one that it set out from
 * may have died meanwhile, and have a successor. */
static void seat_moved(struct broker *b, struct snapshot *c, uint32_t slot)
{
    const struct agent *a = &b->registry.agents[c->agent];
    bool free = a->process == MU_NONE;
    if (!free && !is_at_home(b, c)) {
        seat_refuse(b, c, "gone");
        return;
    }
    struct claim to = {.agent = c->agent, .slot = slot, .presence = a->is};
    to.presence.epoch = c->epoch;
    to.presence.state = free ? c->state : a->is.state;
    seat_take(b, c, &to);
}

static bool name_is_taken(const struct broker *b, const char *name)
{
    uint32_t agent = registry_find(&b->registry, name);
    return agent != MU_NONE && b->registry.agents[agent].process != MU_NONE;
}

/* A name is entered with its first process. */
static void seat_new(struct broker *b, struct snapshot *c, uint32_t slot)
{
    uint32_t agent = registry_find(&b->registry, c->name);
    const char *wrong = name_is_taken(b, c->name) ? "name-taken" : NULL;
    agent = agent != MU_NONE ? agent : registry_add(&b->registry, c->name);
    wrong = agent == MU_NONE ? "pages-full" : wrong;
    if (wrong) {
        seat_refuse(b, c, wrong);
        return;
    }
    struct claim to = {.agent = agent,
                       .slot = slot,
                       .presence = {.kind = muster_KIND_ROBOT,
                                    .state = c->state,
                                    .since_wall_ns = clock_wall_ns(&b->clock)}};
    seat_take(b, c, &to);
    snapshots_drop(b, c);
}

static void seat(struct broker *b, struct snapshot *c, uint32_t slot)
{
    if (c->agent == MU_NONE) {
        seat_new(b, c, slot);
    } else {
        seat_moved(b, c, slot);
    }
    step_release(b);
}

static void ready_take(struct broker *b, uint32_t place, const muster_Trip *trip)
{
    struct snapshot *c = snapshots_answered_by(b, place, trip);
    if (!c) {
        snapshots_refuse_copy(b, place, MU_NONE, trip->agent, trip->epoch, "too-late");
    } else if (c->phase == SNAPSHOT_HOLDS) {
        seat(b, c, trip->slot);
    } else {
        c->phase = SNAPSHOT_KEPT;
        snapshots_tell(b, c, c->source, muster_TRIP_READY, "");
    }
}

static void refusal_take(struct broker *b, uint32_t place, const muster_Trip *trip)
{
    struct snapshot *c = snapshots_answered_by(b, place, trip);
    if (c) {
        snapshots_refuse(b, c, trip->reason);
        step_release(b);
    }
}

/* No agent has its name, and none is about to: a host that has it has been silent for too long.
 */
static bool is_orphan(const struct broker *b, const struct snapshot *c)
{
    const struct agent *a = &b->registry.agents[c->agent];
    uint64_t absent_ns = clock_wall_ns(&b->clock) - a->since_wall_ns;
    bool silent =
        c->phase == SNAPSHOT_SENT && c->source == MU_NONE && c->until_ns <= b->clock.now_ns;
    return (c->phase == SNAPSHOT_KEPT || silent) && a->process == MU_NONE &&
           b->clock.now_ns >= ORPHAN_NS && absent_ns >= ORPHAN_NS;
}

/* An agent of the run goes to a host of the run, when that has been started again. */
static bool is_for(const struct broker *b, const struct snapshot *c, uint32_t host)
{
    return !clock_by_steps(&b->clock) || !c->in_step || b->registry.agents[host].let_go;
}

static void wanted_take(struct broker *b, uint32_t place, const muster_Trip *trip)
{
    uint32_t host = registry_find(&b->registry, trip->host);
    if (objection(b, host, false) || b->registry.agents[host].process != place ||
        scope_is_inside(b->processes.at[place].scope)) {
        return;
    }
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (is_orphan(b, c) && is_for(b, c, host)) {
            c->source = MU_NONE;
            c->host = host;
            b->snapshots.restored++;
            snapshots_send(b, c);
        }
    }
}

void transfer_hear(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step)
{
    switch (trip->word) {
    case muster_TRIP_DEPOSIT: deposit_take(b, place, trip, in_step); return;
    case muster_TRIP_READY: ready_take(b, place, trip); return;
    case muster_TRIP_REFUSED: refusal_take(b, place, trip); return;
    case muster_TRIP_WANTED: wanted_take(b, place, trip); return;
    case muster_TRIP_NEW: new_take(b, place, trip, in_step); return;
    case muster_TRIP_ARRIVE:
    case muster_TRIP_TAKEN:
    case muster_TRIP_STORED: b->counters.malformed++; return;
    }
}

/* --- inside ----------------------------------------------------------------------------------- */

/* @return whether another one of that name has been handed to its host, and has not come to life */
static bool name_is_awaited(const struct broker *b, const char *name)
{
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (c->phase == SNAPSHOT_HOLDS && c->agent == MU_NONE && strcmp(c->name, name) == 0) {
            return true;
        }
    }
    return false;
}

static void snapshot_set_out(struct broker *b, struct snapshot *c)
{
    bool is_new = c->agent == MU_NONE;
    if (!is_new && !is_at_home(b, c)) { /* its process was let go of: this was never said */
        snapshots_drop(b, c);
        return;
    }
    const char *wrong = objection(b, c->host, true);
    bool taken = is_new && (name_is_taken(b, c->name) || name_is_awaited(b, c->name));
    wrong = !wrong && taken ? "name-taken" : wrong;
    if (wrong) {
        snapshots_refuse(b, c, wrong);
        return;
    }
    snapshots_send(b, c);
    c->phase = SNAPSHOT_HOLDS;
    b->snapshots.holding++;
}

static int asker_compare(const void *x, const void *y, const void *broker)
{
    const struct broker *b = broker;
    const struct snapshot *one = *(struct snapshot *const *)x,
                          *other = *(struct snapshot *const *)y;
    int askers = strcmp(b->registry.agents[one->asker].name, b->registry.agents[other->asker].name);
    return askers != 0 ? askers : strcmp(one->name, other->name);
}

/* Which snapshot came first depends on the clock; which agent sets out first does not. */
void transfer_step_ended(struct broker *b)
{
    struct snapshot *order[MU_CAPSULES_MAX];
    uint32_t count = 0;
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (c->phase == SNAPSHOT_STEP) {
            order[count++] = c;
        }
    }
    mu_sort(order, count, sizeof order[0], asker_compare, b);
    for (uint32_t i = 0; i < count; i++) {
        snapshot_set_out(b, order[i]);
    }
    step_release(b);
}

void transfer_run_over(struct broker *b, const char *reason)
{
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (c->phase == SNAPSHOT_STEP || c->phase == SNAPSHOT_HOLDS) {
            snapshots_refuse(b, c, reason);
        }
    }
}

/* --- ends ------------------------------------------------------------------------------------- */

void transfer_tick(struct broker *b)
{
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (c->phase == SNAPSHOT_HOLDS && c->until_ns <= b->clock.now_ns) {
            snapshots_refuse_copy(b, c->target, MU_NONE, c->name, c->epoch, "too-late");
            snapshots_refuse(b, c, "host-silent");
            step_release(b);
        }
    }
}
