/* SPDX-License-Identifier: Apache-2.0 */
/* How a run begins: who controls which robot, and is everybody there. */
#include "sim/session/session.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/network.h"
#include "core/text.h"
#include "muster/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const int64_t IMPATIENT_NS = 2000000;
static const uint64_t STATUS_PERIOD_NS = 50000000;

static mu_result topics_open(struct session *s)
{
    MU_TRY(bus_writer_open(&s->bus, BUS_ROSTER, NULL, NULL, &s->roster));
    MU_TRY(bus_writer_open(&s->bus, BUS_RUN_STATUS, NULL, NULL, &s->status));
    MU_TRY(bus_writer_open(&s->bus, BUS_RUN_ANSWER, NULL, NULL, &s->answers));
    MU_TRY(bus_reader_open(&s->bus, BUS_REGISTRATION, NULL, &s->registrations));
    MU_TRY(bus_reader_open(&s->bus, BUS_UP, "simulator", &s->ups));
    MU_TRY(bus_reader_open(&s->bus, BUS_DELIVERY, s->name, &s->deliveries));
    MU_TRY(bus_reader_open(&s->bus, BUS_RUN_COMMAND, NULL, &s->commands));
    return MU_OK;
}

mu_result session_open(struct session *s, const struct session_options *options,
                       const struct world *world, struct engine *engine, struct tracks *tracks)
{
    s->options = *options;
    s->world = world;
    s->engine = engine;
    s->tracks = tracks;
    s->hash = run_hash_open();
    s->step = s->sent_step = -1;
    s->mail_step = muster_STEP_NOW;
    snprintf(s->name, sizeof s->name, "simulator.%ld", (long)getpid());
    s->robot_count = world->robot_count;
    s->robots = mu_startup_array(s->robot_count, sizeof *s->robots);
    mu_table_init(&s->robot_names, s->robot_count > 0 ? (uint32_t)s->robot_count : 1);
    mu_table_init(&s->process_names, MU_PROCESSES_MAX);
    for (size_t i = 0; i < s->robot_count; i++) {
        s->robots[i].name = world->robots[i].name;
        (void)mu_table_put(&s->robot_names, s->robots[i].name, (uint32_t)i);
        s->robots[i].controlled = true;
        s->robots[i].process = s->robots[i].next_process = -1;
    }
    s->snapshot = mu_startup_alloc(engine_save_size(engine));
    s->orders = mu_startup_alloc(sizeof *s->orders);
    session_script_open(s);
    s->guests = guests_open();
    s->wanted = mu_startup_array(s->robot_count, sizeof *s->wanted);
    s->processes = mu_startup_array(MU_PROCESSES_MAX, sizeof *s->processes);
    s->percepts = mu_startup_array(s->robot_count, sizeof *s->percepts);
    s->bodies = mu_startup_array(s->robot_count, sizeof *s->bodies);
    s->totals = mu_startup_array(s->robot_count, sizeof *s->totals);
    s->places = mu_startup_array(world->object_count, sizeof *s->places);
    MU_TRY(session_view_open(s));
    return topics_open(s);
}

/* --- who is there ----------------------------------------------------------------------------- */

static struct session_robot *robot_find(struct session *s, const char *name)
{
    uint32_t index = mu_table_find(&s->robot_names, name);
    return index == MU_NONE ? NULL : &s->robots[index];
}

static int32_t process_find(const struct session *s, const char *name)
{
    uint32_t index = mu_table_find(&s->process_names, name);
    return index == MU_NONE ? -1 : (int32_t)index;
}

static int32_t process_add(struct session *s, const char *name)
{
    int32_t found = process_find(s, name);
    if (found >= 0 || s->process_count == MU_PROCESSES_MAX) {
        return found;
    }
    struct session_process *p = &s->processes[s->process_count];
    *p = (struct session_process){.answered = -1};
    mu_text_copy(p->name, sizeof p->name, name);
    if (bus_writer_open(&s->bus, BUS_SENSE, name, NULL, &p->sense) != MU_OK) {
        return -1;
    }
    (void)mu_table_put(&s->process_names, p->name, s->process_count);
    return (int32_t)s->process_count++;
}

