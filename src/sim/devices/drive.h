/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file drive.h
 * Two driven wheels: from the speed that is wanted to the force that the floor can take.
 *
 * A wheel follows its aim by the body's acceleration limits.  It pulls the body along with what
 * force it takes to be there within a step, but no more than the friction of rubber allows: so a
 * robot that is held up slips, and a robot that is pushed hard enough gives way.
 */
#ifndef MUSTER_SIM_DRIVE_H
#define MUSTER_SIM_DRIVE_H

#include "world/world.h"

#define DRIVE_GRAVITY_M_S2 9.81

struct drive_limits {
    double forward_max_m_s, reverse_max_m_s, turn_max_rad_s;
    double forward_accel_m_s2, turn_accel_rad_s2;
    double width_m;
    double mass_kg, inertia_kg_m2;
    double traction_n; /* that the wheels bring to the floor */
    double turn_traction_nm;
};

struct drive {
    struct drive_limits limits;
    double aim_forward_m_s, aim_turn_rad_s; /* what is wanted */
    double forward_m_s, turn_rad_s;         /* what the wheels do */
    double held_up_s;                       /* how long they have turned in vain */
};

/* In the robot's own frame: along, to the left, about the vertical. */
struct drive_motion {
    double forward_m_s, left_m_s, turn_rad_s;
};
struct drive_force {
    double forward_n, left_n, turn_nm;
};

/** At rest.  speed_max_m_s is what the world allows, whatever the robot could do. */
void drive_init(struct drive *drive, const struct world_robot *robot, double inertia_kg_m2,
                double speed_max_m_s);

/** Takes over what the body and its load weigh now. */
void drive_load(struct drive *drive, double mass_kg, double inertia_kg_m2);

/** Stops the wheels dead: the body was put somewhere else. */
void drive_halt(struct drive *drive);

/** Sets the aim, clamped to the limits; the arguments become what was set.  All finite. */
void drive_aim(struct drive *drive, double *forward_m_s, double *turn_rad_s);

/** Turns the wheels for dt_s and answers how they push the body, which moves as given. */
struct drive_force drive_run(struct drive *drive, const struct drive_motion *motion, double dt_s);

/** Takes note, after dt_s, of whether the body moved as the wheels did. */
void drive_watch(struct drive *drive, const struct drive_motion *motion, double dt_s);

/** @return whether the wheels have been held up for 0.3 s */
bool drive_stalled(const struct drive *drive);

#endif
