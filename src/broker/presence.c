/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/presence.h"

#include "broker/border.h"
#include "broker/journal.h"
#include "broker/parts.h"
#include "core/text.h"

#include <string.h>

uint64_t presence_wall_ns(const struct broker *b)
{
    return b->wall_ns + b->clock.now_ns;
}

bool presence_in_lockstep(const struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].process;
    return place != MU_NONE && b->places.at[place].rostered;
}

/* The white pages have changed: whoever may be told at any time is. */
static void presence_changed(struct broker *b)
{
    for (uint32_t i = 0; i < b->places.top; i++) {
        if (b->places.at[i].used && b->places.at[i].matched) {
            places_wake(&b->places, i);
        }
    }
}

/* --- who lives where -------------------------------------------------------------------------- */

static bool place_add(struct broker *b, uint32_t place, uint32_t agent)
{
    struct place *at = &b->places.at[place];
    if (at->agents_count == MU_LOCAL_AGENTS_MAX) {
        return false;
    }
    uint32_t i = at->agents_count++;
    const char *name = b->registry.agents[agent].name;
    for (; i > 0 && strcmp(b->registry.agents[at->agents[i - 1]].name, name) > 0; i--) {
        at->agents[i] = at->agents[i - 1];
    }
    at->agents[i] = agent;
    return true;
}

static void place_remove(struct broker *b, uint32_t place, uint32_t agent)
{
    struct place *at = &b->places.at[place];
    uint32_t i = 0;
    while (at->agents[i] != agent) {
        i++;
    }
    at->agents_count--;
    memmove(&at->agents[i], &at->agents[i + 1], (at->agents_count - i) * sizeof at->agents[0]);
}

/* What the agent has had in its box before is for its new process to have again. */
static void seat(struct broker *b, uint32_t agent, uint32_t place, const struct presence *is)
{
    struct place *at = &b->places.at[place];
    if (!place_add(b, place, agent)) {
        places_refuse(&b->places, place, b->registry.agents[agent].name,
                      "too many agents in one process");
        return;
    }
    registry_seat(&b->registry, agent, place, at->name, is, presence_wall_ns(b));
    journal_agent(b, agent);
    mailbox_repeat(&b->mailbox, agent);
    presence_changed(b);
    places_wake(&b->places, place);
}

void presence_depart(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    uint32_t place = a->process;
    place_remove(b, place, agent);
    registry_unseat(&b->registry, agent, presence_wall_ns(b));
    mailbox_unwatch(&b->mailbox, agent);
    mailbox_repeat(&b->mailbox, agent);
    receipts_drop(&b->receipts, agent, receipts_of(&b->receipts, agent)->count);
    presence_changed(b);
    places_tidy(&b->places, place);
    if (a->claim.process != MU_NONE) {
        uint32_t heir = a->claim.process;
        struct presence is = a->claim.presence;
        registry_unclaim(&b->registry, agent);
        b->places.at[heir].claims--;
        seat(b, agent, heir, &is);
    }
}

/* --- claims ----------------------------------------------------------------------------------- */

static const char held_by_another[] = "held by another participant";

static void claim_drop(struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].claim.process;
    registry_unclaim(&b->registry, agent);
    b->places.at[place].claims--;
    places_tidy(&b->places, place);
}

static void claim_make(struct broker *b, uint32_t agent, uint32_t place, const struct presence *is)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->claim.process == place) {
        a->claim.presence = *is;
    } else if (a->claim.process != MU_NONE) {
        places_refuse(&b->places, place, a->name, held_by_another);
    } else {
        uint64_t now_ns = b->clock.now_ns;
        uint64_t until_ns = now_ns + b->hold_ns < now_ns ? UINT64_MAX : now_ns + b->hold_ns;
        registry_claim(&b->registry, agent, place, is, until_ns);
        b->places.at[place].claims++;
    }
}

void presence_tick(struct broker *b)
{
    while (presence_deadline_ns(b) <= b->clock.now_ns) {
        uint32_t agent = b->registry.claims[0];
        struct agent *a = &b->registry.agents[agent];
        places_refuse(&b->places, a->claim.process, a->name, held_by_another);
        claim_drop(b, agent);
    }
}

