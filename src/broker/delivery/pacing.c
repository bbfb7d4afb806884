/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

void pacing_bring_forward(struct pacing *f, uint32_t place)
{
    struct pacing_speaker *s = f->speakers;
    uint32_t i = 0;
    while (i < PACING_SPEAKERS - 1 && (s[i].place != place || s[i].spoke_ns == 0)) {
        i++;
    }
    for (; i > 0; i--) {
        s[i] = s[i - 1];
    }
    s[0].place = place;
}

/* @return whether any process but the two ends of a flood has mail under way */
static bool disturbs(const struct broker *b, uint32_t place)
{
    bool found = false;
    for (uint32_t i = 0; i < PACING_SPEAKERS && !found; i++) {
        const struct pacing_speaker *s = &b->pacing.speakers[i];
        bool speaks = s->spoke_ns > 0 && b->clock.now_ns - s->spoke_ns < PACING_QUIET_NS;
        found = speaks && s->place != place && s->place != b->processes.at[place].flooded_from;
    }
    return found;
}

bool pacing_is_flooded(const struct broker *b, uint32_t place)
{
    const struct process *at = &b->processes.at[place];
    bool is_one = !scope_is_paced(at->scope) && at->kind != PROCESS_BROKER;
    return is_one && disturbs(b, place);
}

bool pacing_hold(struct broker *b, uint32_t place)
{
    struct pacing *f = &b->pacing;
    struct process *at = &b->processes.at[place];
    bool holds = pacing_is_flooded(b, place);
    if (holds && mu_list_append(&f->held, MU_LINKS(b->processes.at, flooded), place)) {
        at->flood_wake_ns = at->flooded_until_ns;
    }
    return holds;
}

void pacing_tick(struct broker *b)
{
    struct pacing *f = &b->pacing;
    while (pacing_deadline_ns(b) <= b->clock.now_ns) {
        processes_wake(&b->processes, mu_list_take(&f->held, MU_LINKS(b->processes.at, flooded)));
    }
}

uint64_t pacing_deadline_ns(const struct broker *b)
{
    uint32_t first = mu_list_first(&b->pacing.held);
    return first != MU_NONE ? b->processes.at[first].flood_wake_ns : UINT64_MAX;
}
