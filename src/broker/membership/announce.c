/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/membership.h"

#include "broker/control/parts.h"
#include "muster/version.h"

#include <string.h>

/* How often the first part is said again: as those of processes. */
static const uint64_t HEARTBEAT_NS = 300000000;

static struct mu_links due_links(struct federation *l)
{
    return (struct mu_links){l->due, sizeof l->due[0]};
}

static void part_mark(struct federation *l, uint32_t part)
{
    (void)mu_list_append(&l->parts, due_links(l), part);
}

static uint32_t agents_said(const struct broker *b)
{
    uint32_t count = b->registry.count;
    return (count < REGISTRY_ORDINARY ? count : REGISTRY_ORDINARY) - REGISTRY_OWN;
}

void announce_all(struct broker *b)
{
    for (uint32_t i = 0; i < agents_said(b); i += MU_PART_AGENTS) {
        part_mark(&b->federation, i / MU_PART_AGENTS);
    }
    part_mark(&b->federation, 0);
    b->federation.version_said = b->registry.changes.version;
}

void broker_peers(struct broker *b, uint32_t count, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    if (b->federation.listeners == 0 && count > 0) {
        announce_all(b);
    }
    b->federation.listeners = count;
}

void announce_agent(struct broker *b, uint32_t agent)
{
    if (!registry_is_own(agent) && agent < REGISTRY_ORDINARY) {
        part_mark(&b->federation, (agent - REGISTRY_OWN) / MU_PART_AGENTS);
    }
}

static void changelog_mark(struct broker *b)
{
    struct federation *l = &b->federation;
    const struct changelog *c = &b->registry.changes;
    if (l->version_said == c->version) {
        return;
    }
    CHANGELOG_EACH (agent, c, l->version_said) {
        announce_agent(b, agent);
    }
    l->version_said = c->version;
}

static muster_Entry entry_of(struct broker *b, uint32_t agent)
{
    char *nothing = sample_text("");
    struct agent *a = &b->registry.agents[agent];
    muster_Entry e = {.name = a->name,
                      .kind = a->is.kind,
                      .state = muster_STATE_ABSENT,
                      .home = nothing,
                      .via = nothing,
                      .host = nothing,
                      .reason = nothing,
                      .last_seq = registry_last_seq(a)};
    if (a->process == MU_NONE) {
        e.reason = a->named >= NAMED_ENDS ? sample_text(muster_REASON_DISPOSED) : nothing;
        return e;
    }
    bool is_here = a->is.home[0] == '\0';
    e.state = a->is.state;
    e.no_broadcasts = a->is.no_broadcasts;
    e.home = is_here ? b->name : a->is.home;
    e.via = is_here ? nothing : a->place + strlen("broker.");
    e.hops = a->is.hops;
    e.since_wall_ns = a->is.since_wall_ns;
    e.host = a->is.host;
    e.busy_since_wall_ns = a->is.busy_since_wall_ns;
    e.reason = a->is.reason;
    e.pid = a->is.pid;
    return e;
}

bool broker_announcement(struct broker *b, muster_Registration *out)
{
    struct federation *l = &b->federation;
    if (l->listeners == 0) {
        return false;
    }
    changelog_mark(b);
    uint32_t part = mu_list_first(&l->parts);
    if (part == MU_NONE) {
        return false;
    }
    uint32_t first = part * MU_PART_AGENTS, count = agents_said(b) - first;
    count = count < MU_PART_AGENTS ? count : MU_PART_AGENTS;
    for (uint32_t i = 0; i < count; i++) {
        l->entries[i] = entry_of(b, REGISTRY_OWN + first + i);
    }
    *out = (muster_Registration){.process = b->place,
                                 .part = part,
                                 .wire = muster_WIRE,
                                 .version = sample_text(MU_VERSION),
                                 .broker = sample_text(""),
                                 .incarnation = b->incarnation,
                                 .host = sample_text(""),
                                 .pid = b->registry.agents[REGISTRY_BROKER].is.pid,
                                 .is_broker = true,
                                 .agents = {count, count, l->entries, false}};
    return true;
}

void broker_announced(struct broker *b)
{
    struct federation *l = &b->federation;
    (void)mu_list_take(&l->parts, due_links(l));
    l->count.announced++;
}

void announce_tick(struct broker *b)
{
    struct federation *l = &b->federation;
    if (announce_deadline_ns(b) <= b->clock.now_ns) {
        part_mark(l, 0);
        l->beat_ns = b->clock.now_ns + HEARTBEAT_NS;
    }
}

uint64_t announce_deadline_ns(const struct broker *b)
{
    return b->federation.listeners > 0 ? b->federation.beat_ns : UINT64_MAX;
}
