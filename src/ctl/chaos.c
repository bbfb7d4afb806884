/* SPDX-License-Identifier: Apache-2.0 */
#include "ctl/chaos.h"

#include "bus/traffic.h"
#include "core/clock.h"
#include "core/text.h"
#include "muster/memory.h"
#include "runtime/process.h"
#include "world/condition.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

enum { PATIENCE_MS = 2000, REASON_MAX = 255 };

/* One piece of chaos while the run lives. */
struct stroke {
    struct report_chaos fate;
    char reason[REASON_MAX + 1];
    uint64_t undo_wall_ns; /* 0: nothing is to be undone */
};

struct chaos {
    struct bus_reader answers;
    struct traffic *traffic; /* NULL: nobody's is struck */
    struct stroke strokes[EXPERIMENT_CHAOS_MAX];
    struct report_chaos fates[EXPERIMENT_CHAOS_MAX];
    const char *parts[TRAFFIC_PARTS_MAX]; /* children whose packets may be struck, from 1 on */
    unsigned parts_count;
    uint64_t go_seq; /* of the last word to go on */
};

/* --- parts of the run ------------------------------------------------------------------------- */

/* The child that is meant by a robot's name, a host's, broker, a broker's name, or simulator. */
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

/* @return the number of a child among those whose packets may be struck; 0: it is none of them */
static unsigned part_find(const struct chaos *c, const char *child)
{
    for (unsigned i = 1; i <= c->parts_count; i++) {
        if (strcmp(c->parts[i], child) == 0) {
            return i;
        }
    }
    return 0;
}

static void part_add(struct run *r, const char *part)
{
    char child[RUN_CHILD_MAX];
    struct chaos *c = r->chaos;
    bool all = strcmp(part, "all") == 0;
    if (!all && part_find(c, child_of(r, part, child)) == 0) {
        MU_ASSERT(c->parts_count + 1 < TRAFFIC_PARTS_MAX); /* two for each of 64 pieces at most */
        c->parts[++c->parts_count] = mu_startup_string(child);
    }
}

void chaos_child(const struct run *r, const char *child)
{
    if (r->chaos && r->chaos->traffic) {
        traffic_child(part_find(r->chaos, child));
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
    const struct condition_names names = {
        .find = body_find, .self = r->world, .robots = (int)r->world->robot_count};
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
    if (traffic && traffic_make(&r->chaos->traffic, e->seed) != MU_OK) {
        return mu_fault_at(fault, e->file, 0, 0, "the system has no memory to share");
    }
    return MU_OK;
}

mu_result chaos_open(struct run *r)
{
    return r->chaos ? bus_reader_open(&r->process->bus, BUS_RUN_ANSWER, NULL, &r->chaos->answers)
                    : MU_OK;
}

static uint32_t senses_of(const char *sensor)
{
    return strcmp(sensor, "sonar") == 0       ? MU_SENSE_SONAR
           : strcmp(sensor, "laser") == 0     ? MU_SENSE_LASER
           : strcmp(sensor, "camera") == 0    ? MU_SENSE_CAMERA
           : strcmp(sensor, "fiducials") == 0 ? MU_SENSE_FIDUCIALS
                                              : MU_SENSES;
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
        o->senses = senses_of(c->sensor);
    }
}

/* Each has a source of its own: an answer tells which it is, and none pushes out another. */
static void source_name(char source[MU_PROCESS_MAX + 1], unsigned index)
{
    snprintf(source, MU_PROCESS_MAX + 1, "chaos.%03u", index);
}

mu_result chaos_send(struct run *r)
{
    const struct experiment *e = r->experiment;
    char source[MU_PROCESS_MAX + 1];
    static char none[1];
    for (unsigned i = 0; i < e->chaos_count; i++) {
        const struct experiment_chaos *c = &e->chaos[i];
        source_name(source, i);
        muster_RunCommand o = {.simulator = r->simulator,
                               .source = source,
                               .seq = 1,
                               .name = none,
                               .file = none,
                               .due_ns = (uint64_t)llround(c->at * 1e9),
                               .when = c->when ? c->when : none};
        o.due_ns = o.due_ns > 0 || c->when ? o.due_ns : 1; /* 0: at once, not at the first step */
        order_fill(&o, c);
        MU_TRY(bus_write(&r->command, &o));
    }
    if (r->chaos) {
        r->chaos->go_seq = 1; /* that of the word to begin */
    }
    return MU_OK;
}

