/* SPDX-License-Identifier: Apache-2.0 */
/* Carries out at the end of a step what people and programs do to the world. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const int64_t HOLD_WAIT_NS = 5000000;
static const uint64_t HOLD_PATIENCE_NS = 5000000000;

static struct outcome outcome_done(mu_result r, const char *reason)
{
    return r == MU_OK ? commands_outcome(muster_ORDER_DONE, "")
                      : commands_outcome(muster_ORDER_REFUSED, reason ? reason : mu_result_text(r));
}

static const struct outcome *no_name(struct outcome *o, const char *what)
{
    snprintf(o->reason, sizeof o->reason, "the world has no %s of that name", what);
    o->result = muster_ORDER_NO_NAME;
    return o;
}

/* --- what each does; the body is there if it has to be ---------------------------------------- */

static void sensor_undo(struct session *s, const muster_RunCommand *c)
{
    char why[CONDITION_WHY_MAX];
    static char none[1];
    muster_RunCommand back = *c;
    back.on = !c->on;
    back.due_ns = (uint64_t)s->step * s->options.step_ns + (uint64_t)(c->time_s * 1e9);
    back.time_s = 0;
    back.when = none;
    if (order_queue_put(s->orders, &back, why) != MU_OK) {
        mu_log(MU_LOG_WARNING, "undo-lost", "name=%s", c->name);
    }
}

static struct outcome order_place(struct session *s, const muster_RunCommand *c, long body)
{
    const char *reason = NULL;
    struct world_pose pose = {c->x_m, c->y_m, c->heading_rad};
    if (c->keeps_heading) {
        pose.heading_rad = engine_pose(s->engine, (size_t)body).heading_rad;
    }
    mu_result placed = engine_place(s->engine, (size_t)body, pose, &reason);
    return outcome_done(placed, reason);
}

static struct outcome order_push(struct session *s, const muster_RunCommand *c, long body)
{
    const char *reason = NULL;
    struct engine_force force = {c->force_x_n, c->force_y_n, c->torque_nm, c->time_s};
    mu_result pushed = engine_push(s->engine, (size_t)body, &force, &reason);
    return outcome_done(pushed, reason);
}

static struct outcome order_reset(struct session *s, const muster_RunCommand *c, long body)
{
    const char *reason = NULL;
    if (c->name[0] == '\0') {
        engine_reset_all(s->engine);
        for (size_t i = 0; i < s->robot_count; i++) {
            s->robots[i].off = 0;
        }
        return outcome_done(MU_OK, NULL);
    }
    mu_result reset = engine_reset(s->engine, (size_t)body, &reason);
    if (reset == MU_OK && (size_t)body < s->robot_count) {
        s->robots[body].off = 0;
    }
    return outcome_done(reset, reason);
}

static struct outcome order_sensor(struct session *s, const muster_RunCommand *c, long body)
{
    struct outcome o = {.result = muster_ORDER_DONE};
    if ((size_t)body >= s->robot_count) {
        return *no_name(&o, "robot");
    }
    uint32_t *off = &s->robots[body].off;
    *off = c->on ? *off & ~c->senses : *off | c->senses;
    if (c->time_s > 0) {
        sensor_undo(s, c);
    }
    return o;
}

static struct outcome order_save(struct session *s, const muster_RunCommand *c, long body)
{
    (void)body;
    engine_save(s->engine, s->snapshot);
    size_t size = engine_save_size(s->engine);
    struct outcome o = {.result = muster_ORDER_DONE};
    if (snapshot_file_write(s->options.saves, c->file, s->snapshot, size) != MU_OK) {
        bool leads_out = errno == EXDEV || errno == ELOOP;
        o.result = muster_ORDER_NOT_WRITTEN;
        snprintf(o.reason, sizeof o.reason, "%s: %.180s",
                 leads_out ? "it leads out of the run's folder" : strerror(errno), c->file);
    }
    return o;
}

/* The answer goes out before the pause: its receiver acts, and then says RUN_GO. */
static struct outcome order_hold(struct session *s, const muster_RunCommand *c, long body)
{
    (void)s;
    (void)c;
    (void)body;
    return commands_outcome(muster_ORDER_DONE, "");
}

