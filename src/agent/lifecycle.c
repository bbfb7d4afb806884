/* SPDX-License-Identifier: Apache-2.0 */
/* Registration, states, and wishes of a robot. */
#include "agent/robot.h"
#include "core/log.h"

#include <stdio.h>

static void pages_enter(const struct robot *r, mu_agent *a)
{
    const struct robot_options *set = r->group->set;
    char name[MU_NAME_MAX + 2];
    mu_result done = MU_OK;
    for (size_t i = 0; i < set->groups.count && done == MU_OK; i++) {
        done = mu_agent_group_join(a, set->groups.items[i]);
    }
    for (size_t i = 0; i < set->services.count && done == MU_OK; i++) {
        const char *attributes = options_service(set->services.items[i], name);
        done = mu_agent_advertise(a, name, attributes, 0);
    }
    if (done != MU_OK) {
        mu_log(MU_LOG_WARNING, "pages-refused", "why=%s", mu_result_text(done));
    }
}

/* An accepted robot goes on where it was interrupted; a refused one leaves. */
static void arrive(struct robot *r, bool accepted, const char *reason)
{
    mu_log(accepted ? MU_LOG_INFO : MU_LOG_WARNING, accepted ? "arrived" : "arrival-refused",
           "name=%s %s", r->name, reason);
    if (accepted) {
        robot_state_enter(&r->state, ROBOT_IS_NAMED); /* on_arrive asks for it */
        mu_agent_set_state(r->agent, r->returns_as);
    }
    if (r->group->on_arrived) {
        r->group->on_arrived(r, accepted, reason);
    }
    if (!accepted) {
        group_process_drop(r);
    }
}

/* A robot that lost its name while it was away is out of date. */
static void return_refused(struct robot *r, const char *reason)
{
    fprintf(stderr, "muster %s: the broker refuses the name %s: %s\n", mu_kind_text(r->kind),
            r->name, reason);
    r->group->refused = true;
}

void lifecycle_on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct robot *r = self;
    if (robot_state_arrives(r->state)) {
        if (!accepted && r->state == ROBOT_RETURNS && !r->group->host[0]) {
            return_refused(r, reason);
        }
        arrive(r, accepted, reason);
        return;
    }
    if (accepted) {
        robot_state_enter(&r->state, ROBOT_IS_NAMED);
        mu_log(MU_LOG_INFO, "registered", "name=%s", mu_agent_name(a));
        pages_enter(r, a);
        return;
    }
    fprintf(stderr,
            "muster %s: the broker refuses the name %s: %s; muster lookup %s says where that is\n",
            mu_kind_text(r->kind), mu_agent_name(a), reason, mu_agent_name(a));
    r->group->refused = true;
    checkpoint_set_native(r, false); /* another agent has its name, so that no mark stays */
    group_process_leave(r);
}

void lifecycle_on_refusal(void *self, mu_agent *a, const char *change, const char *reason)
{
    struct robot *r = self;
    mu_log(MU_LOG_WARNING, "change-refused", "name=%s change=%s reason=%s", mu_agent_name(a),
           change, reason);
    percept_settle(r);
    mind_refused(r->mind, change, reason);
}

void lifecycle_on_return(void *self, mu_agent *a, const char *to, bool directive,
                         enum mu_outcome outcome)
{
    struct robot *r = self;
    if (r->state == ROBOT_VACANT || mu_agent_state(a) == MU_GONE) {
        return;
    }
    if (directive && outcome == MU_MAIL_REFUSED) {
        mu_log(MU_LOG_WARNING, "directive-refused", "name=%s to=%s", mu_agent_name(a), to);
    }
    percept_settle(r);
    mind_mail_returned(r->mind, directive ? "you-do" : "send", to, mu_outcome_text(outcome));
}

void lifecycle_on_state(void *self, mu_agent *a, enum mu_state state)
{
    struct robot *r = self;
    percept_settle(r);
    bool arrives = robot_state_arrives(r->state); /* it goes on where it was */
    r->rules_left = arrives ? r->rules_left : 0;
    if (state == MU_RUNNING && !arrives) {
        mind_forgive(r->mind);
        mind_go_on(r->mind);
    }
    mu_log(MU_LOG_INFO, "state", "name=%s state=%s", mu_agent_name(a), mu_state_text(state));
    if (state == MU_GONE && !agent_is_away(r)) {
        group_process_leave(r);
    }
}

void lifecycle_travel(struct robot *r)
{
    struct mind_travel travel = mind_travel(r->mind);
    if (travel.kind == MIND_DISPOSES) {
        mu_agent_set_state(r->agent, MU_GONE);
    } else if (travel.kind != MIND_STAYS) {
        (void)migration_begin(r, &travel, NULL);
    }
}

/* Runs it for so many rules; then it is suspended.  0: for as many as it wants. */
static void robot_run(struct robot *r, mu_agent *a, uint32_t rules)
{
    mu_agent_set_state(a, MU_RUNNING);
    r->rules_left = rules;
}

void lifecycle_do_wish(struct robot *r, mu_agent *a)
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
