/* SPDX-License-Identifier: Apache-2.0 */
/* The robots of a process: which one goes, and whether any is left. */
#include "agent/robot.h"

bool agent_is_away(const struct robot *r)
{
    return r->migration && r->migration->state >= MIGRATION_DEPOSITED &&
           r->migration->purpose == MIGRATION_MOVE;
}

void group_process_look(struct group_process *g)
{
    if (g->host[0] || mu_process_in_lockstep(g->process)) {
        return;
    }
    for (uint32_t i = 0; i < g->count; i++) {
        if (g->robots[i].state != ROBOT_VACANT) {
            return;
        }
    }
    mu_process_stop(g->process);
}

void group_process_leave(struct robot *r)
{
    console_end(r);
    robot_state_enter(&r->state, ROBOT_LEAVES);
    group_process_look(r->group);
}

void group_process_drop(struct robot *r)
{
    if (mu_agent_state(r->agent) != MU_GONE) {
        mu_agent_leave(r->agent);
    }
    ports_print_rest(r);
    console_flush(r);
    mind_close(r->mind);
    group_process_leave(r);
}
