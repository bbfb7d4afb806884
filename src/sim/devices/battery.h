/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file battery.h
 * What a robot has left to live on.
 */
#ifndef MUSTER_SIM_BATTERY_H
#define MUSTER_SIM_BATTERY_H

#include "world/world.h"

struct battery {
    double joules, full_j; /* full_j 0: there is none, and it never ends */
    double power_w;        /* used at all times */
    double take_w;         /* taken at most */
};

void battery_init(struct battery *battery, const struct world_robot *robot);

/**
 * Lives on it for dt_s.
 *
 * @param drive_w  what the wheels do to the body, beside what is used at all times
 * @param give_w   what stands at its side to charge it; 0: nothing does
 */
void battery_run(struct battery *battery, double drive_w, double give_w, double dt_s);

/** @return whether it is empty: nothing on the robot moves any more */
bool battery_is_empty(const struct battery *battery);

/** @return how much of full is left; -1: there is none */
double battery_share(const struct battery *battery);

#endif