/* Lays the percepts out so that each process's robots stand together. */
void session_lay_out(struct session *s)
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
        if (p->watches) {
            p->sample.robots._buffer = s->bodies;
            p->sample.robots._length = (uint32_t)s->robot_count;
        }
        p->sample.robots._maximum = p->sample.robots._length;
    }
    for (size_t r = 0; r < s->robot_count; r++) {
        s->bodies[r].robot = s->world->robots[r].name;
    }
}

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
    struct session_robot *robot = robot_find(s, e->name);
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

bool session_onlooks(const muster_Registration *r)
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
    int32_t process = r->part == 0 ? process_find(s, r->process) : -1;
    bool onlooks = session_onlooks(r);
    if (process < 0 && watches && r->part == 0 && !(onlooks && s->step >= 0)) {
        process = process_add(s, r->process);
    }
    if (process >= 0 && watches) {
        s->processes[process].onlooks = onlooks;
    }
    if (process < 0 || s->processes[process].watches == watches) {
        return false;
    }
    s->processes[process].watches = watches;
    return true;
}

/* Where robots may go. */
static void host_take(struct session *s, const muster_Registration *r, enum bus_life life)
{
    int32_t process = process_find(s, r->process);
    for (uint32_t i = 0; life == BUS_DATA && i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        if (e->kind == muster_KIND_HOST && e->state != muster_STATE_ABSENT) {
            process = process < 0 ? process_add(s, r->process) : process;
            if (process >= 0) {
                s->processes[process].hosts = true;
                mu_text_copy(s->processes[process].host, MU_NAME_MAX + 1, e->name);
            }
        }
    }
    if (life != BUS_DATA && process >= 0) {
        s->processes[process].hosts = false;
    }
}

void session_register(struct session *s, const muster_Registration *r, enum bus_life life)
{
    bool changed = watcher_take(s, r, life == BUS_DATA && r->watches);
    host_take(s, r, life);
    if (life == BUS_DATA) {
        for (uint32_t i = 0; i < r->agents._length; i++) {
            changed = entry_take(s, r, i) || changed;
        }
        int32_t process = process_find(s, r->process);
        if (process >= 0) {
            mu_text_copy(s->processes[process].broker, MU_NAME_MAX + 1, r->broker);
        }
        if (process >= 0 && r->part == 0) { /* the others are not written for that */
            s->processes[process].ready = r->ready;
        }
    } else {
        changed = process_leave(s, r, life == BUS_LOST) || changed;
    }
    if (s->step >= 0 && s->options.free && changed) {
        session_lay_out(s); /* the others keep their own robots' percepts */
    }
}

/* Nobody comes to a lock step that goes on; who goes is noted, and may have been slow only. */
static void loss_take(struct session *s, const muster_Registration *r, enum bus_life life)
{
    int32_t process = process_find(s, r->process);
    if (process >= 0 && (life != BUS_DISPOSED || r->part == 0)) {
        s->processes[process].lost = life != BUS_DATA;
    }
}

/* While steps run, the roster is fixed but for those that die and are started again: whoever else
 * does not answer is found by its silence. */
static void registrations_take(struct session *s)
{
    enum bus_life life;
    const muster_Registration *r;
    while ((r = bus_next(&s->registrations, &life))) {
        bool is_broker = life == BUS_DATA && r->is_broker;
        if (is_broker) {
            continue;
        }
        if (s->step < 0 || s->options.free) {
            session_register(s, r, life);
            continue;
        }
        if (s->options.return_ns > 0) {
            session_return_hear(s, r, life);
        } else {
            loss_take(s, r, life);
        }
    }
}

static void commands_take(struct session *s)
{
    enum bus_life life;
    const muster_RunCommand *c;
    while ((c = bus_next(&s->commands, &life))) {
        if (life != BUS_DATA || strcmp(c->simulator, s->name) != 0) {
            continue;
        }
        if (c->order > muster_RUN_END) {
            session_order_take(s, c);
        } else {
            s->go = s->go || c->order == muster_RUN_GO;
            s->end = s->end || c->order == muster_RUN_END;
        }
    }
}

