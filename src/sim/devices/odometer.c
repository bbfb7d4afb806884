/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/devices/devices.h"

/* @return 1, plus or minus up to half of the error, as Stage draws it once for each robot */
static double odometer_gain(double error, uint64_t bits)
{
    return error == 0 ? 1 : 1 + error * (draw_unit(bits) - 0.5);
}

void odometer_init(struct odometer *o, const struct world_robot *robot, uint64_t seed,
                   uint32_t index)
{
    const struct world_odometry *file = &robot->odometry;
    uint64_t key = draw_key(seed, index, DRAW_ODOMETER, 0);
    *o = (struct odometer){.pose = file->true_start ? robot->pose : file->start,
                           .forward_gain = odometer_gain(file->forward_error, draw_bits(key, 0)),
                           .turn_gain = odometer_gain(file->turn_error, draw_bits(key, 1)),
                           .turned = true};
}

static double odometer_turn(double heading, double by)
{
    heading += by;
    if (heading > M_PI) {
        return heading - 2 * M_PI;
    }
    return heading <= -M_PI ? heading + 2 * M_PI : heading;
}

/* The motion of a step follows the heading in the middle of the step. */
void odometer_run(struct odometer *o, double forward_m_s, double turn_rad_s, double dt_s)
{
    double half = o->turn_gain * turn_rad_s * dt_s / 2;
    double way = o->forward_gain * forward_m_s * dt_s;
    if (half != 0 || o->turned) {
        o->pose.heading_rad = odometer_turn(o->pose.heading_rad, half);
        sincos(o->pose.heading_rad, &o->s, &o->c);
        o->pose.heading_rad = odometer_turn(o->pose.heading_rad, half);
        o->turned = half != 0;
    }
    o->pose.x_m += o->c * way;
    o->pose.y_m += o->s * way;
}
