/* SPDX-License-Identifier: Apache-2.0 */
/* Who belongs to the run: which process controls which robot, and who watches or hosts. */
#include "sim/session/parts.h"

#include "core/log.h"
#include "core/text.h"

#include <string.h>

struct session_robot *roster_robot(struct session *s, const char *name)
{
    uint32_t index = mu_table_find(&s->robot_names, name);
    return index == MU_NONE ? NULL : &s->robots[index];
}

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
    if (bus_writer_open(&s->bus, BUS_SENSE, name, NULL, &p->sense) != MU_OK) {
        return -1;
    }
    (void)mu_table_put(&s->process_names, p->name, s->process_count);
    return (int32_t)s->process_count++;
}

/* Lays the percepts out so that each process's robots stand together. */
void roster_lay_out(struct session *s)
{
    uint32_t next = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        p->sample = (muster_Sense){.process = p->name, .lockstep = !s->options.free};
        p->sample.robots._buffer = &s->percepts[next];
        for (size_t r = 0; r < s->robot_count; r++) {
            if (s->robots[r].process == (int32_t)i) {
                s->percepts[next++].robot = s->world->robots[r].name;
                p->sample.robots._length++;
            }
        }
        if (p->roles & MEMBER_WATCHES) {
            p->sample.robots._buffer = s->bodies;
            p->sample.robots._length = (uint32_t)s->robot_count;
        }
        p->sample.robots._maximum = p->sample.robots._length;
    }
    for (size_t r = 0; r < s->robot_count; r++) {
        s->bodies[r].robot = s->world->robots[r].name;
    }
}

/* --- who comes and goes ----------------------------------------------------------------------- */

static bool process_holds(const struct session *s, const struct session_robot *robot,
                          const char *process)
{
    return robot->process >= 0 && strcmp(s->processes[robot->process].name, process) == 0;
}

/* One without a body, whose process has died, is there again. */
static void guest_take(struct session *s, const muster_Registration *r, const muster_Entry *e)
{
    struct guest *guest = guests_find(s->guests, e->name);
    if (guest && guest->process < 0 && e->state != muster_STATE_ABSENT) {
        guest->process = process_add(s, r->process);
    }
}

/* @return whether a robot has got or lost its controller */
static bool entry_take(struct session *s, const muster_Registration *r, uint32_t index)
{
    const muster_Entry *e = &r->agents._buffer[index];
    uint32_t slot = r->part * MU_PART_AGENTS + index;
    struct session_robot *robot = roster_robot(s, e->name);
    if (!robot || !robot->controlled) {
        guest_take(s, r, e);
        return false;
    }
    bool holds = process_holds(s, robot, r->process);
    if (e->state == muster_STATE_ABSENT) {
        bool left = holds && robot->slot == slot;
        robot->process = left ? -1 : robot->process;
        return left;
    }
    /* A body that has a controller: another one must wait until that has gone. */
    if (e->kind != muster_KIND_ROBOT || r->watches || (robot->process >= 0 && !holds)) {
        return false;
    }
    robot->process = holds ? robot->process : process_add(s, r->process);
    robot->slot = slot;
    robot->senses = e->senses;
    robot->state = e->state;
    return !holds && robot->process >= 0;
}