/* The first sample of a writer can come a tenth of a second late, so it is not a step's. */
static void process_greet(struct session_process *p)
{
    if (!p->greeted && bus_writer_reaches(&p->sense, p->name)) {
        muster_Sense hello = {.process = p->name, .step = muster_STEP_NOW};
        p->greeted = bus_write(&p->sense, &hello) == MU_OK;
    }
}

static bool process_is_ready(const struct session *s, int32_t process)
{
    const struct session_process *p = &s->processes[process];
    return p->ready && p->heard && bus_reader_hears(&s->ups, &p->sense, p->name);
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
    return (p->watches || p->hosts) && (broker[0] == '\0' || strcmp(p->broker, broker) == 0);
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
        if (!process_attends(s, p)) {
            continue;
        }
        watchers += p->watches && !p->onlooks;
        hosts += p->hosts;
        if (!process_is_ready(s, (int32_t)i)) {
            mu_text_format(missing, "%s%s", missing->len ? " " : "", p->name);
        }
    }
    missing_add(missing, watchers, s->options.watchers, "resolvers");
    if (s->step < 0) { /* afterwards the run goes on without one that has died */
        missing_add(missing, hosts, s->options.hosts, "hosts");
    }
}

/* Who was disposed of needs nobody. */
static bool robot_lives(const struct session *s, size_t robot)
{
    return s->step < 0 || s->robots[robot].state != muster_STATE_ABSENT;
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

bool session_is_complete(struct session *s)
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

/* @return how many robots have a controller */
static uint32_t totals_fill(struct session *s)
{
    uint32_t totals = 0;
    for (size_t i = 0; i < s->robot_count; i++) {
        const struct session_robot *r = &s->robots[i];
        if (!r->controlled) {
            continue;
        }
        s->totals[totals++] = (muster_RobotTotals){.robot = s->world->robots[i].name,
                                                   .firings = r->firings,
                                                   .mails_sent = r->mails_sent,
                                                   .mails_received = r->mails_received,
                                                   .mails_duplicated = r->mails_duplicated};
    }
    return totals;
}

static uint32_t places_fill(struct session *s)
{
    for (size_t i = 0; i < s->world->object_count; i++) {
        struct world_pose pose = engine_pose(s->engine, s->robot_count + i);
        s->places[i] = (muster_ObjectPlace){.name = s->world->objects[i].name,
                                            .x_m = pose.x_m,
                                            .y_m = pose.y_m,
                                            .heading_rad = pose.heading_rad};
    }
    return (uint32_t)s->world->object_count;
}

bool session_tell(struct session *s, muster_RunState state, bool always)
{
    uint64_t now_ns = mu_clock_ns();
    if (!always && now_ns - s->status_wall_ns < STATUS_PERIOD_NS) {
        return true;
    }
    s->status_wall_ns = now_ns;
    bool done = state == muster_RUN_DONE;
    static char none[] = "none";
    int64_t steps = s->step > 0 ? s->step : 0;
    muster_RunStatus status = {.simulator = s->name,
                               .state = state,
                               .step = steps,
                               .time_ns = (uint64_t)steps * s->options.step_ns,
                               .wall_ns = s->last_step_wall_ns - s->first_step_wall_ns,
                               .duration_ns = s->options.duration_ns,
                               .skipped = s->skipped,
                               .hash = done && !s->options.free ? s->hash_text : none,
                               .waits_for = s->waits_for};
    status.robots._buffer = s->totals;
    status.robots._length = status.robots._maximum = done ? totals_fill(s) : 0;
    status.objects._buffer = s->places;
    status.objects._length = status.objects._maximum = done ? places_fill(s) : 0;
    session_view_status(s, &status);
    return bus_write(&s->status, &status) == MU_OK;
}

/* --- the beginning ---------------------------------------------------------------------------- */

/* Tells the broker which processes make the lock step. */
mu_result session_tell_roster(struct session *s, bool lockstep)
{
    static char *names[MU_PROCESSES_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        const struct session_process *p = &s->processes[i];
        if (!p->let_go && !p->left_out && !(s->held && p->comes)) {
            names[count++] = s->processes[i].name;
        }
    }
    muster_Roster roster = {.simulator = s->name,
                            .broker = (char *)(uintptr_t)broker_of(s), /* nobody writes there */
                            .lockstep = lockstep,
                            .step = s->step + (s->mail_step >= s->step && s->step > 0),
                            .step_ns = s->options.step_ns,
                            .held = s->held};
    roster.processes._buffer = names;
    roster.processes._length = roster.processes._maximum = count;
    return bus_write(&s->roster, &roster);
}

static bool process_has_robots(const struct session *s, uint32_t process)
{
    bool has = session_guests_live_in(s, process);
    for (size_t r = 0; r < s->robot_count; r++) {
        has = has || s->robots[r].process == (int32_t)process ||
              s->robots[r].next_process == (int32_t)process;
    }
    return has;
}

static bool process_is_needed(const struct session *s, uint32_t process)
{
    bool needed = session_guests_live_in(s, process);
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
void session_rest(struct session *s, uint32_t process)
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

void session_leave_out(struct session *s)
{
    bool changed = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        bool answers = !p->lost || p->answered >= s->step;
        bool is_needed = (p->watches && !p->onlooks) || process_is_needed(s, i);
        if (answers || p->left_out || is_needed) {
            continue;
        }
        session_rest(s, i);
        mu_log(MU_LOG_WARNING, "left-out", "process=%s step=%lld", p->name, (long long)s->step);
        p->left_out = changed = true;
        p->sample_pending = false;
        s->answers_missing -= s->answers_missing > 0;
    }
    if (changed && session_tell_roster(s, true) != MU_OK) {
        s->roster_due = true;
    }
}

/* Drops processes that neither control nor watch anything: they came and went before the first
 * step. */
void session_prune(struct session *s)
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

static bool is_over(const struct session *s, const volatile sig_atomic_t *signal_came)
{
    return s->end || *signal_came;
}

mu_result session_gather(struct session *s, const volatile sig_atomic_t *signal_came)
{
    uint64_t began_ns = mu_clock_ns();
    bool ready = false;
    s->go = !s->options.waits_for_go;
    session_view_scene(s);
    while (!ready || !s->go) {
        session_take(s);
        if (is_over(s, signal_came)) {
            return MU_DONE;
        }
        if (bus_writer_matches(&s->roster) == 0 &&
            mu_clock_ns() - began_ns > mu_network_wait_ns(s->options.network)) {
            return MU_TIMEOUT;
        }
        bool was_ready = ready;
        ready = session_is_complete(s);
        (void)session_tell(s, ready ? muster_RUN_READY : muster_RUN_WAITING, ready != was_ready);
        bus_wait(&s->bus, 1, IMPATIENT_NS);
    }
    session_prune(s);
    session_lay_out(s);
    s->step = 0;
    s->first_step_wall_ns = s->last_step_wall_ns = s->pace_wall_ns = mu_clock_ns();
    mu_log(MU_LOG_INFO, "run-begins", "robots=%zu processes=%u lockstep=%d", s->robot_count,
           s->process_count, !s->options.free);
    mu_result told = session_tell_roster(s, !s->options.free);
    return told < 0 ? told : MU_OK;
}

/* --- what comes in ---------------------------------------------------------------------------- */

/* An order that a gripper does not know is none. */
static int32_t order_of(int32_t order)
{
    return order >= -1 && order <= 1 ? order : 0;
}

static void act_take(struct session *s, const muster_Act *act, int32_t process)
{
    struct session_robot *r = robot_find(s, act->agent);
    if (!r || !r->controlled) {
        session_guest_act(s, act, process);
        return;
    }
    if (r->process != process) {
        return;
    }
    bool is_speed = isfinite(act->forward_m_s) && isfinite(act->turn_rad_s);
    if (act->drives && !is_speed) {
        mu_log(MU_LOG_WARNING, "speed-refused", "robot=%s step=%lld", r->name, (long long)s->step);
    }
    r->drives = act->drives && is_speed;
    if (r->drives) {
        r->forward_m_s = act->forward_m_s;
        r->turn_rad_s = act->turn_rad_s;
    }
    r->paddles = order_of(act->paddles);
    r->lift = order_of(act->lift);
    r->senses = act->senses;
    r->state = act->state;
    mu_text_copy(r->goal, sizeof r->goal, act->goal);
    r->firings += act->firings;
    r->mails_sent += act->mails._length;
    run_hash_act(s->hash, act, r->digest);
    session_script_act(s, (size_t)(r - s->robots), act);
    session_view_act(s, (size_t)(r - s->robots), act);
}

/* Free running: mail goes out at once, and is nothing but something to look at. */
static void up_show(struct session *s, const muster_Up *up, int32_t process)
{
    for (uint32_t i = 0; i < up->acts._length; i++) {
        struct session_robot *r = robot_find(s, up->acts._buffer[i].agent);
        if (r && r->process >= 0 && r->process == process) {
            session_script_act(s, (size_t)(r - s->robots), &up->acts._buffer[i]);
            session_view_act(s, (size_t)(r - s->robots), &up->acts._buffer[i]);
        }
    }
}

static void up_take(struct session *s, const muster_Up *up)
{
    int32_t process = process_find(s, up->process);
    if (s->options.free && up->step == muster_STEP_NOW) {
        up_show(s, up, process);
    }
    if (process >= 0) {
        s->processes[process].heard = true;
    }
    bool is_answer = up->step == s->step || (s->options.free && up->step >= 0);
    if (process < 0 || !is_answer || s->processes[process].answered >= up->step) {
        return;
    }
    struct session_process *p = &s->processes[process];
    p->answered = up->step;
    p->answered_wall_ns = mu_clock_ns();
    if (s->answers_missing > 0 && up->step == s->step) {
        s->answers_missing--;
    }
    s->moves = s->moves || (up->trips._length > 0 && !s->options.free);
    for (uint32_t i = 0; i < up->acts._length; i++) {
        act_take(s, &up->acts._buffer[i], process);
    }
    for (uint32_t i = 0; i < up->acks._length; i++) {
        struct session_robot *r = robot_find(s, up->acks._buffer[i].box);
        if (r) {
            const muster_Ack *ack = &up->acks._buffer[i];
            r->mails_received = r->returned ? ack->number : ack->handed;
            r->mails_duplicated = ack->handed > ack->number ? ack->handed - ack->number : 0;
        }
    }
}

/* The broker has given a name to a process: that of a robot to another one, whose answers may be on
 * their way yet; or a new one, for whom there may be a body that nobody has any more. */
static void trip_take(struct session *s, const muster_Trip *t)
{
    struct session_robot *r = robot_find(s, t->agent);
    int32_t process = process_find(s, t->process);
    if (t->word != muster_TRIP_TAKEN || s->options.free || process < 0) {
        return;
    }
    if (!r || !r->controlled) {
        session_guest_seat(s, t->agent, process);
    } else if (s->processes[process].let_go) { /* it has died since */
        r->process = r->next_process = -1;
    } else if (r->process < 0) { /* the one that it set out from has died */
        r->process = process;
    } else {
        r->next_process = process;
    }
}

void session_change_processes(struct session *s)
{
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_robot *r = &s->robots[i];
        r->process = r->next_process >= 0 ? r->next_process : r->process;
        r->next_process = -1;
    }
    guests_settle(s->guests);
    session_lay_out(s);
}

static void delivery_take(struct session *s, const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->trips._length; i++) {
        trip_take(s, &d->trips._buffer[i]);
    }
    if (d->step == muster_STEP_NOW || d->step <= s->mail_step) {
        return;
    }
    s->mail_step = d->step;
    session_view_outside(s, d);
    run_hash_outside(s->hash, d->outside._buffer, d->outside._length, s->outside[d->step & 1]);
}

void session_take(struct session *s)
{
    enum bus_life life;
    const muster_Up *up;
    while ((up = bus_next(&s->ups, &life))) {
        if (life == BUS_DATA) {
            up_take(s, up);
        }
    }
    const muster_Delivery *delivery;
    while ((delivery = bus_next(&s->deliveries, &life))) {
        if (life == BUS_DATA) {
            delivery_take(s, delivery);
        }
    }
    registrations_take(s);
    commands_take(s);
}
