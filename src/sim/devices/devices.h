/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file devices.h
 * What a robot moves by, and knows of itself: wheels, odometer, GPS, battery, gripper.
 */
#ifndef MUSTER_SIM_DEVICES_H
#define MUSTER_SIM_DEVICES_H

#include "sim/geometry/geometry.h"

/* --- wheels ----------------------------------------------------------------------------------- */

/*
 * Two driven wheels: from the speed that is wanted to the force that the floor can take.
 *
 * A wheel follows its aim by the body's acceleration limits.  It pulls the body along with what
 * force it takes to be there within a step, but no more than the friction of rubber allows: so a
 * robot that is held up slips, and a robot that is pushed hard enough gives way.
 */

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

/* --- odometer --------------------------------------------------------------------------------- */

/*
 * Where a robot takes itself to be from the turning of its wheels.
 *
 * It counts what the wheels do, not the body: a robot that slips or is pushed does not notice.
 */

struct odometer {
    struct world_pose pose;         /* heading in (-pi, pi] */
    double forward_gain, turn_gain; /* read for what is: 1 without an error */
    double c, s;                    /* of the heading of the last piece of the way */
    bool turned;                    /* the heading has changed since */
};

/** Starts at the file's pose, or at the robot's own; its gains belong to the seed and the robot. */
void odometer_init(struct odometer *odometer, const struct world_robot *robot, uint64_t seed,
                   uint32_t index);

/** Counts the wheels' speeds for dt_s. */
void odometer_run(struct odometer *odometer, double forward_m_s, double turn_rad_s, double dt_s);

/* --- GPS and compass -------------------------------------------------------------------------- */

/*
 * The absolute place and the compass: exact, or with noise and with a drift that walks.
 */

struct gps {
    double noise_m, compass_noise_rad;
    double drift_m;          /* of one control step, in each direction */
    double off_x_m, off_y_m; /* how far it has drifted */
};

/* Whose it is, and the control step. */
struct gps_when {
    uint64_t seed, robot, tick;
};

/* A place as it is read. */
struct gps_fix {
    double x_m, y_m, compass_rad; /* in (-pi, pi] */
};

void gps_init(struct gps *gps, const struct world_robot *robot, double step_s);

/** Lets it drift for a control step. */
void gps_walk(struct gps *gps, const struct gps_when *when);

/** Reads it; the same time gives the same reading. */
struct gps_fix gps_read(const struct gps *gps, struct world_pose pose, const struct gps_when *when);

/* --- battery ---------------------------------------------------------------------------------- */

/*
 * What a robot has left to live on.
 */

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

/* --- gripper ---------------------------------------------------------------------------------- */

/*
 * Two paddles at the front of a robot: how they move, and where they are.
 *
 * Which thing they take and whether there is room is the engine's to say (engine/grip.c).
 */

enum { GRIPPER_NOTHING = -1, GRIPPER_PADDLES = 2 };

/* How long the paddles take from open to closed, and the lift from below to above. */
#define GRIPPER_TIME_S 1.0

struct gripper {
    const struct world_gripper *make; /* NULL: the robot has none */
    bool closes, lifts;               /* what is wanted */
    double closed, lifted;            /* how far it has come, 0 to 1 */
    int32_t holds;                    /* an object's number; GRIPPER_NOTHING */
    double c, s;                      /* of its case's heading in the robot's frame */
};

void gripper_init(struct gripper *gripper, const struct world_robot *robot);

/** @return whether the paddles are up, out of everybody's way */
bool gripper_is_up(const struct gripper *gripper);

/** @return how closed the paddles are after dt_s on their way to what is wanted */
double gripper_next_closed(const struct gripper *gripper, double dt_s);

/** @return how high they are then */
double gripper_next_lifted(const struct gripper *gripper, double dt_s);

/** @return a paddle, 0 the left one, where it would be if they were closed so far */
struct solid gripper_paddle(const struct gripper *gripper, const struct frame *frame, int paddle,
                            double closed);

/**
 * @param beam  receives the light between the paddles, at their tips (outer) or their roots
 * @return false: they are closed, there is none
 */
bool gripper_beam(const struct gripper *gripper, const struct frame *frame, bool outer,
                  struct solid *beam);

/** @return whether a point lies between the paddles if they were closed so far */
bool gripper_spans(const struct gripper *gripper, const struct frame *frame, const double point[2],
                   double closed);

#endif
