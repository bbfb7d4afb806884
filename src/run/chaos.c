/* SPDX-License-Identifier: Apache-2.0 */
#include "run/chaos.h"

#include "bus/traffic.h"
#include "core/clock.h"
#include "core/paths.h"
#include "core/sensors.h"
#include "core/text.h"
#include "muster/memory.h"
#include "runtime/process.h"
#include "world/condition/condition.h"

#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

enum { PATIENCE_MS = 2000, REASON_MAX = 255 };

/* One piece of chaos while the run lives. */
struct stroke {
    struct report_chaos fate;
    char reason[REASON_MAX + 1];
    uint64_t undo_wall_ns; /* when it is undone; 0: it is not, or by the run's clock */
    bool undone;
};

struct chaos {
    struct bus_reader answers;
    struct stroke strokes[EXPERIMENT_CHAOS_MAX];
    struct report_chaos fates[EXPERIMENT_CHAOS_MAX];
    uint64_t go_seq; /* of the last word to go on */
};

/* --- parts of the run ------------------------------------------------------------------------- */

/* The child that is meant by a robot's name, an agent's, a host's, a resolver's, broker, a broker's
 * name, or simulator. */
static const char *child_of(const struct run *r, const char *part, char name[RUN_CHILD_MAX])
{
    const struct experiment *e = r->experiment;
    int robot = experiment_robot_find(e, part);
    mu_text_copy(name, RUN_CHILD_MAX, part);
    for (unsigned i = 0; robot >= 0 && i < e->crews_count; i++) {
        const struct experiment_crew *crew = &e->crews[i];
        if ((unsigned)robot >= crew->robot && (unsigned)robot < crew->robot + crew->count) {
            const struct experiment_robot *first = &e->robots[crew->robot];
            mu_text_copy(name, RUN_CHILD_MAX, first->host ? first->host : first->name);
        }
    }
    for (unsigned i = 0; robot < 0 && i < run_brokers(r); i++) {
        if (strcmp(run_broker(r, i), part) == 0) {
            run_child_name(r, i, name);
        }
    }
    return name;
}

static void part_add(struct run *r, const char *part)
{
    char child[RUN_CHILD_MAX];
    bool all = strcmp(part, "all") == 0;
    if (!all && run_struck_find(r, child_of(r, part, child)) == 0) {
        MU_ASSERT(r->struck_count + 1 < TRAFFIC_PARTS_MAX); /* two for each of 64 pieces at most */
        r->struck[++r->struck_count] = mu_startup_string(child);
    }
}

/* --- before the run --------------------------------------------------------------------------- */

static int body_find(const void *self, const char *name)
{
    const struct world *w = self;
    for (size_t i = 0; i < w->robot_count; i++) {
        if (strcmp(w->robots[i].name, name) == 0) {
            return (int)i;
        }
    }
    for (size_t i = 0; i < w->object_count; i++) {
        if (strcmp(w->objects[i].name, name) == 0) {
            return (int)(w->robot_count + i);
        }
    }
    return -1;
}

static mu_result condition_check(const struct run *r, const char *text, struct experiment_mark mark,
                                 struct mu_fault *fault)
{
    char why[CONDITION_WHY_MAX];
    struct condition condition;
    const struct condition_names names = {.find = body_find,
                                          .self = r->world,
                                          .robots = (int)r->world->robot_count,
                                          .find_agent = experiment_agent_find,
                                          .agents = r->experiment};
    return condition_read(&condition, text, &names, why) == MU_OK
               ? MU_OK
               : mu_fault_at(fault, r->experiment->file, mark.line, mark.column, "%s", why);
}

/* What the file alone could not tell: whether such things are in the world. */
static mu_result names_check(const struct run *r, struct mu_fault *fault)
{
    const struct experiment *e = r->experiment;
    for (unsigned i = 0; i < e->events_count; i++) {
        MU_TRY(condition_check(r, e->events[i], e->event_marks[i], fault));
    }
    for (unsigned i = 0; i < e->chaos_count; i++) {
        const struct experiment_chaos *c = &e->chaos[i];
        bool body = c->kind == CHAOS_PUSH || c->kind == CHAOS_PLACE;
        if (body && body_find(r->world, c->who) < 0) {
            return mu_fault_at(fault, e->file, c->mark.line, c->mark.column,
                               "no robot or thing '%.80s' in this world", c->who);
        }
        if (c->when) {
            MU_TRY(condition_check(r, c->when, c->mark, fault));
        }
    }
    return MU_OK;
}

mu_result chaos_prepare(struct run *r, struct mu_fault *fault)
{
    const struct experiment *e = r->experiment;
    bool traffic = false;
    mu_result checked = names_check(r, fault);
    checked = checked == MU_OK ? chaos_check(r, fault) : checked;
    if (checked != MU_OK || e->chaos_count == 0) {
        return checked;
    }
    r->chaos = mu_startup_alloc(sizeof *r->chaos);
    for (unsigned i = 0; i < e->chaos_count; i++) {
        if (e->chaos[i].whom) {
            traffic = true;
            part_add(r, e->chaos[i].who);
            part_add(r, e->chaos[i].whom);
        }
    }
    char library[PATH_MAX];
    if (traffic && (!mu_path_program(library, sizeof library, TRAFFIC_LIBRARY) ||
                    traffic_make(&r->traffic, e->seed, library) != MU_OK)) {
        return mu_fault_at(fault, e->file, 0, 0, "the system has no memory to share");
    }
    return MU_OK;
}

