/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A robot enters its process: it begins there, comes back, or arrives from elsewhere.  If its rules
 * resolve addresses, the broker hears of that.
 */
#include "agent/robot.h"
#include "core/address.h"
#include "core/log.h"
#include "runtime/returns.h"

#include <stdio.h>

/* The handlers of the program, with this robot as their self. */
static struct mu_handlers handlers_of(struct robot *r)
{
    struct mu_handlers handlers = r->group->program->handlers;
    handlers.self = r;
    return handlers;
}

/* Asks the rules for which agents an address stands. */
static bool resolve_by_rules(void *self, mu_agent *a, const char *rest, const char *sender,
                             mu_resolution *r)
{
    struct robot *robot = self;
    struct mu_text names = mu_text_in(robot->group->quoted, sizeof robot->group->quoted);
    percept_settle(robot);
    if (!mind_resolve(robot->mind, rest, sender, &names)) {
        return false;
    }
    bool whole = !names.cut;
    char name[MU_NAME_MAX + 1];
    const char *list = names.at;
    while (mu_address_next(&list, name)) {
        whole = mu_resolution_add(r, name) == MU_OK && whole;
    }
    if (!whole) {
        mu_log(MU_LOG_WARNING, "too-many", "name=%s address=%s", mu_agent_name(a), rest);
    }
    return true;
}

mu_result join_resolve(struct robot *r)
{
    const char *scheme = mind_scheme(r->mind);
    return scheme[0] && r->agent ? mu_agent_resolve(r->agent, scheme, resolve_by_rules, r) : MU_OK;
}

static void robot_begin(struct robot *r)
{
    mu_agent_be(r->agent, r->group->program->kind);
    probes_answer(r->agent, console_look);
    returns_hear(r->agent, r->group->program->on_return);
    percept_ask(r->agent, r->mind);
    mu_result offered = join_resolve(r); /* it has no name yet, so that nothing goes out */
    MU_ASSERT(offered == MU_OK);
}

mu_result agent_join(struct robot *r)
{
    if (r->state == ROBOT_RESTORED) {
        return agent_arrive(r, &r->passage, MU_ON_ARRIVE);
    }
    struct mu_handlers handlers = handlers_of(r);
    mu_process *p = r->group->process;
    mu_result joined = mu_agent_join(p, &r->agent, r->name, r->kind, 0, &handlers);
    if (joined != MU_OK) {
        fprintf(stderr, "%s: %s\n", r->name, mu_result_text(joined));
        return joined < 0 ? joined : MU_FAULT_USAGE;
    }
    robot_begin(r);
    if (r->group->set->standby) {
        mu_agent_set_state(r->agent, MU_STANDBY);
    }
    return MU_OK;
}

mu_result agent_arrive(struct robot *r, const struct mu_passage *from, enum mu_event event)
{
    struct mu_handlers handlers = handlers_of(r);
    mu_result joined =
        mu_agent_arrive(r->group->process, &r->agent, r->name, from, event, &handlers);
    if (joined != MU_OK) {
        return joined;
    }
    robot_state_enter(&r->state, ROBOT_ASKS);
    robot_begin(r);
    return MU_OK;
}
