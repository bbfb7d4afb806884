/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

#include "broker/control/parts.h"

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