mu_result chaos_open(struct run *r)
{
    return r->chaos ? bus_reader_open(&r->process->bus, BUS_RUN_ANSWER, NULL, &r->chaos->answers)
                    : MU_OK;
}

static void order_fill(muster_RunCommand *o, const struct experiment_chaos *c)
{
    o->order = c->kind == CHAOS_PUSH    ? muster_RUN_PUSH
               : c->kind == CHAOS_PLACE ? muster_RUN_PLACE
               : c->kind == CHAOS_BLOCK ? muster_RUN_SENSOR
                                        : muster_RUN_HOLD;
    o->torque_nm = c->torque_nm;
    if (c->kind <= CHAOS_BLOCK) {
        o->name = c->who;
        o->time_s = c->for_s;
    }
    if (c->force) {
        o->force_x_n = c->force->x_m;
        o->force_y_n = c->force->y_m;
    }
    if (c->pose) {
        o->x_m = c->pose->x_m;
        o->y_m = c->pose->y_m;
        o->heading_rad = c->pose->heading_deg * M_PI / 180;
    }
    if (c->sensor) {
        o->senses = mu_sensor_bits(c->sensor);
    }
}

/* Each has a source of its own: an answer tells which it is, and none pushes out another. */
static void source_name(char source[MU_PROCESS_MAX + 1], unsigned index)
{
    snprintf(source, MU_PROCESS_MAX + 1, "chaos.%03u", index);
}

/* @param seq  1: it begins; 2: it ends */
static mu_result order_send(struct run *r, unsigned index, uint64_t seq, uint64_t due_ns)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    char source[MU_PROCESS_MAX + 1];
    static char none[1];
    source_name(source, index);
    muster_RunCommand o = {.simulator = r->simulator,
                           .source = source,
                           .seq = seq,
                           .name = none,
                           .file = none,
                           .due_ns = due_ns,
                           .when = c->when && seq == 1 ? c->when : none};
    order_fill(&o, c);
    return bus_write(&r->command, &o);
}

mu_result chaos_send(struct run *r)
{
    const struct experiment *e = r->experiment;
    for (unsigned i = 0; i < e->chaos_count; i++) {
        uint64_t due_ns = (uint64_t)llround(e->chaos[i].at * 1e9);
        bool at_once = due_ns == 0 && !e->chaos[i].when; /* 0 is none: the first step's end is */
        MU_TRY(order_send(r, i, 1, at_once ? 1 : due_ns));
    }
    if (r->chaos) {
        r->chaos->go_seq = 1; /* that of the word to begin */
    }
    return MU_OK;
}

/* --- what is done to processes and packets ---------------------------------------------------- */

/* A killed process, once more.  It finds its place again; the lock step waits for it. */
static bool part_restart(struct run *r, struct child *child)
{
    supervise_await(&r->children, child, PATIENCE_MS);
    return child->ended && run_start_again(r, child) == MU_OK;
}

/* An agent that begins anew is told to run, as all were at the beginning.  In lock step that is
 * said while the clock stands still, with the step at which it comes, so that it is the same in
 * every run; a run that is done again has it from the recording. */
static void part_wake(struct run *r, const struct child *child, double at_s)
{
    double step_s = r->experiment->step_ms / 1e3;
    if (!r->options.inputs && !run_remembers(r, child)) {
        run_wake(r, child->name, r->options.free ? -1 : at_s + step_s);
    }
}

static bool process_strike(struct run *r, unsigned index)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    double at_s = r->chaos->strokes[index].fate.at_s;
    char name[RUN_CHILD_MAX];
    struct child *child = supervise_find(&r->children, child_of(r, c->who, name));
    switch (c->kind) {
    case CHAOS_KILL:
        /* A process that comes back by itself counts as one that died by accident. */
        child->struck = chaos_restarts(r, index) || !run_restarts(r, child);
        if (child->struck) {
            run_mail_keep(r, name);
        }
        supervise_signal(child, SIGKILL);
        supervise_await(&r->children, child, PATIENCE_MS);
        if (child->ended && c->wall_s > 0 && !r->options.free) {
            part_wake(r, child, at_s);
        }
        return child->ended;
    case CHAOS_RESTART: part_wake(r, child, at_s); return part_restart(r, child);
    case CHAOS_STOP: supervise_signal(child, SIGSTOP); return true;
    case CHAOS_CONTINUE: supervise_signal(child, SIGCONT); return true;
    case CHAOS_NONE:
    case CHAOS_PUSH:
    case CHAOS_PLACE:
    case CHAOS_BLOCK:
    case CHAOS_CUT:
    case CHAOS_LOSE:
    case CHAOS_DELAY: break;
    }
    return false;
}

