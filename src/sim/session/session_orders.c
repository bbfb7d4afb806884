/* SPDX-License-Identifier: Apache-2.0 */
/* What people and programs do to the world while it runs. */
#include "core/clock.h"
#include "core/log.h"
#include "core/text.h"
#include "sim/record/record.h"
#include "sim/session/session.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { REASON_MAX = 255 };

/* What became of an order. */
struct outcome {
    muster_RunOutcome result;
    char reason[REASON_MAX + 1];
};

static struct outcome outcome_of(muster_RunOutcome result, const char *reason)
{
    struct outcome o = {.result = result};
    mu_text_copy(o.reason, sizeof o.reason, reason);
    return o;
}

static struct outcome outcome_done(mu_result r, const char *reason)
{
    return r == MU_OK ? outcome_of(muster_ORDER_DONE, "")
                      : outcome_of(muster_ORDER_REFUSED, reason ? reason : mu_result_text(r));
}

static const struct outcome *no_name(struct outcome *o, const char *what)
{
    snprintf(o->reason, sizeof o->reason, "the world has no %s of that name", what);
    o->result = muster_ORDER_NO_NAME;
    return o;
}

long session_body_find(const struct session *s, const char *name)
{
    for (size_t i = 0; i < s->robot_count; i++) {
        if (strcmp(s->robots[i].name, name) == 0) {
            return (long)i;
        }
    }
    for (size_t i = 0; i < s->world->object_count; i++) {
        if (strcmp(s->world->objects[i].name, name) == 0) {
            return (long)(s->robot_count + i);
        }
    }
    return -1;
}

/* --- what each does; the body is there if it has to be ---------------------------------------- */

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
        session_script_undo(s, c);
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

/* It is answered first: who hears that begins, and says when he is done. */
static struct outcome order_hold(struct session *s, const muster_RunCommand *c, long body)
{
    (void)s;
    (void)c;
    (void)body;
    return outcome_of(muster_ORDER_DONE, "");
}

static const struct {
    struct outcome (*run)(struct session *s, const muster_RunCommand *c, long body);
    const char *word;
    bool needs_body; /* else "" stands for all, or for none */
    bool changes;    /* the world, and with it the run's hash */
} order_table[] = {
    [muster_RUN_PLACE] = {order_place, "place", true, true},
    [muster_RUN_PUSH] = {order_push, "push", true, true},
    [muster_RUN_RESET] = {order_reset, "reset", false, true},
    [muster_RUN_SENSOR] = {order_sensor, "sensor", true, true},
    [muster_RUN_PACE] = {NULL, "pace", false, false}, /* at once: session_order_take */
    [muster_RUN_SAVE] = {order_save, "save", false, false},
    [muster_RUN_HOLD] = {order_hold, "hold", false, false},
};

/* --- taking and answering --------------------------------------------------------------------- */

static void order_answer(struct session *s, const muster_RunCommand *c, const struct outcome *o)
{
    int64_t step = s->step > 0 ? s->step : 0;
    mu_log(MU_LOG_INFO, "order", "step=%lld source=%s sequence=%llu order=%s name=%s result=%d %s",
           (long long)step, c->source, (unsigned long long)c->seq, order_table[c->order].word,
           c->name, (int)o->result, o->reason);
    muster_RunAnswer answer = {.simulator = s->name,
                               .source = c->source,
                               .seq = c->seq,
                               .step = step,
                               .result = o->result,
                               .reason = (char *)(uintptr_t)o->reason}; /* nobody writes there */
    if (bus_write(&s->answers, &answer) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", c->source);
    }
}

static struct outcome order_run(struct session *s, const muster_RunCommand *c)
{
    struct outcome o;
    long body = session_body_find(s, c->name);
    bool is_meant =
        order_table[c->order].needs_body || (c->order == muster_RUN_RESET && c->name[0] != '\0');
    return is_meant && body < 0 ? *no_name(&o, "robot or object")
                                : order_table[c->order].run(s, c, body);
}

/* What paces the run belongs to the clock on the wall, not to a step. */
static struct outcome pace_change(struct session *s, const muster_RunCommand *c)
{
    if (s->options.free) {
        return outcome_of(muster_ORDER_REFUSED, "free running goes by real time");
    }
    if (c->rate < 0) {
        return outcome_of(muster_ORDER_REFUSED, "a rate is not negative");
    }
    s->options.rate = c->rate;
    s->pace_step = s->step > 0 ? s->step : 0;
    s->pace_wall_ns = mu_clock_ns();
    s->paced_anew = true;
    return outcome_of(muster_ORDER_DONE, "");
}

void session_order_refuse(struct session *s, const muster_RunCommand *c, const char *why)
{
    struct outcome o = outcome_of(muster_ORDER_REFUSED, why);
    order_answer(s, c, &o);
}

/* What waits for a time or a condition.  @return whether it is that */
static bool later_take(struct session *s, const muster_RunCommand *c)
{
    char why[CONDITION_WHY_MAX] = "too many orders wait";
    if (c->due_ns == 0 && c->when[0] == '\0') {
        return false;
    }
    if (c->order == muster_RUN_PACE) {
        session_order_refuse(s, c, "the pace goes by the clock on the wall, at once");
    } else if (script_put(s->script, c, why) != MU_OK) {
        session_order_refuse(s, c, why);
    }
    return true;
}

void session_order_take(struct session *s, const muster_RunCommand *c)
{
    struct outcome o = {.result = muster_ORDER_DONE};
    if (later_take(s, c)) {
        return; /* it is answered when its time has come */
    }
    if (c->order == muster_RUN_PACE) {
        o = pace_change(s, c);
    } else if (order_queue_put(s->orders, c) == MU_OK) {
        return; /* it is answered at the end of the step */
    } else {
        o = outcome_of(muster_ORDER_REFUSED, "too many orders in one step");
    }
    order_answer(s, c, &o);
}

void session_orders_apply(struct session *s)
{
    const muster_RunCommand *c;
    session_script_look(s);
    while ((c = order_queue_take(s->orders))) {
        struct outcome o = order_run(s, c);
        if (o.result == muster_ORDER_DONE && order_table[c->order].changes) {
            run_hash_order(s->hash, c);
        }
        if (o.result == muster_ORDER_DONE) {
            session_view_order(s, c);
        }
        order_answer(s, c, &o);
        if (c->order == muster_RUN_HOLD) {
            session_script_hold(s);
        }
    }
}
