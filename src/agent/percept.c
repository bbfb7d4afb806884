/* SPDX-License-Identifier: Apache-2.0 */
/* A robot's percept, and the sensors that its rules ask for. */
#include "agent/robot.h"

void percept_ask(mu_agent *a, const struct mind *mind)
{
    mu_agent_senses(a, mind_senses(mind));
}

void percept_settle(struct robot *r)
{
    if (r->state != ROBOT_PERCEIVES) {
        return;
    }
    robot_state_enter(&r->state, ROBOT_HAS_FELT);
    if (r->percept.robot) {
        mind_percept(r->mind, &r->percept);
    } else {
        mind_feel_nothing(r->mind, r->percept.time_ns);
    }
}
