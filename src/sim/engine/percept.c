/* SPDX-License-Identifier: Apache-2.0 */
/* The readings that need no ray: position, speed, bumpers, gripper, battery. */
#include "sim/engine/engine_core.h"

struct world_pose engine_pose(const struct engine *e, size_t body)
{
    MU_ASSERT(body < e->body_count);
    const struct ode_motion *m = &e->bodies[body].motion;
    double heading = atan2(m->s, m->c);
    return (struct world_pose){m->x, m->y, heading <= -M_PI ? M_PI : heading};
}

void percept_read(const struct engine *e, size_t robot, struct engine_sample *out)
{
    const struct engine_robot *r = &e->robots[robot];
    const struct ode_motion *m = &e->bodies[robot].motion;
    struct world_pose pose = engine_pose(e, robot);
    struct gps_when now = {e->seed, robot, e->steps};
    struct gps_fix fix = gps_read(&r->gps, pose, &now);
    struct world_pose by_gps = {fix.x_m, fix.y_m, fix.compass_rad};
    struct world_pose by_wheels = r->odometer.pose;
    struct world_pose position = e->world->robots[robot].reads_odometer ? by_wheels : by_gps;
    *out = (struct engine_sample){.percept = {.x_m = position.x_m,
                                              .y_m = position.y_m,
                                              .heading_rad = position.heading_rad,
                                              .forward_m_s = m->c * m->vx + m->s * m->vy,
                                              .turn_rad_s = m->turn,
                                              .stalled = drive_stalled(&r->drive),
                                              .fault = e->bodies[robot].fault,
                                              .gps_x_m = fix.x_m,
                                              .gps_y_m = fix.y_m,
                                              .compass_rad = fix.compass_rad,
                                              .odometer_x_m = by_wheels.x_m,
                                              .odometer_y_m = by_wheels.y_m,
                                              .odometer_heading_rad = by_wheels.heading_rad,
                                              .bumpers = r->bumpers,
                                              .gripper = r->grip_felt,
                                              .battery_share = battery_share(&r->battery)},
                                  .pose = pose,
                                  .placed = e->bodies[robot].placed};
}

struct mu_percept engine_truth(const struct engine_sample *sample)
{
    struct mu_percept truth = {.robot = NULL};
#define COPY(type, member, ...) truth.member = sample->percept.member;
    MU_READINGS(COPY)
#undef COPY
    truth.x_m = sample->pose.x_m;
    truth.y_m = sample->pose.y_m;
    truth.heading_rad = sample->pose.heading_rad;
    return truth;
}
