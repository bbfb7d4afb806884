/* SPDX-License-Identifier: Apache-2.0 */
/* The processes of a run: which of them controls a robot, watches or hosts. */
#include "sim/session/parts.h"

#include "core/log.h"
#include "core/text.h"

#include <string.h>

int32_t roster_process(const struct session *s, const char *name)
{
    uint32_t index = mu_table_find(&s->process_names, name);
    return index == MU_NONE ? -1 : (int32_t)index;
}

static int32_t process_add(struct session *s, const char *name)
{
    int32_t found = roster_process(s, name);
    if (found >= 0 || s->process_count == MU_PROCESSES_MAX) {
        return found;
    }
    struct session_process *p = &s->processes[s->process_count];
    *p = (struct session_process){.state = MEMBER_JOINING, .answered = -1};
    mu_text_copy(p->name, sizeof p->name, name);
    if (bus_writer_open(s->bus, BUS_SENSE, name, NULL, &p->sense) != MU_OK) {
        return -1;
    }
    (void)mu_table_put(&s->process_names, p->name, s->process_count);
    return (int32_t)s->process_count++;
}

void roster_lay_out(struct session *s)
{
    uint32_t next = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        p->sample = (muster_Sense){.process = p->name, .lockstep = !s->options.free};
        p->sample.robots._buffer = &s->percepts[next];
        for (size_t r = 0; r < s->robot_count; r++) {
            if (s->agents.at[r].process == (int32_t)i) {
                s->percepts[next++].robot = s->world->robots[r].name;
                p->sample.robots._length++;
            }
        }
        if (p->sight != MEMBER_HAS_BODIES) {
            p->sample.robots._length = (uint32_t)s->robot_count;
        }
        p->sample.robots._maximum = p->sample.robots._length;
    }
    for (size_t r = 0; r < s->robot_count; r++) {
        s->bodies[0][r].robot = s->bodies[1][r].robot = s->world->robots[r].name;
    }
}

/* --- registrations ---------------------------------------------------------------------------- */

static bool process_holds(const struct session *s, const struct session_agent *agent,
                          const char *process)
{
    return agent->process >= 0 && strcmp(s->processes[agent->process].name, process) == 0;
}

/* Processes are heard in any order: that one has the name before the other one has left it. */
static void heir_hear(struct session_agent *agent, const char *process, uint32_t slot,
                      bool has_name)
{
    if (has_name) {
        mu_text_copy(agent->heir, sizeof agent->heir, process);
        agent->heir_slot = slot;
    } else if (strcmp(agent->heir, process) == 0 && agent->heir_slot == slot) {
        agent->heir[0] = '\0';
    }
}

static void process_pass(struct session *s, struct session_agent *agent)
{
    agent->process = agent->heir[0] != '\0' ? process_add(s, agent->heir) : -1;
    agent->slot = agent->heir_slot;
    agent->heir[0] = '\0';
}

/* @return whether an agent of the run has got or lost its process */
static bool entry_take(struct session *s, const muster_Registration *r, uint32_t index)
{
    const muster_Entry *e = &r->agents._buffer[index];
    uint32_t slot = r->part * MU_PART_AGENTS + index;
    struct session_agent *agent = agents_find(&s->agents, e->name);
    bool is_robot = agent && agent->body >= 0;
    bool steps = phase_has_begun(s) && !s->options.free;
    if (!agent ||
        (!is_robot && steps && (agent->process >= 0 || e->state == muster_STATE_ABSENT))) {
        return false;
    }
    if (!is_robot && steps) { /* its process died, and its successor registers it */
        agent->process = process_add(s, r->process);
        return false;
    }
    bool holds = process_holds(s, agent, r->process);
    bool fits = (!is_robot || e->kind == muster_KIND_ROBOT) && !r->watches;
    bool left = e->state == muster_STATE_ABSENT;
    if (holds && left && agent->slot == slot) {
        process_pass(s, agent);
        return true;
    }
    if (left || !fits || (agent->process >= 0 && !holds)) {
        heir_hear(agent, r->process, slot, fits && !left && !e->newcomer);
        return false;
    }
    agent->process = holds ? agent->process : process_add(s, r->process);
    agent->slot = slot;
    agent->state = e->state;
    if (is_robot) {
        s->robots[agent->body].senses = e->senses;
    }
    return !holds && agent->process >= 0;
}

