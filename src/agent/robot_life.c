/* SPDX-License-Identifier: Apache-2.0 */
/* What a robot lives through: its registration, states and control steps. */
#include "agent/body.h"
#include "agent/robot.h"
#include "core/log.h"

#include <stdio.h>
#include <string.h>

static void pages_enter(const struct robot *r, mu_agent *a)
{
    const struct settings *set = r->crew->set;
    char name[MU_NAME_MAX + 2];
    mu_result done = MU_OK;
    for (size_t i = 0; i < set->groups.count && done == MU_OK; i++) {
        done = mu_agent_group_join(a, set->groups.items[i]);
    }
    for (size_t i = 0; i < set->services.count && done == MU_OK; i++) {
        const char *attributes = settings_service(set->services.items[i], name);
        done = mu_agent_advertise(a, name, attributes, 0);
    }
    if (done != MU_OK) {
        mu_log(MU_LOG_WARNING, "pages-refused", "why=%s", mu_result_text(done));
    }
}

void robot_leave(struct robot *r)
{
    robot_console_end(r);
    r->out = true;
    robot_crew_look(r->crew);
}

void robot_crew_look(struct crew *c)
{
    if (c->host[0] || mu_process_in_lockstep(c->process)) {
        return;
    }
    for (uint32_t i = 0; i < c->count; i++) {
        if (!c->robots[i].out) {
            return;
        }
    }
    mu_process_stop(c->process);
}

/* Who has come goes on where it was interrupted; who does not get its name is not here. */
static void arrive(struct robot *r, bool accepted, const char *reason)
{
    mu_log(accepted ? MU_LOG_INFO : MU_LOG_WARNING, accepted ? "arrived" : "arrival-refused",
           "name=%s %s", r->name, reason);
    if (accepted) {
        mu_agent_set_state(r->agent, r->returns_as);
    }
    r->arrives = false;
    if (r->crew->on_arrived) {
        r->crew->on_arrived(r, accepted, reason);
    }
    if (!accepted) {
        robot_drop(r);
    }
}

/* Who was here before, and has lost its name since, is out of date. */
static void return_refused(struct robot *r, const char *reason)
{
    fprintf(stderr, "muster robot: the broker refuses the name %s: %s\n", r->name, reason);
    r->crew->refused = true;
}

void robot_on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct robot *r = self;
    r->native = r->native && (accepted || r->arrives);
    if (r->arrives) {
        if (!accepted && r->returns && !r->crew->host[0]) {
            return_refused(r, reason);
        }
        arrive(r, accepted, reason);
        return;
    }
    if (accepted) {
        r->out = false;
        mu_log(MU_LOG_INFO, "registered", "name=%s", mu_agent_name(a));
        pages_enter(r, a);
        return;
    }
    fprintf(
        stderr,
        "muster robot: the broker refuses the name %s: %s; muster lookup %s says where that is\n",
        mu_agent_name(a), reason, mu_agent_name(a));
    r->crew->refused = true;
    robot_leave(r);
}

static void on_create(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_CREATE);
}

static void on_run(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_RUN);
}

static void on_arrive(void *self, mu_agent *a)
{
    (void)a;
    struct robot *r = self;
    if (!r->returns) { /* else it depends on whether it has missed anything */
        mind_event(r->mind, MU_ON_ARRIVE);
    }
}

static void on_clone(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_CLONE);
}

/* There is no next step: the rules fire once more, and what they send still goes out. */
static void fire_last(struct robot *r, mu_agent *a, enum mu_event event)
{
    struct mind_act act;
    robot_settle(r);
    mind_event_now(r->mind, event, &act);
    mu_agent_fired_also(a, act.firings, act.rules);
}

static void on_leave(void *self, mu_agent *a)
{
    fire_last(self, a, MU_ON_LEAVE);
}

static void on_dispose(void *self, mu_agent *a)
{
    fire_last(self, a, MU_ON_DISPOSE);
}

