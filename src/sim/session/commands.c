/* SPDX-License-Identifier: Apache-2.0 */
/* Takes orders from outside, and answers them. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/text.h"

struct outcome commands_outcome(muster_RunOutcome result, const char *reason)
{
    struct outcome o = {.result = result};
    mu_text_copy(o.reason, sizeof o.reason, reason);
    return o;
}

/* The words of orders in the log. */
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
                               .reason = (char *)(uintptr_t)o->reason}; /* it is only read */
    if (bus_write(&s->answers, &answer) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", c->source);
    }
}

/* The pace follows the wall clock and not a step, so it changes at once. */
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

void commands_take(struct session *s, const muster_RunCommand *c)
{
    char why[CONDITION_WHY_MAX];
    struct outcome o;
    if (c->order != muster_RUN_PACE) {
        if (order_queue_put(s->orders, c, why) == MU_OK) {
            return; /* the answer follows when the order is carried out */
        }
        o = commands_outcome(muster_ORDER_REFUSED, why);
    } else if (c->due_ns > 0 || c->when[0] != '\0') {
        o = commands_outcome(muster_ORDER_REFUSED,
                             "the pace goes by the clock on the wall, at once");
    } else {
        o = pace_change(s, c);
    }
    commands_answer(s, c, &o);
}