static const struct {
    struct outcome (*run)(struct session *s, const muster_RunCommand *c, long body);
    bool needs_body; /* otherwise an empty name stands for all bodies, or for none */
    bool changes;    /* it changes the world, and so the hash of the run */
} order_table[] = {
    [muster_RUN_PLACE] = {order_place, true, true},
    [muster_RUN_PUSH] = {order_push, true, true},
    [muster_RUN_RESET] = {order_reset, false, true},
    [muster_RUN_SENSOR] = {order_sensor, true, true},
    [muster_RUN_PACE] = {NULL, false, false}, /* commands_take carries it out at once */
    [muster_RUN_SAVE] = {order_save, false, false},
    [muster_RUN_HOLD] = {order_hold, false, false},
};

static struct outcome order_run(struct session *s, const muster_RunCommand *c)
{
    struct outcome o;
    long body = record_find_body(s->world, c->name);
    bool is_meant =
        order_table[c->order].needs_body || (c->order == muster_RUN_RESET && c->name[0] != '\0');
    return is_meant && body < 0 ? *no_name(&o, "robot or object")
                                : order_table[c->order].run(s, c, body);
}

/* --- when its time has come ------------------------------------------------------------------- */

static void body_numbers(const void *self, int body, struct condition_numbers *out)
{
    const struct session *s = self;
    struct world_pose pose = engine_pose(s->engine, (size_t)body);
    *out = (struct condition_numbers){
        .x_m = pose.x_m, .y_m = pose.y_m, .heading_rad = pose.heading_rad};
    if ((size_t)body < s->robot_count) {
        const muster_RobotTotals *totals = &s->totals[body].told;
        const struct tally *t = &s->observe.tallies[body];
        out->distance_m = t->distance_m;
        out->stalls = t->stalls;
        out->stalled_s = t->stalled_s;
        out->mail_sent = (double)totals->mails_sent;
        out->mail_received = (double)totals->mails_received;
        out->rule_firings = (double)totals->firings;
    }
}

static bool robot_stalled(const void *self, int robot)
{
    const struct session *s = self;
    return s->robots[robot].sensed.percept.stalled;
}

static bool robot_counts(const void *self, int robot)
{
    const struct session *s = self;
    return s->agents.at[robot].controlled;
}

/* Finds the orders that are due, and the events of this step. */
static void conditions_look(struct session *s)
{
    uint64_t time_ns = (uint64_t)s->step * s->options.step_ns;
    const struct condition_view view = {.time_s =
                                            (double)s->step * (double)s->options.step_ns * 1e-9,
                                        .self = s,
                                        .numbers = body_numbers,
                                        .stalled = robot_stalled,
                                        .counts = robot_counts,
                                        .robots = (int)s->robot_count};
    if (s->options.events) {
        events_look(s->options.events, time_ns, &view);
    }
    order_queue_look(s->orders, time_ns, &view);
}

/* Waits until the process that asked for the pause says RUN_GO. */
static void order_hold_run(struct session *s)
{
    uint64_t until_ns = mu_clock_ns() + HOLD_PATIENCE_NS;
    (void)phase_on(s, PHASE_PAUSES);
    while (phase_is_paused(s) && mu_clock_ns() < until_ns) {
        bus_wait(s->bus, 1, HOLD_WAIT_NS);
        inbox_take(s);
        (void)status_tell(s, false);
    }
    if (phase_is_paused(s)) {
        (void)phase_on(s, PHASE_RESUMES);
    }
}

void edits_apply(struct session *s)
{
    const muster_RunCommand *c;
    conditions_look(s);
    while ((c = order_queue_take(s->orders))) {
        struct outcome o = order_run(s, c);
        if (o.result == muster_ORDER_DONE && order_table[c->order].changes) {
            run_hash_order(s->hash, c);
        }
        if (o.result == muster_ORDER_DONE) {
            observe_order(s, c);
        }
        commands_answer(s, c, &o);
        if (c->order == muster_RUN_HOLD && !s->options.free) {
            order_hold_run(s);
        }
    }
}