static const struct mu_layer_handler robot_handlers[] = {
    {MU_LAYER_SYSTEM, NULL, robot_take_by_rules},
    {MU_LAYER_QUERY, NULL, robot_take_by_rules},
    {MU_LAYER_SPEECH, NULL, robot_take_by_rules},
    {MU_LAYER_QUERY, "facts", robot_take_facts},
    {MU_LAYER_SPEECH, "ask-one", robot_take_question},
    {MU_LAYER_SPEECH, "ask-all", robot_take_question},
    {MU_LAYER_SYSTEM, "dispatch", robot_take_dispatch},
    {MU_LAYER_SYSTEM, "retract", robot_take_dispatch},
    {MU_LAYER_SYSTEM, "clone", robot_take_clone},
    {0, NULL, NULL},
};
const struct mu_agent_kind robot_kind = {.name = "robot",
                                         .handlers = robot_handlers,
                                         .hooks = {[MU_ON_CREATE] = on_create,
                                                   [MU_ON_RUN] = on_run,
                                                   [MU_ON_ARRIVE] = on_arrive,
                                                   [MU_ON_LEAVE] = on_leave,
                                                   [MU_ON_CLONE] = on_clone,
                                                   [MU_ON_DISPOSE] = on_dispose}};

void robot_on_refusal(void *self, mu_agent *a, const char *change, const char *reason)
{
    struct robot *r = self;
    mu_log(MU_LOG_WARNING, "change-refused", "name=%s change=%s reason=%s", mu_agent_name(a),
           change, reason);
    robot_settle(r);
    mind_refused(r->mind, change, reason);
}

void robot_on_return(void *self, mu_agent *a, const char *to, bool directive,
                     enum mu_outcome outcome)
{
    struct robot *r = self;
    if (r->out || mu_agent_state(a) == MU_GONE) {
        return;
    }
    if (directive && outcome == MU_MAIL_REFUSED) {
        mu_log(MU_LOG_WARNING, "directive-refused", "name=%s to=%s", mu_agent_name(a), to);
    }
    robot_settle(r);
    mind_mail_returned(r->mind, directive ? "you-do" : "send", to, mu_outcome_text(outcome));
}

void robot_on_state(void *self, mu_agent *a, enum mu_state state)
{
    struct robot *r = self;
    robot_settle(r);
    r->rules_left = r->arrives ? r->rules_left : 0; /* who arrives goes on where it was */
    if (state == MU_RUNNING && !r->arrives) {
        mind_forgive(r->mind);
        mind_go_on(r->mind);
    }
    mu_log(MU_LOG_INFO, "state", "name=%s state=%s", mu_agent_name(a), mu_state_text(state));
    if (state == MU_GONE && !trip_holds(r)) {
        robot_leave(r);
    }
}

void robot_travel(struct robot *r)
{
    struct mind_travel travel = mind_travel(r->mind);
    if (travel.kind == MIND_DISPOSES) {
        mu_agent_set_state(r->agent, MU_GONE);
    } else if (travel.kind != MIND_STAYS) {
        (void)trip_begin(r, &travel, NULL);
    }
}

/* What it wants, and what has gone on in its mind, goes out with its answer to this step. */
static void mind_hand(struct robot *r, mu_agent *a)
{
    char goal[MU_FIELD_MAX + 1];
    struct mu_text *diary = &r->crew->diary;
    mind_goal(r->mind, goal);
    mu_agent_want(a, goal);
    mu_text_clear(diary);
    mind_diary(r->mind, diary);
    mu_agent_note(a, diary->at);
}

void robot_settle(struct robot *r)
{
    if (!r->percept_waits) {
        return;
    }
    r->percept_waits = false;
    if (r->bodiless) {
        mind_feel_nothing(r->mind, r->percept.time_ns);
    } else {
        mind_percept(r->mind, &r->percept);
    }
}

/* What it did in this step may not have gone out: that is said again.  Else the world may have gone
 * on without it. */
static void robot_return(struct robot *r)
{
    r->returns = false;
    r->repeats = r->step == r->saved_step && r->answer.text;
    if (r->repeats && !answer_repeat(r->agent, &r->answer)) {
        mu_log(MU_LOG_WARNING, "answer-damaged", "name=%s step=%lld", r->name, (long long)r->step);
    } else if (!r->repeats && r->step != r->saved_step + 1) {
        mind_event(r->mind, MU_ON_ARRIVE);
    }
}