uint64_t presence_deadline_ns(const struct broker *b)
{
    const struct registry *r = &b->registry;
    return r->claims_count ? r->agents[r->claims[0]].claim.until_ns : UINT64_MAX;
}

/* --- coming and going ------------------------------------------------------------------------- */

void presence_set_state(struct broker *b, uint32_t agent, muster_State state)
{
    if (registry_set_state(&b->registry, agent, state, presence_wall_ns(b))) {
        presence_changed(b);
    }
}

/* A registration from the process that has the name already. */
static void reregister(struct broker *b, uint32_t agent, struct presence *is)
{
    struct agent *a = &b->registry.agents[agent];
    if (is->incarnation < a->is.incarnation) {
        return; /* late, from a process that is no more */
    }
    bool other_process = is->incarnation > a->is.incarnation;
    a->gone = false;
    if (presence_in_lockstep(b, agent)) {
        is->state = a->is.state;
    }
    if (registry_update(&b->registry, agent, is, presence_wall_ns(b))) {
        presence_changed(b);
    }
    if (other_process) {
        a->is.incarnation = is->incarnation;
        a->verdict_due = true;
        b->places.at[a->process].version_had = 0;
        mailbox_repeat(&b->mailbox, agent);
        places_wake(&b->places, a->process);
    }
}

static void presence_of(const muster_Registration *r, struct presence *is)
{
    *is = (struct presence){.kind = r->kind,
                            .state = r->state,
                            .no_broadcasts = r->no_broadcasts,
                            .incarnation = r->incarnation,
                            .pid = r->pid};
    (void)mu_text_copy(is->host, sizeof is->host, r->host);
}

static void presence_admit(struct broker *b, uint32_t agent, uint32_t place, struct presence *is)
{
    uint32_t holder = b->registry.agents[agent].process;
    if (holder == MU_NONE) {
        seat(b, agent, place, is);
    } else if (holder == place) {
        reregister(b, agent, is);
    } else {
        claim_make(b, agent, place, is);
    }
}

void presence_register(struct broker *b, const muster_Registration *r)
{
    uint32_t place = border_registration(r) ? places_get(&b->places, r->process) : MU_NONE;
    if (place == MU_NONE) {
        b->counters.malformed++;
        return;
    }
    const char *objection = registry_objection(r->name, r->kind);
    uint32_t agent = objection ? MU_NONE : registry_find(&b->registry, r->name);
    if (r->state == muster_STATE_ABSENT) {
        if (agent != MU_NONE) {
            presence_gone(b, agent, place);
        }
        places_tidy(&b->places, place);
        return;
    }
    if (!objection && agent == MU_NONE) {
        agent = registry_add(&b->registry, r->name);
        objection = agent == MU_NONE ? "the white pages are full" : NULL;
    }
    if (objection) {
        places_refuse(&b->places, place, r->name, objection);
        return;
    }
    struct presence is;
    presence_of(r, &is);
    presence_admit(b, agent, place, &is);
}

void presence_gone(struct broker *b, uint32_t agent, uint32_t place)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->claim.process == place) {
        claim_drop(b, agent);
    } else if (a->process == place && b->places.at[place].rostered) {
        a->gone = true;
    } else if (a->process == place) {
        presence_depart(b, agent);
    }
}

void presence_gone_unnamed(struct broker *b, uint32_t agent, bool nobody_left)
{
    const struct agent *a = &b->registry.agents[agent];
    if (nobody_left && a->claim.process != MU_NONE) {
        claim_drop(b, agent);
    }
    if (a->process != MU_NONE) {
        presence_gone(b, agent, a->process);
    }
}

void presence_settle(struct broker *b, uint32_t place)
{
    struct place *at = &b->places.at[place];
    for (uint32_t i = at->agents_count; i > 0; i--) {
        uint32_t agent = at->agents[i - 1];
        if (b->registry.agents[agent].gone) {
            presence_depart(b, agent);
        }
    }
}
