/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* clang-format off */
/* The letters of the table; X is illegal. */
enum { X = 255, N = BEARER_NONE, A = BEARER_AWAITED, O = BEARER_OWED, T = BEARER_TOLD };

static const unsigned char next_bearer[BEARERS][BEARER_EVENTS] = {
    /*                 seats owes owes nothing tells unseats awaits forgets */
    [BEARER_NONE]    = {O,   X,   X,           X,    X,      A,     N},
    [BEARER_AWAITED] = {O,   X,   X,           X,    X,      A,     N},
    [BEARER_OWED]    = {O,   O,   T,           T,    N,      X,     X},
    [BEARER_TOLD]    = {O,   O,   T,           X,    N,      X,     X},
};
/* clang-format on */

void names_bearer_on(struct registry *r, uint32_t agent, enum bearer_event event)
{
    struct agent *a = &r->agents[agent];
    unsigned next = next_bearer[a->bearer][event];
    MU_ASSERT(next != X);
    a->bearer = (enum bearer)next;
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
    return clock_after_ns(b->clock.now_ns, NAMES_HOLD_NS);
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
    bool owes = b->processes.at[a->process].kind != PROCESS_BROKER || b->mailbox.boxes[agent].begun;
    a->seated_above = mailbox_last_number(&b->mailbox, agent);
    names_bearer_on(&b->registry, agent, owes ? BEARER_OWES : BEARER_OWES_NOTHING);
}
