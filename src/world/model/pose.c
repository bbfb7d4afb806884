/* SPDX-License-Identifier: Apache-2.0 */
#include "world/model/world.h"

#include <math.h>

struct world_pose world_pose_in(struct world_pose frame, struct world_pose pose)
{
    double s, c;
    sincos(frame.heading_rad, &s, &c);
    double heading = remainder(frame.heading_rad + pose.heading_rad, 2 * M_PI);
    return (struct world_pose){.x_m = frame.x_m + c * pose.x_m - s * pose.y_m,
                               .y_m = frame.y_m + s * pose.x_m + c * pose.y_m,
                               .heading_rad = heading <= -M_PI ? M_PI : heading};
}

struct world_pose world_pose_from(struct world_pose frame, struct world_pose pose)
{
    double s, c;
    sincos(frame.heading_rad, &s, &c);
    double x = pose.x_m - frame.x_m;
    double y = pose.y_m - frame.y_m;
    struct world_pose turned = {0, 0, pose.heading_rad - frame.heading_rad};
    turned = world_pose_in((struct world_pose){0}, turned);
    return (struct world_pose){
        .x_m = c * x + s * y, .y_m = c * y - s * x, .heading_rad = turned.heading_rad};
}
