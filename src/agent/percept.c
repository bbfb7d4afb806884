/* SPDX-License-Identifier: Apache-2.0 */
/* What a robot feels, and when its mind takes it. */
#include "agent/robot.h"

void percept_ask(mu_agent *a, const struct mind *mind)
{
    mu_agent_senses(a, mind_senses(mind));
}

void percept_settle(struct robot *r)
{
    if (!r->percept_waits) {
        return;
    }
    r->percept_waits = false;
    if (r->bodiless) {
        mind_feel_nothing(r->mind, r->percept.time_ns);
    } else {
        mind_percept(r->mind, &r->percept);
    }
}