static void traffic_strike(struct run *r, const struct experiment_chaos *c, bool undo)
{
    char child[RUN_CHILD_MAX];
    double share = undo ? 0 : c->kind == CHAOS_CUT ? 1 : c->share;
    unsigned one = run_struck_find(r, child_of(r, c->who, child));
    bool all = strcmp(c->whom, "all") == 0;
    unsigned other = all ? 0 : run_struck_find(r, child_of(r, c->whom, child));
    unsigned last = all ? r->struck_count : other;
    for (; other <= last; other++) {
        traffic_set(r->traffic, one, other, share, undo ? 0 : c->by_ms);
    }
}

static bool strike(struct run *r, unsigned index)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    if (!c->whom) {
        return process_strike(r, index);
    }
    traffic_strike(r, c, false);
    return true;
}

static void return_of(struct run *r, const struct experiment_chaos *c, struct child *child)
{
    if (!part_restart(r, child)) {
        fprintf(stderr, "muster run: %s does not start again\n", c->who);
    } else if (r->options.free) {
        part_wake(r, child, 0);
    }
}

/* What lasts for a while only. */
static void undo(struct run *r, unsigned index)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    char name[RUN_CHILD_MAX];
    struct child *child = supervise_find(&r->children, child_of(r, c->who, name));
    if (c->whom) {
        traffic_strike(r, c, true);
    } else if (c->kind == CHAOS_STOP) {
        supervise_signal(child, SIGCONT);
    } else if (c->kind == CHAOS_KILL) {
        return_of(r, c, child);
    }
}

/* --- while the run lives ---------------------------------------------------------------------- */

static void go_on(struct run *r)
{
    if (run_go_send(r, ++r->chaos->go_seq) != MU_OK) {
        fprintf(stderr, "muster run: the word to go on is lost\n");
    }
}

/* How long it lasts: by the clock on the wall, or by the run's, for which the simulator holds once
 * more.  In free running they are one. */
static void end_plan(struct run *r, unsigned index)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    struct stroke *s = &r->chaos->strokes[index];
    double wall_s = c->wall_s > 0 ? c->wall_s : r->options.free ? c->for_s : 0;
    if (wall_s > 0) {
        s->undo_wall_ns = mu_clock_ns() + (uint64_t)(wall_s * 1e9);
    } else if (c->for_s > 0) {
        uint64_t due_ns = (uint64_t)llround((s->fate.at_s + c->for_s) * 1e9);
        if (order_send(r, index, 2, due_ns) != MU_OK) {
            fprintf(stderr, "muster run: the end of '%s' is lost\n", c->text);
        }
    }
}

static void begin_take(struct run *r, unsigned index, const muster_RunAnswer *a)
{
    const struct experiment *e = r->experiment;
    struct stroke *s = &r->chaos->strokes[index];
    s->fate.done = a->result == muster_ORDER_DONE;
    s->fate.at_s = (double)a->step * e->step_ms / 1e3;
    mu_text_copy(s->reason, sizeof s->reason, a->reason);
    if (e->chaos[index].kind > CHAOS_BLOCK && s->fate.done) {
        s->fate.done = strike(r, index);
        mu_text_copy(s->reason, sizeof s->reason, s->fate.done ? "" : "it could not be done");
        end_plan(r, index);
        go_on(r);
    }
}

static void answer_take(struct run *r, const muster_RunAnswer *a)
{
    unsigned index;
    if (sscanf(a->source, "chaos.%u", &index) != 1 || index >= r->experiment->chaos_count) {
        return;
    }
    struct stroke *s = &r->chaos->strokes[index];
    bool ours = r->experiment->chaos[index].kind > CHAOS_BLOCK;
    if (!s->fate.done) {
        begin_take(r, index, a);
    } else if (ours && a->seq == 2 && !s->undone) { /* the world undoes its own */
        s->undone = true;
        undo(r, index);
        go_on(r);
    }
}

void chaos_look(struct run *r)
{
    enum bus_life life;
    const muster_RunAnswer *a;
    if (!r->chaos) {
        return;
    }
    while ((a = bus_next(&r->chaos->answers, &life))) {
        if (life == BUS_DATA && strcmp(a->simulator, r->simulator) == 0) {
            answer_take(r, a);
        }
    }
    for (unsigned i = 0; i < r->experiment->chaos_count; i++) {
        struct stroke *s = &r->chaos->strokes[i];
        if (s->undo_wall_ns > 0 && mu_clock_ns() >= s->undo_wall_ns) {
            s->undo_wall_ns = 0;
            undo(r, i);
        }
    }
}

const struct report_chaos *chaos_fates(const struct run *r)
{
    for (unsigned i = 0; r->chaos && i < r->experiment->chaos_count; i++) {
        r->chaos->fates[i] = r->chaos->strokes[i].fate;
        r->chaos->fates[i].reason = r->chaos->strokes[i].reason;
    }
    return r->chaos ? r->chaos->fates : NULL;
}

uint64_t chaos_packets(const struct run *r)
{
    return r->traffic ? traffic_struck(r->traffic) : 0;
}