/* A part of a process, or (lost) all of it, is no longer there. */
static bool process_leave(struct session *s, const muster_Registration *r, bool lost)
{
    bool changed = false;
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_robot *robot = &s->robots[i];
        if (process_holds(s, robot, r->process) &&
            (lost || robot->slot / MU_PART_AGENTS == r->part)) {
            robot->process = -1;
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

/* Who only looks on is there from the start, or comes too late.
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
    bool changed = ((p->roles & MEMBER_WATCHES) != 0) != watches;
    p->roles &= (unsigned)MEMBER_HOSTS;
    p->roles |= watches ? MEMBER_WATCHES | (onlooks ? MEMBER_ONLOOKS : 0) : 0;
    return changed;
}

/* Where robots may go. */
static void host_take(struct session *s, const muster_Registration *r, enum bus_life life)
{
    int32_t process = roster_process(s, r->process);
    for (uint32_t i = 0; life == BUS_DATA && i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        if (e->kind == muster_KIND_HOST && e->state != muster_STATE_ABSENT) {
            process = process < 0 ? process_add(s, r->process) : process;
            if (process >= 0) {
                s->processes[process].roles |= MEMBER_HOSTS;
                mu_text_copy(s->processes[process].host, MU_NAME_MAX + 1, e->name);
            }
        }
    }
    if (life != BUS_DATA && process >= 0) {
        s->processes[process].roles &= ~(unsigned)MEMBER_HOSTS;
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
        if (process >= 0 && r->part == 0) { /* the others are not written for that */
            unsigned *joined = &s->processes[process].joined;
            *joined = r->ready ? *joined | MEMBER_READY : *joined & ~(unsigned)MEMBER_READY;
        }
    } else {
        changed = process_leave(s, r, life == BUS_LOST) || changed;
    }
    if (phase_has_begun(s) && s->options.free && changed) {
        roster_lay_out(s); /* the others keep their own robots' percepts */
    }
}

/* --- who dies while a lock step goes on ------------------------------------------------------- */

/* @return the process of a robot, of an agent without a body, or of a host of that name; -1 */
static int32_t process_of(const struct session *s, const muster_Entry *e)
{
    uint32_t robot = mu_table_find(&s->robot_names, e->name);
    const struct guest *guest = guests_find(s->guests, e->name);
    int32_t process = robot != MU_NONE ? s->robots[robot].process : guest ? guest->process : -1;
    for (uint32_t i = 0; i < s->process_count && e->kind == muster_KIND_HOST; i++) {
        const struct session_process *p = &s->processes[i];
        process = (p->roles & MEMBER_HOSTS) && strcmp(p->host, e->name) == 0 ? (int32_t)i : process;
    }
    return process;
}

/* A process that is not in the run claims places in it.  A second watcher claims nothing, unless a
 * watcher is lost. */
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

/* --- is everybody there ----------------------------------------------------------------------- */

/* The first sample of a writer can come a tenth of a second late, so it is not a step's. */
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

/* A lock step has one broker, which its Roster is for.  @return its name; "" when no robot is there
 * yet, or in free running: every broker */
static const char *broker_of(const struct session *s)
{
    if (s->options.free) {
        return "";
    }
    const char *broker = s->options.broker;
    for (size_t i = 0; i < s->robot_count && !broker; i++) {
        bool there = s->robots[i].controlled && s->robots[i].process >= 0;
        broker = there ? s->processes[s->robots[i].process].broker : NULL;
    }
    return broker ? broker : "";
}

/* Who watches, or takes in robots, belongs to the run, unless it lives with a broker that does not.
 */
static bool process_attends(const struct session *s, const struct session_process *p)
{
    const char *broker = broker_of(s);
    return p->roles != 0 && (broker[0] == '\0' || strcmp(p->broker, broker) == 0);
}

static void missing_add(struct mu_text *missing, uint32_t count, uint32_t wanted, const char *what)
{
    if (count < wanted) {
        mu_text_format(missing, "%s%u %s", missing->len ? " " : "", (unsigned)(wanted - count),
                       what);
    }
}

/* They are waited for when they have said so; how many are to come is known to whoever has started
 * them. */
static void attendants_await(const struct session *s, struct mu_text *missing)
{
    uint32_t watchers = 0, hosts = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        const struct session_process *p = &s->processes[i];
        if (!process_attends(s, p) || p->state == MEMBER_LEFT_OUT) {
            continue;
        }
        watchers += member_is_needed(p);
        hosts += (p->roles & MEMBER_HOSTS) != 0;
        if (!process_is_ready(s, (int32_t)i)) {
            mu_text_format(missing, "%s%s", missing->len ? " " : "", p->name);
        }
    }
    missing_add(missing, watchers, s->options.watchers, "resolvers");
    if (!phase_has_begun(s)) { /* afterwards the run goes on without one that has died */
        missing_add(missing, hosts, s->options.hosts, "hosts");
    }
}

/* Who was disposed of needs nobody. */
static bool robot_lives(const struct session *s, size_t robot)
{
    return !phase_has_begun(s) || s->robots[robot].state != muster_STATE_ABSENT;
}

static void guests_await(const struct session *s, struct mu_text *missing)
{
    for (uint32_t i = 0; i < s->guests->count; i++) {
        const struct guest *guest = &s->guests->at[i];
        bool there = guest->process >= 0 && process_is_ready(s, guest->process);
        if (!there && guest->state != muster_STATE_ABSENT) {
            mu_text_format(missing, "%s%s", missing->len ? " " : "", guest->name);
        }
    }
}

bool roster_is_complete(struct session *s)
{
    const char *broker = broker_of(s);
    struct mu_text missing;
    mu_text_init(&missing, s->waits_for, sizeof s->waits_for);
    for (uint32_t i = 0; i < s->process_count; i++) {
        process_greet(&s->processes[i]);
    }
    for (size_t i = 0; i < s->robot_count; i++) {
        int32_t process = s->robots[i].process;
        if (!s->robots[i].controlled || !robot_lives(s, i)) {
            continue;
        }
        if (process < 0 || !process_is_ready(s, process)) {
            mu_text_format(&missing, "%s%s", missing.len ? " " : "", s->robots[i].name);
        } else if (broker[0] && strcmp(s->processes[process].broker, broker) != 0) {
            mu_text_format(&missing, "%s%s (its broker is %s, not %s)", missing.len ? " " : "",
                           s->robots[i].name, s->processes[process].broker, broker);
        }
    }
    guests_await(s, &missing);
    attendants_await(s, &missing);
    return missing.len == 0;
}

/* --- who is in the steps ---------------------------------------------------------------------- */

/* Tells the broker which processes make the lock step. */
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
                            .broker = (char *)(uintptr_t)broker_of(s), /* nobody writes there */
                            .lockstep = lockstep,
                            .step = s->step + (s->mail_step >= s->step && s->step > 0),
                            .step_ns = s->options.step_ns,
                            .held = phase_is_held(s)};
    roster.processes._buffer = names;
    roster.processes._length = roster.processes._maximum = count;
    return bus_write(&s->roster, &roster);
}

