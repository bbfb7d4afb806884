/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/tenants.h"

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

static void ready_unlink(struct registry *r, struct place *at, struct tenant *t)
{
    if (t->ready_prev == TENANTS_NONE) {
        at->ready_first = t->ready_next;
    } else {
        tenant_of(r, t->ready_prev)->ready_next = t->ready_next;
    }
    if (t->ready_next == TENANTS_NONE) {
        at->ready_last = t->ready_prev;
    } else {
        tenant_of(r, t->ready_next)->ready_prev = t->ready_prev;
    }
    t->ready = false;
}

void tenants_remove(struct registry *r, struct places *p, uint32_t agent)
{
    struct tenant *t = tenant_of(r, agent);
    struct place *at = &p->at[t->place];
    if (t->ready) {
        ready_unlink(r, at, t);
    }
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
    struct tenant *t = tenant_of(r, agent);
    struct place *at = &p->at[t->place];
    if (!t->ready) {
        t->ready = true;
        t->ready_next = TENANTS_NONE;
        t->ready_prev = at->ready_last;
        if (at->ready_last == TENANTS_NONE) {
            at->ready_first = agent;
        } else {
            tenant_of(r, at->ready_last)->ready_next = agent;
        }
        at->ready_last = agent;
    }
    places_wake(p, t->place);
}

uint32_t tenants_pop(struct registry *r, struct places *p, uint32_t place)
{
    struct place *at = &p->at[place];
    uint32_t agent = at->ready_first;
    if (agent != TENANTS_NONE) {
        ready_unlink(r, at, tenant_of(r, agent));
    }
    return agent;
}
