/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/devices/devices.h"

void gps_init(struct gps *gps, const struct world_robot *robot, double step_s)
{
    *gps = (struct gps){.noise_m = robot->gps_noise_m,
                        .compass_noise_rad = robot->compass_noise_rad,
                        .drift_m = robot->gps_drift_m * sqrt(step_s)};
}

static double gps_draw(const struct gps_when *when, enum draw_use use, uint64_t index,
                       double deviation)
{
    if (deviation == 0) {
        return 0;
    }
    uint64_t key = draw_key(when->seed, when->robot, use, when->tick);
    return deviation * draw_normal(draw_bits(key, index));
}

void gps_walk(struct gps *gps, const struct gps_when *when)
{
    gps->off_x_m += gps_draw(when, DRAW_GPS_DRIFT, 0, gps->drift_m);
    gps->off_y_m += gps_draw(when, DRAW_GPS_DRIFT, 1, gps->drift_m);
}

struct gps_fix gps_read(const struct gps *gps, struct world_pose pose, const struct gps_when *when)
{
    struct gps_fix fix = {pose.x_m + gps->off_x_m, pose.y_m + gps->off_y_m, pose.heading_rad};
    fix.x_m += gps_draw(when, DRAW_GPS, 0, gps->noise_m);
    fix.y_m += gps_draw(when, DRAW_GPS, 1, gps->noise_m);
    double off = gps_draw(when, DRAW_COMPASS, 0, gps->compass_noise_rad);
    if (off != 0) {
        double heading = remainder(fix.compass_rad + off, 2 * M_PI);
        fix.compass_rad = heading <= -M_PI ? M_PI : heading;
    }
    return fix;
}
