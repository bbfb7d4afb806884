/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/membership.h"

#include "broker/control/parts.h"
#include "core/name.h"

#include <string.h>

/* So long DDS keeps the samples of a writer that is not heard. */
static const uint64_t OVER_NS = 10000000000;

/* --- coming and going --------------------------------------------------------------------------
 */

/* A process that comes after it must not begin with numbers that it has used. */
static void route_lose(struct broker *b, struct peer *p, uint32_t agent)
{
    struct route *route = &p->routes[agent];
    struct agent *a = &b->registry.agents[agent];
    uint64_t most = INT64_MAX / 2;
    uint64_t last = route->last_seq < most ? route->last_seq + JOURNAL_RESERVE : most;
    if (route->present && last > a->seq.elsewhere) {
        a->seq.elsewhere = last;
    }
    if (strcmp(route->is.home, p->name) == 0) {
        names_hold(b, agent);
    }
    route->present = false;
}

static void routes_lose(struct broker *b, struct peer *p)
{
    for (uint32_t i = REGISTRY_OWN; i < b->registry.count; i++) {
        if (p->routes[i].present) {
            route_lose(b, p, i);
            lifecycle_review(b, i);
        }
    }
}

void federation_lose(struct broker *b, uint32_t place)
{
    struct process *at = &b->processes.at[place];
    struct peer *p = remote_peer(b, remote_name(at->name));
    processes_session_on(&b->processes, place, SESSION_SILENT);
    if (p) {
        routes_lose(b, p);
        (void)remote_peer_on(&b->federation, p, PEER_LOST);
    }
    processes_tidy(&b->processes, place);
}

static void numbers_forget(struct broker *b, struct peer *p)
{
    for (uint32_t i = 0; i < b->registry.count; i++) {
        if (p->boxes[i].taken > 0) { /* memory of others stays untouched */
            p->boxes[i].taken = 0;
            (void)mu_list_remove(&p->acks, MU_LINKS(p->boxes, ack), i);
        }
    }
}

struct peer *federation_meet(struct broker *b, const char *name, uint64_t incarnation)
{
    struct peer *p = remote_peer(b, name);
    p = p ? p : remote_add_peer(b, name);
    if (!p) {
        if (b->federation.passed_over[0] == '\0') {
            (void)mu_text_copy(b->federation.passed_over, MU_NAME_MAX + 1, name);
        }
        return NULL;
    }
    bool begins = p->state == PEER_UNKNOWN || incarnation > p->incarnation;
    enum peer_event event = begins                          ? PEER_BEGINS
                            : incarnation == p->incarnation ? PEER_SPEAKS
                                                            : PEER_SPEAKS_EARLIER;
    if (!remote_peer_on(&b->federation, p, event)) {
        return NULL;
    }
    p->heard_ns = b->clock.now_ns;
    if (begins) {
        routes_lose(b, p);
        numbers_forget(b, p);
        p->incarnation = incarnation;
    }
    return p;
}

/* @return the process of a neighbour, or MU_NONE: there are too many processes */
static uint32_t process_hear(struct broker *b, struct peer *p)
{
    uint32_t place = processes_get(&b->processes, p->place);
    if (place == MU_NONE) {
        return MU_NONE;
    }
    struct process *at = &b->processes.at[place];
    at->kind = PROCESS_BROKER;
    at->incarnation = p->incarnation;
    if (p->state != PEER_THERE ||
        processes_is_silent(at)) { /* what it said while it was not heard */
        processes_call_roll(&b->processes, place);
    }
    processes_session_on(&b->processes, place, SESSION_HEARD);
    (void)remote_peer_on(&b->federation, p, PEER_ANNOUNCES);
    return place;
}

/* --- what a neighbour says ---------------------------------------------------------------------
 */

static bool entry_is_whole(const muster_Entry *e)
{
    return validate_entry(e, true) && !registry_objection(e->name, e->kind) &&
           (e->state == muster_STATE_ABSENT || e->home[0] != '\0');
}

/* @return whether the neighbour tells us what it has from us */
static bool entry_is_ours(const struct broker *b, const muster_Entry *e)
{
    return strcmp(e->home, b->name) == 0 || strcmp(e->via, b->name) == 0;
}

/* Its sender has left before the outcome of its mail came. */
static void receipts_forget(struct broker *b, uint32_t agent)
{
    if (b->registry.agents[agent].bearer == BEARER_AWAITED && b->journal.awaits_ns == UINT64_MAX) {
        names_bearer_on(&b->registry, agent, BEARER_FORGETS);
        receipts_drop(&b->receipts, agent, receipts_count(&b->receipts, agent));
    }
}

