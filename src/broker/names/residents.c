/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

static struct resident *resident_of(struct registry *r, uint32_t agent)
{
    return &r->agents[agent].resident;
}

void residents_add(struct registry *r, struct processes *p, uint32_t place, uint32_t slot,
                   uint32_t agent)
{
    struct process *at = &p->at[place];
    uint32_t part = slot / MU_PART_AGENTS;
    MU_ASSERT(part < PROCESSES_PARTS);
    uint32_t first = at->parts[part];
    *resident_of(r, agent) = (struct resident){.place = place, .slot = slot, .next = first};
    if (first != RESIDENTS_NONE) {
        resident_of(r, first)->prev = agent;
    }
    at->parts[part] = agent;
    at->parts_top = part < at->parts_top ? at->parts_top : part + 1;
    at->agents_count++;
}

static void queue_add(struct registry *r, struct process *at, enum resident_queue queue,
                      uint32_t agent)
{
    struct resident_ends *ends = &at->queues[queue];
    struct resident_link *link = &resident_of(r, agent)->links[queue];
    if (link->queued) {
        return;
    }
    *link = (struct resident_link){.queued = true, .next = RESIDENTS_NONE, .prev = ends->last};
    if (ends->last == RESIDENTS_NONE) {
        ends->first = agent;
    } else {
        resident_of(r, ends->last)->links[queue].next = agent;
    }
    ends->last = agent;
}

static void queue_remove(struct registry *r, struct process *at, enum resident_queue queue,
                         uint32_t agent)
{
    struct resident_ends *ends = &at->queues[queue];
    struct resident_link *link = &resident_of(r, agent)->links[queue];
    if (!link->queued) {
        return;
    }
    if (link->prev == RESIDENTS_NONE) {
        ends->first = link->next;
    } else {
        resident_of(r, link->prev)->links[queue].next = link->next;
    }
    if (link->next == RESIDENTS_NONE) {
        ends->last = link->prev;
    } else {
        resident_of(r, link->next)->links[queue].prev = link->prev;
    }
    link->queued = false;
}

void residents_remove(struct registry *r, struct processes *p, uint32_t agent)
{
    struct resident *t = resident_of(r, agent);
    struct process *at = &p->at[t->place];
    queue_remove(r, at, RESIDENT_READY, agent);
    queue_remove(r, at, RESIDENT_STIRRED, agent);
    if (t->prev == RESIDENTS_NONE) {
        at->parts[t->slot / MU_PART_AGENTS] = t->next;
    } else {
        resident_of(r, t->prev)->next = t->next;
    }
    if (t->next != RESIDENTS_NONE) {
        resident_of(r, t->next)->prev = t->prev;
    }
    at->agents_count--;
}

uint32_t residents_first_of(const struct processes *p, uint32_t place, uint32_t part)
{
    return p->at[place].parts[part];
}

uint32_t residents_next_of(const struct registry *r, uint32_t agent)
{
    return r->agents[agent].resident.next;
}

/* The first agent of the parts from this one on. */
static uint32_t first_from(const struct process *at, uint32_t part)
{
    while (part < at->parts_top && at->parts[part] == RESIDENTS_NONE) {
        part++;
    }
    return part < at->parts_top ? at->parts[part] : (uint32_t)RESIDENTS_NONE;
}

uint32_t residents_first(const struct processes *p, uint32_t place)
{
    return first_from(&p->at[place], 0);
}

uint32_t residents_next(const struct registry *r, const struct processes *p, uint32_t agent)
{
    const struct resident *t = &r->agents[agent].resident;
    return t->next != RESIDENTS_NONE ? t->next
                                     : first_from(&p->at[t->place], t->slot / MU_PART_AGENTS + 1);
}

void residents_wake(struct registry *r, struct processes *p, uint32_t agent)
{
    if (r->agents[agent].process == MU_NONE) {
        return;
    }
    uint32_t place = resident_of(r, agent)->place;
    queue_add(r, &p->at[place], RESIDENT_READY, agent);
    queue_add(r, &p->at[place], RESIDENT_STIRRED, agent);
    processes_wake(p, place);
}

uint32_t residents_pop(struct registry *r, struct processes *p, uint32_t place)
{
    struct process *at = &p->at[place];
    uint32_t agent = at->queues[RESIDENT_READY].first;
    if (agent != RESIDENTS_NONE) {
        queue_remove(r, at, RESIDENT_READY, agent);
        queue_remove(r, at, RESIDENT_STIRRED, agent);
    }
    return agent;
}

uint32_t residents_stirred(const struct processes *p, uint32_t place)
{
    return p->at[place].queues[RESIDENT_STIRRED].first;
}

void residents_calm(struct registry *r, struct processes *p, uint32_t agent)
{
    queue_remove(r, &p->at[resident_of(r, agent)->place], RESIDENT_STIRRED, agent);
}