/* Takes the agents of a part of a process, or of all of it if lost, from it.
 * @return whether there were any */
static bool process_leave(struct session *s, const muster_Registration *r, bool lost)
{
    bool changed = false;
    for (uint32_t i = 0; i < s->agents.count; i++) {
        struct session_agent *agent = &s->agents.at[i];
        bool had_part = agent->body >= 0 || !phase_has_begun(s) || s->options.free;
        bool of_part = had_part && agent->slot / MU_PART_AGENTS == r->part;
        if (lost || agent->heir_slot / MU_PART_AGENTS == r->part) {
            heir_hear(agent, r->process, agent->heir_slot, false);
        }
        if (process_holds(s, agent, r->process) && (lost || of_part)) {
            process_pass(s, agent);
            changed = true;
        }
    }
    return changed;
}

static bool roster_onlooks(const muster_Registration *r)
{
    bool all = r->watches && r->agents._length > 0;
    for (uint32_t i = 0; i < r->agents._length; i++) {
        all = all && r->agents._buffer[i].kind == muster_KIND_SPECIAL;
    }
    return all;
}

/* A process that only looks on must come before the first step.
 * @return whether a process has begun or ceased to watch */
static bool watcher_take(struct session *s, const muster_Registration *r, bool watches)
{
    int32_t process = r->part == 0 ? roster_process(s, r->process) : -1;
    bool onlooks = roster_onlooks(r);
    if (process < 0 && watches && r->part == 0 && !(onlooks && phase_has_begun(s))) {
        process = process_add(s, r->process);
    }
    if (process < 0) {
        return false;
    }
    struct session_process *p = &s->processes[process];
    bool changed = (p->sight != MEMBER_HAS_BODIES) != watches;
    enum member_sight sight = onlooks ? MEMBER_ONLOOKS : MEMBER_WATCHES;
    p->sight = watches ? sight : MEMBER_HAS_BODIES;
    return changed;
}

/* Notes a host, which agents may move to. */
static void host_take(struct session *s, const muster_Registration *r, enum bus_life life)
{
    int32_t process = roster_process(s, r->process);
    for (uint32_t i = 0; life == BUS_DATA && i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        if (e->kind == muster_KIND_HOST && e->state != muster_STATE_ABSENT) {
            process = process < 0 ? process_add(s, r->process) : process;
            if (process >= 0) {
                mu_text_copy(s->processes[process].host, MU_NAME_MAX + 1, e->name);
            }
        }
    }
    if (life != BUS_DATA && process >= 0) {
        s->processes[process].host[0] = '\0';
    }
}

void roster_register(struct session *s, const muster_Registration *r, enum bus_life life)
{
    bool changed = watcher_take(s, r, life == BUS_DATA && r->watches);
    host_take(s, r, life);
    if (life == BUS_DATA) {
        for (uint32_t i = 0; i < r->agents._length; i++) {
            changed = entry_take(s, r, i) || changed;
        }
        int32_t process = roster_process(s, r->process);
        if (process >= 0) {
            mu_text_copy(s->processes[process].broker, MU_NAME_MAX + 1, r->broker);
        }
        if (process >= 0 && r->part == 0) { /* other parts do not report it */
            unsigned *joined = &s->processes[process].joined;
            *joined = r->ready ? *joined | MEMBER_READY : *joined & ~(unsigned)MEMBER_READY;
        }
    } else {
        changed = process_leave(s, r, life == BUS_LOST) || changed;
    }
    if (phase_has_begun(s) && s->options.free && changed) {
        roster_lay_out(s); /* each process keeps the percepts of its own robots */
    }
}

/* --- registrations while a lock step runs ----------------------------------------------------- */

/* @return the index of the process of an agent or of a host of that name; -1: none */
static int32_t process_of(const struct session *s, const muster_Entry *e)
{
    const struct session_agent *agent = agents_find(&s->agents, e->name);
    int32_t process = agent ? agent->process : -1;
    for (uint32_t i = 0; i < s->process_count && e->kind == muster_KIND_HOST; i++) {
        const struct session_process *p = &s->processes[i];
        process = p->host[0] != '\0' && strcmp(p->host, e->name) == 0 ? (int32_t)i : process;
    }
    return process;
}