void roster_seat(struct session *s, const char *name, int32_t process)
{
    if (process >= 0 && guests_seat(s->guests, name, process) != MU_OK) {
        mu_log(MU_LOG_WARNING, "guest-left-out", "name=%s step=%lld", name, (long long)s->step);
    }
}

static bool guests_live_in(const struct session *s, uint32_t process)
{
    bool any = false;
    for (uint32_t i = 0; i < s->guests->count; i++) {
        const struct guest *guest = &s->guests->at[i];
        any = any || (guest->process == (int32_t)process && guest->state != muster_STATE_ABSENT);
    }
    return any;
}

void roster_pass_guests(struct session *s, uint32_t process)
{
    for (uint32_t i = 0; i < s->guests->count; i++) {
        struct guest *guest = &s->guests->at[i];
        if (guest->process == (int32_t)process) {
            memset(guest->digest, 0, sizeof guest->digest);
        }
    }
}

static bool process_has_robots(const struct session *s, uint32_t process)
{
    bool has = guests_live_in(s, process);
    for (size_t r = 0; r < s->robot_count; r++) {
        has = has || s->robots[r].process == (int32_t)process ||
              s->robots[r].next_process == (int32_t)process;
    }
    return has;
}

static bool process_is_needed(const struct session *s, uint32_t process)
{
    bool needed = guests_live_in(s, process);
    for (size_t r = 0; r < s->robot_count; r++) {
        needed = needed || (s->robots[r].process == (int32_t)process && robot_lives(s, r));
    }
    return needed;
}

static bool process_is_used(const struct session *s, uint32_t process)
{
    return process_attends(s, &s->processes[process]) || process_has_robots(s, process);
}

/* What one that was disposed of answers to every step, in the words of its runtime. */
void roster_rest(struct session *s, uint32_t process)
{
    static char none[1];
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_robot *r = &s->robots[i];
        if (r->process == (int32_t)process && r->state == muster_STATE_ABSENT) {
            muster_Act act = {.agent = (char *)(uintptr_t)r->name, /* nobody writes there */
                              .state = muster_STATE_ABSENT,
                              .drives = true,
                              .rules = none};
            run_hash_act(s->hash, &act, r->digest);
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

/* Drops processes that neither control nor watch anything: they came and went before the first
 * step. */
void roster_prune(struct session *s)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        (void)mu_table_remove(&s->process_names, s->processes[i].name);
        if (!process_is_used(s, i)) {
            bus_writer_close(&s->processes[i].sense);
            continue;
        }
        for (size_t r = 0; r < s->robot_count; r++) {
            struct session_robot *robot = &s->robots[r];
            robot->process = robot->process == (int32_t)i ? (int32_t)kept : robot->process;
            robot->next_process =
                robot->next_process == (int32_t)i ? (int32_t)kept : robot->next_process;
        }
        guests_renumber(s->guests, (int32_t)i, (int32_t)kept);
        s->processes[kept] = s->processes[i];
        (void)mu_table_put(&s->process_names, s->processes[kept].name, kept);
        kept++;
    }
    s->process_count = kept;
}

void roster_change_processes(struct session *s)
{
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_robot *r = &s->robots[i];
        r->process = r->next_process >= 0 ? r->next_process : r->process;
        r->next_process = -1;
    }
    guests_settle(s->guests);
    roster_lay_out(s);
}
