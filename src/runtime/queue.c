/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/queue.h"

#include "runtime/process.h"

static struct mu_links links_of(const struct mu_process *p, enum queue_kind kind)
{
    return MU_LINKS(p->agents, links[kind]);
}

static uint32_t index_of(const struct mu_agent *a)
{
    return (uint32_t)(a - a->process->agents);
}

static struct mu_agent *agent_at(const struct mu_process *p, uint32_t index)
{
    return index != MU_NONE ? &p->agents[index] : NULL;
}

void queue_add(struct mu_agent *a, enum queue_kind kind)
{
    (void)mu_list_append(&a->process->queues[kind], links_of(a->process, kind), index_of(a));
}

void queue_remove(struct mu_agent *a, enum queue_kind kind)
{
    (void)mu_list_remove(&a->process->queues[kind], links_of(a->process, kind), index_of(a));
}

bool queue_has(const struct mu_agent *a, enum queue_kind kind)
{
    return mu_list_has(links_of(a->process, kind), index_of(a));
}

struct mu_agent *queue_first(const struct mu_process *p, enum queue_kind kind)
{
    return agent_at(p, mu_list_first(&p->queues[kind]));
}

struct mu_agent *queue_next(const struct mu_agent *a, enum queue_kind kind)
{
    return agent_at(a->process, mu_list_next(links_of(a->process, kind), index_of(a)));
}
