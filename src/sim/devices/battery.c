/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/devices/devices.h"

void battery_init(struct battery *battery, const struct world_robot *robot)
{
    *battery = (struct battery){.joules = fmin(robot->battery_j, robot->battery_max_j),
                                .full_j = robot->battery_max_j,
                                .power_w = robot->power_w,
                                .take_w = robot->take_w};
}

void battery_run(struct battery *battery, double drive_w, double give_w, double dt_s)
{
    if (battery->full_j == 0) {
        return;
    }
    double taken_w = fmin(give_w, battery->take_w);
    double joules = battery->joules + (taken_w - battery->power_w - drive_w) * dt_s;
    battery->joules = fmax(0, fmin(joules, battery->full_j));
}

bool battery_is_empty(const struct battery *battery)
{
    return battery->full_j > 0 && battery->joules == 0;
}

double battery_share(const struct battery *battery)
{
    return battery->full_j > 0 ? battery->joules / battery->full_j : -1;
}
