/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sonar.h"

#include <math.h>

void sonar_init(struct sonar_ring *ring, const struct world_robot *robot)
{
    ring->count = robot->sonar_count;
    for (size_t i = 0; i < ring->count; i++) {
        const struct world_sonar *from = &robot->sonars[i];
        ring->sonars[i] = (struct sonar){.x = from->pose.x_m,
                                         .y = from->pose.y_m,
                                         .along_x = cos(from->pose.heading_rad),
                                         .along_y = sin(from->pose.heading_rad),
                                         .range_min_m = from->range_min_m,
                                         .range_max_m = from->range_max_m};
    }
}

void sonar_read(const struct sonar_ring *ring, const struct grid *grid, int self,
                const struct sonar_frame *frame, float range_m[MU_SONARS_MAX])
{
    for (size_t i = 0; i < ring->count; i++) {
        const struct sonar *sonar = &ring->sonars[i];
        double from[2] = {frame->x + frame->c * sonar->x - frame->s * sonar->y,
                          frame->y + frame->s * sonar->x + frame->c * sonar->y};
        double along[2] = {frame->c * sonar->along_x - frame->s * sonar->along_y,
                           frame->s * sonar->along_x + frame->c * sonar->along_y};
        double range = grid_ray(grid, self, from, along, sonar->range_max_m);
        range_m[i] = (float)(range < sonar->range_min_m ? sonar->range_min_m : range);
    }
}
