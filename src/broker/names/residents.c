/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

static struct resident *resident_of(struct registry *r, uint32_t agent)
{
    return &r->agents[agent].resident;
}

static struct mu_links part_links(const struct registry *r)
{
    return MU_LINKS(r->agents, resident.part);
}

static struct mu_links queue_links(const struct registry *r, enum resident_queue queue)
{
    return MU_LINKS(r->agents, resident.links[queue]);
}

void residents_add(struct registry *r, struct processes *p, uint32_t place, uint32_t slot,
                   uint32_t agent)
{
    struct process *at = &p->at[place];
    uint32_t part = slot / MU_PART_AGENTS;
    MU_ASSERT(part < PROCESSES_PARTS);
    *resident_of(r, agent) = (struct resident){.place = place, .slot = slot};
    (void)mu_list_prepend(&at->parts[part], part_links(r), agent);
    at->parts_top = part < at->parts_top ? at->parts_top : part + 1;
    at->agents_count++;
}

static void queue_remove(struct registry *r, struct process *at, enum resident_queue queue,
                         uint32_t agent)
{
    (void)mu_list_remove(&at->queues[queue], queue_links(r, queue), agent);
}

void residents_remove(struct registry *r, struct processes *p, uint32_t agent)
{
    struct resident *t = resident_of(r, agent);
    struct process *at = &p->at[t->place];
    queue_remove(r, at, RESIDENT_READY, agent);
    queue_remove(r, at, RESIDENT_STIRRED, agent);
    (void)mu_list_remove(&at->parts[t->slot / MU_PART_AGENTS], part_links(r), agent);
    at->agents_count--;
}

uint32_t residents_first_of(const struct processes *p, uint32_t place, uint32_t part)
{
    return mu_list_first(&p->at[place].parts[part]);
}

uint32_t residents_next_of(const struct registry *r, uint32_t agent)
{
    return mu_list_next(part_links(r), agent);
}

/* The first agent of the parts from this one on. */
static uint32_t first_from(const struct process *at, uint32_t part)
{
    while (part < at->parts_top && at->parts[part].count == 0) {
        part++;
    }
    return part < at->parts_top ? mu_list_first(&at->parts[part]) : RESIDENTS_NONE;
}

uint32_t residents_first(const struct processes *p, uint32_t place)
{
    return first_from(&p->at[place], 0);
}

uint32_t residents_next(const struct registry *r, const struct processes *p, uint32_t agent)
{
    const struct resident *t = &r->agents[agent].resident;
    uint32_t next = residents_next_of(r, agent);
    return next != RESIDENTS_NONE ? next
                                  : first_from(&p->at[t->place], t->slot / MU_PART_AGENTS + 1);
}

void residents_wake(struct registry *r, struct processes *p, uint32_t agent)
{
    if (r->agents[agent].process == MU_NONE) {
        return;
    }
    uint32_t place = resident_of(r, agent)->place;
    for (int queue = 0; queue < RESIDENT_QUEUES; queue++) {
        (void)mu_list_append(&p->at[place].queues[queue], queue_links(r, queue), agent);
    }
    processes_wake(p, place);
}

uint32_t residents_pop(struct registry *r, struct processes *p, uint32_t place)
{
    struct process *at = &p->at[place];
    uint32_t agent = mu_list_first(&at->queues[RESIDENT_READY]);
    if (agent != RESIDENTS_NONE) {
        queue_remove(r, at, RESIDENT_READY, agent);
        queue_remove(r, at, RESIDENT_STIRRED, agent);
    }
    return agent;
}

void residents_calm(struct registry *r, struct processes *p, uint32_t agent)
{
    queue_remove(r, &p->at[resident_of(r, agent)->place], RESIDENT_STIRRED, agent);
}
