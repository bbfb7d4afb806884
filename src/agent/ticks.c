/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Control steps of agents without a body where no simulator gives any.  Their time is the wall's,
 * which all processes share, and which goes on while an agent moves or is away.
 */
#include "agent/robot.h"
#include "core/clock.h"
#include "core/signals.h"

/* An agent's process looks at itself so often in any case. */
static const uint64_t ROUND_NS = 300000000;

/* @return whether an agent of the process has no other clock */
static bool ticks_are_wanted(const struct group_process *g)
{
    const mu_process *p = g->process;
    bool any = false;
    bool may = !g->set->awaits_run && !process_in_lockstep(p) && p->steps != PROCESS_DONE &&
               bus_reader_matches(&p->sense) == 0;
    for (uint32_t i = 0; i < g->count && may; i++) {
        const struct robot *r = &g->robots[i];
        any = any || (r->state != ROBOT_VACANT && r->agent && r->agent->kind == MU_KIND_AGENT);
    }
    return any;
}

static void tick_live(struct group_process *g)
{
    mu_process *p = g->process;
    const muster_Sense sense = {
        .process = p->name, .step = g->ticks++, .time_ns = mu_clock_wall_ns()};
    p->step_wall_ns = mu_clock_ns(); /* mail waits for the next one */
    p->step = &sense;
    step_live_freely(p, &sense);
    p->step = NULL;
}

/* @return how long the next tick is off */
static uint64_t ticks_look(struct group_process *g)
{
    uint64_t now_ns = mu_clock_ns();
    if (!ticks_are_wanted(g)) {
        return ROUND_NS;
    }
    if (now_ns >= g->tick_due_ns && g->process->up_state != UP_PENDING) {
        tick_live(g);
        bool late = now_ns > g->tick_due_ns + MU_STEP_NS;
        g->tick_due_ns = (late ? now_ns : g->tick_due_ns) + MU_STEP_NS;
        now_ns = mu_clock_ns();
    }
    return g->tick_due_ns > now_ns ? g->tick_due_ns - now_ns : 0;
}

mu_result ticks_run(struct group_process *g)
{
    mu_process *p = g->process;
    mu_result spun = MU_OK;
    mu_signals_note();
    while (spun == MU_OK && !p->stopped && !mu_signal_came) {
        spun = mu_process_spin(p, (int64_t)ticks_look(g));
        if (spun == MU_OK) {
            p->round(p->round_self);
        }
    }
    return spun < 0 ? spun : MU_OK;
}
