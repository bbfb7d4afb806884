/* SPDX-License-Identifier: Apache-2.0 */
/* What a robot knows of itself: where it is, by each of its ways to know, and what it touches. */
#include "sim/engine/engine_core.h"

struct world_pose engine_pose(const struct engine *e, size_t body)
{
    MU_ASSERT(body < e->body_count);
    const struct ode_motion *m = &e->bodies[body].motion;
    double heading = atan2(m->s, m->c);
    return (struct world_pose){m->x, m->y, heading <= -M_PI ? M_PI : heading};
}

void engine_feel(const struct engine *e, size_t robot, struct engine_percept *out)
{
    const struct engine_robot *r = &e->robots[robot];
    const struct ode_motion *m = &e->bodies[robot].motion;
    struct world_pose pose = engine_pose(e, robot);
    struct gps_when now = {e->seed, robot, e->steps};
    struct gps_fix fix = gps_read(&r->gps, pose, &now);
    struct world_pose by_gps = {fix.x_m, fix.y_m, fix.compass_rad};
    bool by_wheels = e->world->robots[robot].reads_odometer;
    *out = (struct engine_percept){.pose = pose,
                                   .position = by_wheels ? r->odometer.pose : by_gps,
                                   .gps_x_m = fix.x_m,
                                   .gps_y_m = fix.y_m,
                                   .compass_rad = fix.compass_rad,
                                   .odometer = r->odometer.pose,
                                   .forward_m_s = m->c * m->vx + m->s * m->vy,
                                   .turn_rad_s = m->turn,
                                   .stalled = drive_stalled(&r->drive),
                                   .placed = e->bodies[robot].placed,
                                   .fault = e->bodies[robot].fault,
                                   .bumpers = r->bumpers,
                                   .gripper = r->grip_felt,
                                   .battery_share = battery_share(&r->battery)};
}
