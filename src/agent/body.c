/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/body.h"

#include "core/log.h"

void body_act(mu_agent *a, const struct mind_act *act)
{
    if (act->drives && mu_agent_drive(a, act->forward_m_s, act->turn_rad_s) != MU_OK) {
        mu_log(MU_LOG_WARNING, "speed-refused", "name=%s", mu_agent_name(a));
    }
    if (mu_agent_grip(a, act->paddles, act->lift) != MU_OK) {
        mu_log(MU_LOG_WARNING, "order-refused", "name=%s", mu_agent_name(a));
    }
}

void body_ask(mu_agent *a, const struct mind *mind)
{
    mu_agent_senses(a, mind_senses(mind));
}
