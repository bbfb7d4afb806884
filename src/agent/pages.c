/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/pages.h"

mu_result pages_change(mu_agent *a, enum mind_change change, const char *name,
                       const char *attributes)
{
    switch (change) {
    case MIND_GROUP_CREATE: return mu_agent_group_create(a, name);
    case MIND_GROUP_JOIN: return mu_agent_group_join(a, name);
    case MIND_GROUP_LEAVE: return mu_agent_group_leave(a, name);
    case MIND_ADVERTISE: return mu_agent_advertise(a, name, attributes, 0);
    case MIND_WITHDRAW: return mu_agent_withdraw(a, name);
    }
    return MU_MALFORMED;
}

const char *pages_entry(const mu_process *p, enum mind_list list, const char *of, size_t index)
{
    const struct mu_service *service;
    switch (list) {
    case MIND_GROUPS: return mu_process_group(p, index);
    case MIND_MEMBERS: return mu_process_group_member(p, of, index);
    case MIND_PROVIDERS:
        service = mu_process_find_service(p, of, index);
        return service ? service->agent : NULL;
    }
    return NULL;
}
