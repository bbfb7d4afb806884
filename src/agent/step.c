/* SPDX-License-Identifier: Apache-2.0 */
/* A robot's control step. */
#include "agent/robot.h"
#include "core/log.h"

#include <stdio.h>

/* Adds its goal and its execution trace to the answer to this step. */
static void mind_hand(struct robot *r, mu_agent *a)
{
    char goal[MU_FIELD_MAX + 1];
    struct mu_text *trace = &r->group->step_trace;
    mind_goal(r->mind, goal);
    mu_agent_want(a, goal);
    mu_text_clear(trace);
    mind_trace(r->mind, trace);
    mu_agent_note(a, trace->at);
}

static void check_whole(const struct robot *r, bool whole)
{
    if (!whole) {
        mu_log(MU_LOG_WARNING, "answer-damaged", "name=%s step=%lld", r->name,
               (long long)r->saved_step);
    }
}

/* The answer to the step of its checkpoint may not have gone out: it is sent again then.
 * @return whether it is */
static bool answer_again(struct robot *r, bool broker_had)
{
    bool again = r->step == r->saved_step && r->answer.text;
    check_whole(r, !again || answer_repeat(r->agent, &r->answer, broker_had));
    return again;
}

/* The first step after its checkpoint: the world may have gone on without it.
 * @return whether it says again what it did in this step */
static bool step_again(struct robot *r)
{
    bool again = answer_again(r, false);
    if (!again && r->step != r->saved_step + 1) {
        mind_event(r->mind, MU_ON_ARRIVE);
    }
    return again;
}

/* A robot whose checkpoint has the answer to the step says it again. */
static void robot_say_again(struct robot *r, bool broker_had)
{
    r->step = r->saved_step;
    (void)answer_again(r, broker_had);
    mind_hand(r, r->agent);
}

static void group_say_again(struct group_process *g, enum process_up_due due, int64_t step)
{
    for (uint32_t i = 0; i < g->count; i++) {
        struct robot *r = &g->robots[i];
        if (r->state != ROBOT_RETURNED || r->saved_step != step || r->step == step) {
            continue;
        }
        if (due != UP_WAS_SAID) {
            robot_say_again(r, due == UP_AGAIN_FOR_SIMULATOR);
        } else if (r->answer.text) {
            check_whole(r, answer_recall(r->agent, &r->answer));
        }
    }
}

void step_before_up(void *self, enum process_up_due due, int64_t step)
{
    if (due == UP_DUE) {
        checkpoint_round(self);
    } else {
        group_say_again(self, due, step);
    }
}

/* A suspended mind keeps still, so that a person can look at it.  A running one acts later in the
 * step. */
static void step_begin(struct robot *r, mu_agent *a, const struct mu_percept *p, bool has_body)
{
    r->step = p->step;
    r->time_ns = p->time_ns;
    bool again = r->state == ROBOT_RETURNED && step_again(r);
    bool sits_out =
        r->state == ROBOT_VACANT || mu_agent_state(a) == MU_SUSPENDED || agent_is_away(r);
    enum robot_event event = again ? ROBOT_SAYS_AGAIN : sits_out ? ROBOT_SITS_OUT : ROBOT_FEELS;
    bool acts = event == ROBOT_FEELS && mu_agent_state(a) == MU_RUNNING;
    console_offer(r); /* lines of a robot that does not act */
    if (!acts) {      /* of a thousand minds each that is looked at now would wait for its memory */
        mind_hand(r, a);
    }
    if (!robot_state_apply(&r->state, event)) {
        r->early_steps++;
        mu_log(MU_LOG_INFO, "step-early", "name=%s steps=%u", r->name, r->early_steps);
    } else if (event == ROBOT_FEELS) {
        r->percept = *p;
        r->percept.robot = has_body ? p->robot : NULL;
        if (!acts) {
            percept_settle(r);
        }
    }
}

void step_on_step(void *self, mu_agent *a, const struct mu_percept *p)
{
    step_begin(self, a, p, true);
}

void step_on_tick(void *self, mu_agent *a, const struct mu_percept *p)
{
    step_begin(self, a, p, false);
}

/* Suspends it for a person to look at: its rules fail too often. */
static void robot_give_up(struct robot *r, mu_agent *a, const char *why)
{
    (void)r;
    mu_log(MU_LOG_WARNING, "suspended", "name=%s why=%s", mu_agent_name(a), why);
    mu_agent_suspend(a, why);
}

/* Suspends it before a rule with a breakpoint; the world goes on. */
static void robot_break(struct robot *r, mu_agent *a, const char *rule)
{
    char said[MU_FIELD_MAX + 64], why[MU_FIELD_MAX + 1];
    snprintf(said, sizeof said, "break: %s is about to fire; suspended\n", rule);
    snprintf(why, sizeof why, "break: %.55s", rule);
    mu_log(MU_LOG_INFO, "break", "name=%s rule=%s", mu_agent_name(a), rule);
    (void)console_print(r, said);
    mu_agent_suspend(a, why);
}

/* Hands the rules' orders to the body. */
static void act_hand(mu_agent *a, const struct mind_act *act)
{
    if (act->drives && mu_agent_drive(a, act->forward_m_s, act->turn_rad_s) != MU_OK) {
        mu_log(MU_LOG_WARNING, "speed-refused", "name=%s", mu_agent_name(a));
    }
    if (mu_agent_grip(a, act->paddles, act->lift) != MU_OK) {
        mu_log(MU_LOG_WARNING, "order-refused", "name=%s", mu_agent_name(a));
    }
}

void step_on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)percept;
    struct robot *r = self;
    struct mind_act act;
    uint32_t left = r->rules_left;
    if (r->state == ROBOT_REPEATS) {
        return;
    }
    percept_settle(r);
    mind_fire_some(r->mind, left > 0 ? left : UINT32_MAX, &act);
    if (act.end == MIND_STOPPED) {
        mu_log(MU_LOG_WARNING, "rules-stopped", "name=%s guard=%s rules=%s", mu_agent_name(a),
               act.why, act.rules);
    }
    act_hand(a, &act);
    percept_ask(a, r->mind);
    mu_agent_fired(a, act.firings, act.rules);
    if (robot_mind_mend(r)) {
        mu_agent_fired(a, 0, ""); /* its firings are lost with the mind */
    } else if (act.enough) {
        robot_give_up(r, a, act.enough);
    } else if (act.end == MIND_BREAK) {
        robot_break(r, a, act.why);
    } else if (left > 0 && act.firings < left) {
        r->rules_left = left - act.firings;
    } else if (left > 0) {
        mu_agent_suspend(a, "as many rules fired as it was told");
    }
    lifecycle_do_wish(r, a);
    lifecycle_travel(r);
    console_offer(r);
    mind_hand(r, a);
}
