/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

#include "broker/control/parts.h"

void names_confirm(struct broker *b, uint32_t agent, uint64_t number)
{
    struct agent *a = &b->registry.agents[agent];
    a->seated = a->seated || number > a->seated_above;
}

bool names_is_beyond(const struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].process;
    return place != MU_NONE && b->processes.at[place].kind == PROCESS_BROKER;
}

void names_changed(struct broker *b)
{
    if (b->processes.all_awake) {
        return;
    }
    for (uint32_t i = 0; i < b->processes.top; i++) {
        if (processes_is_matched(&b->processes.at[i])) {
            processes_wake(&b->processes, i);
        }
    }
    b->processes.all_awake = true;
}

bool names_is_held(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    return a->process == MU_NONE && a->kept_until_ns > b->clock.now_ns;
}

uint64_t names_hold_end_ns(const struct broker *b)
{
    uint64_t now_ns = b->clock.now_ns;
    return now_ns + b->hold_ns < now_ns ? UINT64_MAX : now_ns + b->hold_ns;
}

void names_hold(struct broker *b, uint32_t agent)
{
    /* Commands bear theirs in turn, each for a moment. */
    if (b->registry.agents[agent].is.kind != muster_KIND_SPECIAL) {
        b->registry.agents[agent].kept_until_ns = names_hold_end_ns(b);
    }
}

void names_owe_verdict(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    a->seated = false;
    a->seated_above = mailbox_last_number(&b->mailbox, agent);
    a->verdict_due =
        b->processes.at[a->process].kind != PROCESS_BROKER || mailbox_is_begun(&b->mailbox, agent);
}

void names_tell_number(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->process != MU_NONE && b->processes.at[a->process].kind == PROCESS_BROKER) {
        a->verdict_due = true;
    }
}

/* Mail for an agent beyond another broker waits there. */
enum mailbox_gate names_gate(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    if (a->process == MU_NONE) {
        return GATE_SHUT;
    }
    switch (a->is.state) {
    case muster_STATE_STANDBY:
    case muster_STATE_RUNNING: return GATE_OPEN;
    case muster_STATE_SUSPENDED: return names_is_beyond(b, agent) ? GATE_OPEN : GATE_URGENT;
    case muster_STATE_MOVING: return names_is_beyond(b, agent) ? GATE_OPEN : GATE_SHUT;
    case muster_STATE_ABSENT: break;
    }
    return GATE_SHUT;
}
