/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/body.h"

#include "core/log.h"

struct mind_percept body_percept(const struct mu_percept *p)
{
    return (struct mind_percept){.time_ns = p->time_ns,
                                 .x_m = p->x_m,
                                 .y_m = p->y_m,
                                 .heading_rad = p->heading_rad,
                                 .forward_m_s = p->forward_m_s,
                                 .turn_rad_s = p->turn_rad_s,
                                 .stalled = p->stalled,
                                 .gps_x_m = p->gps_x_m,
                                 .gps_y_m = p->gps_y_m,
                                 .compass_rad = p->compass_rad,
                                 .odometer_x_m = p->odometer_x_m,
                                 .odometer_y_m = p->odometer_y_m,
                                 .odometer_heading_rad = p->odometer_heading_rad,
                                 .battery_share = p->battery_share,
                                 .bumpers = p->bumpers,
                                 .gripper = p->gripper,
                                 .sonar_count = p->sonar_count,
                                 .laser_count = p->laser_count,
                                 .blob_count = p->blob_count,
                                 .fiducial_count = p->fiducial_count,
                                 .sonar_m = p->sonar_m,
                                 .laser_m = p->laser_m,
                                 .blobs = p->blobs,
                                 .fiducials = p->fiducials};
}

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