/* A process from outside the run claims the agents that it registers.  A watcher claims only a lost
 * one: a second resolver is no successor. */
static void claims_take(struct session *s, const muster_Registration *r)
{
    for (uint32_t i = 0; i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        int32_t process = process_of(s, e);
        if (process >= 0 && e->state != muster_STATE_ABSENT) {
            member_claim(&s->processes[process], r->process);
        }
    }
    for (uint32_t i = 0; i < s->process_count && r->watches && !roster_onlooks(r); i++) {
        struct session_process *p = &s->processes[i];
        if (member_is_needed(p) && p->state == MEMBER_LOST) {
            member_claim(p, r->process);
        }
    }
}

static void claims_end(struct session *s, const char *claimer)
{
    for (uint32_t i = 0; i < s->process_count; i++) {
        member_claim_ends(&s->processes[i], claimer);
    }
}

void roster_hear(struct session *s, const muster_Registration *r, enum bus_life life)
{
    int32_t process = roster_process(s, r->process);
    bool joins = process < 0 || s->processes[process].state == MEMBER_JOINING;
    bool leaves = life == BUS_LOST || (life == BUS_DISPOSED && r->part == 0);
    if (leaves) {
        claims_end(s, r->process);
    }
    if (!joins && (leaves || life == BUS_DATA)) {
        (void)member_on(&s->processes[process], leaves ? MEMBER_LOSS : MEMBER_HEARTBEAT);
    }
    if (joins && life == BUS_DATA && s->options.return_ns > 0) {
        claims_take(s, r);
    }
    if (joins && phase_is_held(s)) {
        roster_register(s, r, life);
    }
}

/* --- completeness ----------------------------------------------------------------------------- */

/* The first sample of a writer may arrive 0.1 s late, so an empty one goes ahead of the steps. */
static void process_greet(struct session_process *p)
{
    if (!(p->joined & MEMBER_GREETED) && bus_writer_reaches(&p->sense, p->name)) {
        muster_Sense hello = {.process = p->name, .step = muster_STEP_NOW};
        p->joined |= bus_write(&p->sense, &hello) == MU_OK ? MEMBER_GREETED : 0;
    }
}

static bool process_is_ready(const struct session *s, int32_t process)
{
    const struct session_process *p = &s->processes[process];
    return p->joined == MEMBER_JOINED && bus_reader_hears(&s->ups, &p->sense, p->name);
}

/* @return the one broker of a lock step; "": any, in free running or before an agent registers */
static const char *broker_of(const struct session *s)
{
    if (s->options.free) {
        return "";
    }
    const char *broker = s->options.broker;
    for (size_t i = 0; i < s->agents.count && !broker; i++) {
        int32_t process = s->agents.at[i].process;
        broker = process >= 0 ? s->processes[process].broker : NULL;
    }
    return broker ? broker : "";
}

/* @return whether a process watches or hosts, at the broker of the run */
static bool process_attends(const struct session *s, const struct session_process *p)
{
    const char *broker = broker_of(s);
    return member_attends(p) && (broker[0] == '\0' || strcmp(p->broker, broker) == 0);
}

static void missing_add(struct mu_text *missing, uint32_t count, uint32_t wanted, const char *what)
{
    if (count < wanted) {
        mu_text_format(missing, "%s%u %s", missing->len ? " " : "", (unsigned)(wanted - count),
                       what);
    }
}

/* The run waits for those that have registered, and for as many as the options say. */
static void attendants_await(const struct session *s, struct mu_text *missing)
{
    uint32_t watchers = 0, hosts = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        const struct session_process *p = &s->processes[i];
        if (!process_attends(s, p) || p->state == MEMBER_LEFT_OUT) {
            continue;
        }
        watchers += member_is_needed(p);
        hosts += p->host[0] != '\0';
        if (!process_is_ready(s, (int32_t)i)) {
            mu_text_format(missing, "%s%s", missing->len ? " " : "", p->name);
        }
    }
    missing_add(missing, watchers, s->options.watchers, "resolvers");
    if (!phase_has_begun(s)) { /* later the run goes on without a host that died */
        missing_add(missing, hosts, s->options.hosts, "hosts");
    }
}

/* @return whether an agent needs a process: one that was disposed of does not */
static bool agent_lives(const struct session *s, const struct session_agent *agent)
{
    return agent->controlled && (!phase_has_begun(s) || agent->state != muster_STATE_ABSENT);
}

