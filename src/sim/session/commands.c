/* SPDX-License-Identifier: Apache-2.0 */
/* Takes orders from outside, and answers them. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/text.h"

#include <string.h>

struct outcome commands_outcome(muster_RunOutcome result, const char *reason)
{
    struct outcome o = {.result = result};
    mu_text_copy(o.reason, sizeof o.reason, reason);
    return o;
}

long commands_find_body(const struct session *s, const char *name)
{
    for (size_t i = 0; i < s->robot_count; i++) {
        if (strcmp(s->agents.at[i].name, name) == 0) {
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

/* In the log. */
static const char *word_of(muster_RunOrder order)
{
    static const char *const words[] = {
        [muster_RUN_PLACE] = "place",   [muster_RUN_PUSH] = "push", [muster_RUN_RESET] = "reset",
        [muster_RUN_SENSOR] = "sensor", [muster_RUN_PACE] = "pace", [muster_RUN_SAVE] = "save",
        [muster_RUN_HOLD] = "hold"};
    return words[order];
}

void commands_answer(struct session *s, const muster_RunCommand *c, const struct outcome *o)
{
    int64_t step = s->step > 0 ? s->step : 0;
    mu_log(MU_LOG_INFO, "order", "step=%lld source=%s sequence=%llu order=%s name=%s result=%d %s",
           (long long)step, c->source, (unsigned long long)c->seq, word_of(c->order), c->name,
           (int)o->result, o->reason);
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

/* What paces the run belongs to the clock on the wall, not to a step. */
static struct outcome pace_change(struct session *s, const muster_RunCommand *c)
{
    if (s->options.free) {
        return commands_outcome(muster_ORDER_REFUSED, "free running goes by real time");
    }
    if (c->rate < 0) {
        return commands_outcome(muster_ORDER_REFUSED, "a rate is not negative");
    }
    s->options.rate = c->rate;
    s->pace_step = s->step > 0 ? s->step : 0;
    s->pace_wall_ns = mu_clock_ns();
    return commands_outcome(muster_ORDER_DONE, "");
}

void commands_refuse(struct session *s, const muster_RunCommand *c, const char *why)
{
    struct outcome o = commands_outcome(muster_ORDER_REFUSED, why);
    commands_answer(s, c, &o);
}

/* What waits for a time or a condition.  @return whether it is that */
static bool later_take(struct session *s, const muster_RunCommand *c)
{
    char why[CONDITION_WHY_MAX] = "too many orders wait";
    if (c->due_ns == 0 && c->when[0] == '\0') {
        return false;
    }
    if (c->order == muster_RUN_PACE) {
        commands_refuse(s, c, "the pace goes by the clock on the wall, at once");
    } else if (script_put(s->script, c, why) != MU_OK) {
        commands_refuse(s, c, why);
    }
    return true;
}

void commands_take(struct session *s, const muster_RunCommand *c)
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
        o = commands_outcome(muster_ORDER_REFUSED, "too many orders in one step");
    }
    commands_answer(s, c, &o);
}

static int body_find(const void *self, const char *name)
{
    const struct session *s = self;
    return (int)commands_find_body(s, name);
}

void commands_open(struct session *s)
{
    s->body_names =
        (struct condition_names){.find = body_find, .self = s, .robots = (int)s->robot_count};
    s->script = script_open(&s->body_names);
}

void commands_note_act(struct session *s, size_t robot, const muster_Act *act)
{
    script_act(s->script, (int)robot, act);
}