/* Another name has the slot of one that has ended, or none has it. */
static void slot_clear(struct broker *b, struct peer *p, uint32_t slot, const char *name)
{
    uint32_t agent = p->at_slot[slot] - 1;
    if (p->at_slot[slot] == 0 || strcmp(b->registry.agents[agent].name, name) == 0) {
        return;
    }
    struct route *route = &p->routes[agent];
    p->at_slot[slot] = 0;
    if (route->present && route->slot == slot) {
        route->present = false;
        lifecycle_review(b, agent);
    }
}

/* A name that has ended here does not come back because another broker still knows it, and when
 * room is scarce a name without a bearer takes none: its numbers alone are kept.
 * @return whether that was done */
static bool entry_is_buried(struct broker *b, const muster_Entry *e, bool ours)
{
    struct graveyard *g = &b->registry.graveyard;
    struct grave *grave = graveyard_find(g, e->name);
    if (!grave && !registry_is_crowded(&b->registry)) {
        return false;
    }
    if (!ours && e->last_seq <= INT64_MAX / 2) {
        grave = grave ? grave : graveyard_add(g, e->name);
        grave->seq.elsewhere =
            e->last_seq > grave->seq.elsewhere ? e->last_seq : grave->seq.elsewhere;
    }
    return true;
}

/* @return the agent, entered if it is new and there; MU_NONE: it is not to be, or cannot */
static uint32_t entry_agent(struct broker *b, const muster_Entry *e, bool ours, bool present)
{
    uint32_t agent = registry_find(&b->registry, e->name);
    if (agent != MU_NONE || (!present && entry_is_buried(b, e, ours))) {
        return agent;
    }
    agent = registry_add(&b->registry, e->name);
    if (agent == MU_NONE) {
        b->federation.missed = true;
        return MU_NONE;
    }
    b->registry.agents[agent].is.kind = e->kind;
    registry_touch(&b->registry, agent);
    return agent;
}

static void entry_take(struct broker *b, struct peer *p, const muster_Entry *e, uint32_t slot)
{
    bool ours = entry_is_ours(b, e);
    bool present = e->state != muster_STATE_ABSENT && !ours;
    uint32_t agent = entry_agent(b, e, ours, present);
    if (agent == MU_NONE) {
        return;
    }
    p->at_slot[slot] = present ? agent + 1 : 0;
    struct route *route = &p->routes[agent];
    struct agent *a = &b->registry.agents[agent];
    if (!ours && e->last_seq > a->seq.elsewhere && e->last_seq <= INT64_MAX / 2) {
        a->seq.elsewhere = e->last_seq;
    }
    if (!present && !route->present) {
        if (!ours) {
            receipts_forget(b, agent);
        }
        return;
    }
    struct presence *is = &route->is;
    *route = (struct route){.present = present, .slot = slot, .last_seq = e->last_seq};
    registration_presence(e, e->host, e->pid, is);
    is->hops = e->hops < MU_DISTANCE_MAX ? e->hops + 1 : MU_DISTANCE_MAX + 1;
    if (!present && strcmp(is->reason, muster_REASON_DISPOSED) == 0 && a->process != MU_NONE &&
        strcmp(a->place, p->place) == 0) {
        registry_named_on(&b->registry, agent, NAMED_DISPOSED);
    }
    lifecycle_review(b, agent);
}

/* @return whether this life of a neighbour has been silent for so long that what is said by an
 * earlier number cannot be a word that was under way */
static bool peer_is_over(const struct broker *b, const struct peer *p)
{
    return p->state == PEER_SILENT && b->clock.now_ns - p->heard_ns >= OVER_NS;
}

void federation_hear(struct broker *b, const muster_Registration *r)
{
    const char *name = remote_name(r->process);
    if (r->wire != muster_WIRE || !r->is_broker || !mu_name_valid(name)) {
        b->counters.malformed++;
        return;
    }
    if (strcmp(name, b->name) == 0) {
        return; /* our own */
    }
    struct peer *p = remote_peer(b, name);
    if (p && r->incarnation < p->incarnation && peer_is_over(b, p)) {
        /* a later life, whose clock has been set back */
        (void)remote_peer_on(&b->federation, p, PEER_FORGOTTEN);
    }
    p = federation_meet(b, name, r->incarnation);
    if (!p || process_hear(b, p) == MU_NONE) {
        return;
    }
    for (uint32_t i = 0; i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        uint32_t slot = r->part * MU_PART_AGENTS + i;
        slot_clear(b, p, slot, e->name);
        if (e->name[0] == '\0') {
            continue;
        }
        if (entry_is_whole(e)) {
            entry_take(b, p, e, slot);
        } else {
            b->counters.malformed++;
        }
    }
}