/* --- what is done to processes and packets ---------------------------------------------------- */

/* A killed process, once more.  In free running it finds its place again; in lock step somebody
 * waits for a second life of a robot with `on-crash: restart` alone. */
static bool part_restart(struct run *r, struct child *child)
{
    supervise_await(&r->children, child, PATIENCE_MS);
    if (!child->ended || run_start_again(r, child) != MU_OK) {
        return false;
    }
    run_wake(r, child->name);
    return true;
}

static bool process_strike(struct run *r, const struct experiment_chaos *c)
{
    char name[RUN_CHILD_MAX];
    struct child *child = supervise_find(&r->children, child_of(r, c->who, name));
    switch (c->kind) {
    case CHAOS_KILL:
        /* Who comes back by itself has died as if nobody had meant it. */
        child->struck = c->for_s > 0 || !run_restarts(r, child);
        if (child->struck) {
            run_mail_keep(r, name);
        }
        supervise_signal(child, SIGKILL);
        supervise_await(&r->children, child, PATIENCE_MS);
        return child->ended;
    case CHAOS_RESTART: return part_restart(r, child);
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
    unsigned one = part_find(r->chaos, child_of(r, c->who, child));
    bool all = strcmp(c->whom, "all") == 0;
    unsigned other = all ? 0 : part_find(r->chaos, child_of(r, c->whom, child));
    unsigned last = all ? r->chaos->parts_count : other;
    for (; other <= last; other++) {
        traffic_set(r->chaos->traffic, one, other, share, undo ? 0 : c->by_ms);
    }
}

static bool strike(struct run *r, const struct experiment_chaos *c)
{
    if (!c->whom) {
        return process_strike(r, c);
    }
    traffic_strike(r, c, false);
    return true;
}

/* What lasts for a while only. */
static void undo(struct run *r, const struct experiment_chaos *c)
{
    char name[RUN_CHILD_MAX];
    struct child *child = supervise_find(&r->children, child_of(r, c->who, name));
    if (c->whom) {
        traffic_strike(r, c, true);
    } else if (c->kind == CHAOS_STOP) {
        supervise_signal(child, SIGCONT);
    } else if (c->kind == CHAOS_KILL && !part_restart(r, child)) {
        fprintf(stderr, "muster run: %s does not start again\n", c->who);
    }
}

/* --- while the run lives ---------------------------------------------------------------------- */

static void go_on(struct run *r)
{
    static char observer[] = "observer", none[1];
    muster_RunCommand go = {.simulator = r->simulator,
                            .source = observer,
                            .seq = ++r->chaos->go_seq,
                            .order = muster_RUN_GO,
                            .name = none,
                            .file = none,
                            .when = none};
    if (bus_write(&r->command, &go) != MU_OK) {
        fprintf(stderr, "muster run: the word to go on is lost\n");
    }
}

static void answer_take(struct run *r, const muster_RunAnswer *a)
{
    unsigned index;
    const struct experiment *e = r->experiment;
    if (sscanf(a->source, "chaos.%u", &index) != 1 || index >= e->chaos_count) {
        return;
    }
    const struct experiment_chaos *c = &e->chaos[index];
    struct stroke *s = &r->chaos->strokes[index];
    if (s->fate.done) {
        return; /* the end of it is answered, too */
    }
    s->fate.done = a->result == muster_ORDER_DONE;
    s->fate.at_s = (double)a->step * e->step_ms / 1e3;
    mu_text_copy(s->reason, sizeof s->reason, a->reason);
    if (c->kind > CHAOS_BLOCK && s->fate.done) {
        s->fate.done = strike(r, c);
        mu_text_copy(s->reason, sizeof s->reason, s->fate.done ? "" : "it could not be done");
        s->undo_wall_ns = c->for_s > 0 ? mu_clock_ns() + (uint64_t)(c->for_s * 1e9) : 0;
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
            undo(r, &r->experiment->chaos[i]);
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
    return r->chaos && r->chaos->traffic ? traffic_struck(r->chaos->traffic) : 0;
}