bool roster_is_complete(struct session *s)
{
    const char *broker = broker_of(s);
    struct mu_text missing = mu_text_in(s->waits_for, sizeof s->waits_for);
    for (uint32_t i = 0; i < s->process_count; i++) {
        process_greet(&s->processes[i]);
    }
    for (uint32_t i = 0; i < s->agents.count; i++) {
        const struct session_agent *agent = &s->agents.at[i];
        int32_t process = agent->process;
        if (!agent_lives(s, agent)) {
            continue;
        }
        if (process < 0 || !process_is_ready(s, process)) {
            mu_text_format(&missing, "%s%s", missing.len ? " " : "", agent->name);
        } else if (broker[0] && strcmp(s->processes[process].broker, broker) != 0) {
            mu_text_format(&missing, "%s%s (its broker is %s, not %s)", missing.len ? " " : "",
                           agent->name, s->processes[process].broker, broker);
        }
    }
    attendants_await(s, &missing);
    return missing.len == 0;
}

/* --- membership in steps ---------------------------------------------------------------------- */

mu_result roster_tell(struct session *s, bool lockstep)
{
    static char *names[MU_PROCESSES_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        const struct session_process *p = &s->processes[i];
        if (member_is_in_steps(p) && !(phase_is_held(s) && p->state == MEMBER_JOINING)) {
            names[count++] = s->processes[i].name;
        }
    }
    muster_Roster roster = {.simulator = s->name,
                            .broker = (char *)(uintptr_t)broker_of(s), /* it is only read */
                            .lockstep = lockstep,
                            .step = s->step + (s->mail_step >= s->step && s->step > 0),
                            .step_ns = s->options.step_ns,
                            .held = phase_is_held(s)};
    roster.processes._buffer = names;
    roster.processes._length = roster.processes._maximum = count;
    return bus_write(&s->roster, &roster);
}

static bool process_is_needed(const struct session *s, uint32_t process)
{
    bool needed = false;
    for (uint32_t i = 0; i < s->agents.count; i++) {
        const struct session_agent *agent = &s->agents.at[i];
        needed = needed || (agent->process == (int32_t)process && agent_lives(s, agent));
    }
    return needed;
}

static bool process_is_used(const struct session *s, uint32_t process)
{
    return process_attends(s, &s->processes[process]) ||
           agents_live_in(&s->agents, (int32_t)process);
}

/* Digests what the runtime answers in each step for an agent that was disposed of. */
void roster_rest(struct session *s, uint32_t process)
{
    static char none[1];
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_agent *agent = &s->agents.at[i];
        if (agent->process == (int32_t)process && agent->state == muster_STATE_ABSENT) {
            muster_Act act = {
                .agent = agent->name, .state = muster_STATE_ABSENT, .drives = true, .rules = none};
            run_hash_act(s->hash, &act, agent->digest);
        }
    }
}

void roster_leave_out(struct session *s)
{
    bool changed = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        bool is_silent = p->state == MEMBER_LOST && p->answered < s->step;
        if (!is_silent || member_is_needed(p) || process_is_needed(s, i)) {
            continue;
        }
        roster_rest(s, i);
        mu_log(MU_LOG_WARNING, "left-out", "process=%s step=%lld", p->name, (long long)s->step);
        (void)member_on(p, MEMBER_LEAVES_OUT);
        changed = true;
        p->sample_pending = false;
        s->answers_missing -= s->answers_missing > 0;
    }
    if (changed && roster_tell(s, true) != MU_OK) {
        s->roster_due = true;
    }
}

void roster_prune(struct session *s)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        (void)mu_table_remove(&s->process_names, s->processes[i].name);
        if (!process_is_used(s, i)) {
            bus_writer_close(&s->processes[i].sense);
            continue;
        }
        agents_renumber(&s->agents, (int32_t)i, (int32_t)kept);
        s->processes[kept] = s->processes[i];
        (void)mu_table_put(&s->process_names, s->processes[kept].name, kept);
        kept++;
    }
    s->process_count = kept;
}

void roster_change_processes(struct session *s)
{
    agents_move_robots(&s->agents);
    agents_settle(&s->agents);
    roster_lay_out(s);
}
