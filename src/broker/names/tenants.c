/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

static struct tenant *tenant_of(struct registry *r, uint32_t agent)
{
    return &r->agents[agent].tenant;
}

void tenants_add(struct registry *r, struct places *p, uint32_t place, uint32_t slot,
                 uint32_t agent)
{
    struct place *at = &p->at[place];
    uint32_t part = slot / MU_PART_AGENTS;
    MU_ASSERT(part < PLACES_PARTS);
    uint32_t first = at->parts[part];
    *tenant_of(r, agent) = (struct tenant){.place = place, .slot = slot, .next = first};
    if (first != TENANTS_NONE) {
        tenant_of(r, first)->prev = agent;
    }
    at->parts[part] = agent;
    at->parts_top = part < at->parts_top ? at->parts_top : part + 1;
    at->agents_count++;
}

static void queue_add(struct registry *r, struct place *at, enum tenant_queue queue, uint32_t agent)
{
    struct tenant_ends *ends = &at->queues[queue];
    struct tenant_link *link = &tenant_of(r, agent)->links[queue];
    if (link->queued) {
        return;
    }
    *link = (struct tenant_link){.queued = true, .next = TENANTS_NONE, .prev = ends->last};
    if (ends->last == TENANTS_NONE) {
        ends->first = agent;
    } else {
        tenant_of(r, ends->last)->links[queue].next = agent;
    }
    ends->last = agent;
}

static void queue_remove(struct registry *r, struct place *at, enum tenant_queue queue,
                         uint32_t agent)
{
    struct tenant_ends *ends = &at->queues[queue];
    struct tenant_link *link = &tenant_of(r, agent)->links[queue];
    if (!link->queued) {
        return;
    }
    if (link->prev == TENANTS_NONE) {
        ends->first = link->next;
    } else {
        tenant_of(r, link->prev)->links[queue].next = link->next;
    }
    if (link->next == TENANTS_NONE) {
        ends->last = link->prev;
    } else {
        tenant_of(r, link->next)->links[queue].prev = link->prev;
    }
    link->queued = false;
}

void tenants_remove(struct registry *r, struct places *p, uint32_t agent)
{
    struct tenant *t = tenant_of(r, agent);
    struct place *at = &p->at[t->place];
    queue_remove(r, at, TENANT_READY, agent);
    queue_remove(r, at, TENANT_STIRRED, agent);
    if (t->prev == TENANTS_NONE) {
        at->parts[t->slot / MU_PART_AGENTS] = t->next;
    } else {
        tenant_of(r, t->prev)->next = t->next;
    }
    if (t->next != TENANTS_NONE) {
        tenant_of(r, t->next)->prev = t->prev;
    }
    at->agents_count--;
}

uint32_t tenants_first_of(const struct places *p, uint32_t place, uint32_t part)
{
    return p->at[place].parts[part];
}

uint32_t tenants_next_of(const struct registry *r, uint32_t agent)
{
    return r->agents[agent].tenant.next;
}

/* The first agent of the parts from this one on. */
static uint32_t first_from(const struct place *at, uint32_t part)
{
    while (part < at->parts_top && at->parts[part] == TENANTS_NONE) {
        part++;
    }
    return part < at->parts_top ? at->parts[part] : (uint32_t)TENANTS_NONE;
}

uint32_t tenants_first(const struct places *p, uint32_t place)
{
    return first_from(&p->at[place], 0);
}

uint32_t tenants_next(const struct registry *r, const struct places *p, uint32_t agent)
{
    const struct tenant *t = &r->agents[agent].tenant;
    return t->next != TENANTS_NONE ? t->next
                                   : first_from(&p->at[t->place], t->slot / MU_PART_AGENTS + 1);
}

void tenants_wake(struct registry *r, struct places *p, uint32_t agent)
{
    if (r->agents[agent].process == MU_NONE) {
        return;
    }
    uint32_t place = tenant_of(r, agent)->place;
    queue_add(r, &p->at[place], TENANT_READY, agent);
    queue_add(r, &p->at[place], TENANT_STIRRED, agent);
    places_wake(p, place);
}

uint32_t tenants_pop(struct registry *r, struct places *p, uint32_t place)
{
    struct place *at = &p->at[place];
    uint32_t agent = at->queues[TENANT_READY].first;
    if (agent != TENANTS_NONE) {
        queue_remove(r, at, TENANT_READY, agent);
        queue_remove(r, at, TENANT_STIRRED, agent);
    }
    return agent;
}

uint32_t tenants_stirred(const struct places *p, uint32_t place)
{
    return p->at[place].queues[TENANT_STIRRED].first;
}

void tenants_calm(struct registry *r, struct places *p, uint32_t agent)
{
    queue_remove(r, &p->at[tenant_of(r, agent)->place], TENANT_STIRRED, agent);
}