/* A suspended mind keeps still, so that a person can look at it.  Who runs acts in this step, too.
 */
static void step_begin(struct robot *r, mu_agent *a, const struct mu_percept *p)
{
    r->step = p->step;
    r->repeats = false;
    r->time_ns = p->time_ns;
    if (r->returns) {
        robot_return(r);
    }
    robot_console_offer(r); /* what happened to one that does not act */
    mind_hand(r, a);
    if (mu_agent_state(a) == MU_SUSPENDED || trip_holds(r) || r->out || r->repeats) {
        return;
    }
    r->percept = *p;
    r->percept_waits = true;
    if (mu_agent_state(a) != MU_RUNNING) {
        robot_settle(r);
    }
}

void robot_on_step(void *self, mu_agent *a, const struct mu_percept *p)
{
    struct robot *r = self;
    r->bodiless = false;
    step_begin(r, a, p);
}

void robot_on_beat(void *self, mu_agent *a, const struct mu_percept *p)
{
    struct robot *r = self;
    r->bodiless = true;
    step_begin(r, a, p);
}

/* The rules do more harm than good: a person has to look at them. */
static void robot_give_up(struct robot *r, mu_agent *a, const char *why)
{
    (void)r;
    mu_log(MU_LOG_WARNING, "suspended", "name=%s why=%s", mu_agent_name(a), why);
    mu_agent_suspend(a, why);
}

/* Stands before a rule, as somebody wanted; the world goes on without it. */
static void robot_break(struct robot *r, mu_agent *a, const char *rule)
{
    char said[MU_FIELD_MAX + 64], why[MU_FIELD_MAX + 1];
    snprintf(said, sizeof said, "break: %s is about to fire; suspended\n", rule);
    snprintf(why, sizeof why, "break: %.55s", rule);
    mu_log(MU_LOG_INFO, "break", "name=%s rule=%s", mu_agent_name(a), rule);
    (void)robot_console_print(r, said);
    mu_agent_suspend(a, why);
}

/* At most so many rules, and then it is suspended. */
static void robot_run(struct robot *r, mu_agent *a, uint32_t rules)
{
    mu_agent_set_state(a, MU_RUNNING);
    r->rules_left = rules;
}

void robot_do_wish(struct robot *r, mu_agent *a)
{
    uint32_t rules;
    enum mind_wish wish = mind_wish(r->mind, &rules);
    enum mu_state state = mu_agent_state(a);
    bool lives = state == MU_STANDBY || state == MU_RUNNING || state == MU_SUSPENDED;
    if (lives && (wish == MIND_WISH_RUN || wish == MIND_WISH_STEP)) {
        robot_run(r, a, wish == MIND_WISH_STEP ? rules : 0);
    } else if (wish == MIND_WISH_SUSPEND && state == MU_RUNNING) {
        mu_agent_suspend(a, "(suspend) was called");
    }
}

void robot_on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)percept;
    struct robot *r = self;
    struct mind_act act;
    uint32_t left = r->rules_left;
    if (r->repeats) {
        return;
    }
    robot_settle(r);
    mind_fire_some(r->mind, left > 0 ? left : UINT32_MAX, &act);
    if (act.end == MIND_STOPPED) {
        mu_log(MU_LOG_WARNING, "rules-stopped", "name=%s guard=%s rules=%s", mu_agent_name(a),
               act.why, act.rules);
    }
    body_act(a, &act);
    body_ask(a, r->mind);
    mu_agent_fired(a, act.firings, act.rules);
    if (robot_mend(r)) {
        mu_agent_fired(a, 0, ""); /* what it did is lost with it */
    } else if (act.enough) {
        robot_give_up(r, a, act.enough);
    } else if (act.end == MIND_BREAK) {
        robot_break(r, a, act.why);
    } else if (left > 0 && act.firings < left) {
        r->rules_left = left - act.firings;
    } else if (left > 0) {
        mu_agent_suspend(a, "as many rules fired as it was told");
    }
    robot_do_wish(r, a);
    robot_travel(r);
    robot_console_offer(r);
    mind_hand(r, a);
}
