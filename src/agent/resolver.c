/* SPDX-License-Identifier: Apache-2.0 */
/* A robot whose rules resolve addresses: (on-resolve). */
#include "agent/robot.h"
#include "core/address.h"
#include "core/log.h"

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

mu_result resolver_resolve(struct robot *r)
{
    const char *scheme = mind_scheme(r->mind);
    return scheme[0] && r->agent ? mu_agent_resolve(r->agent, scheme, resolve_by_rules, r) : MU_OK;
}
