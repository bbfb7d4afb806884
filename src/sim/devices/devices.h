/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file devices.h
 * The devices of a robot that need no ray: wheels, odometer, GPS and compass, battery, gripper.
 */
#ifndef MUSTER_SIM_DEVICES_H
#define MUSTER_SIM_DEVICES_H

#include "sim/geometry/geometry.h"

/* --- wheels ----------------------------------------------------------------------------------- */

/*
 * Two driven wheels: from the wanted speed to a force that the floor can bear.  Wheels approach
 * their aim within the acceleration limits of the body.  They pull the body to their own speed
 * within a step, but with no more force than friction allows.  Hence a robot that is blocked slips,
 * and a robot that is pushed hard gives way.
 */

#define DRIVE_GRAVITY_M_S2 9.81

struct drive_limits {
    double forward_max_m_s, reverse_max_m_s, turn_max_rad_s;
    double forward_accel_m_s2, turn_accel_rad_s2;
    double width_m;
    double mass_kg, inertia_kg_m2;
    double traction_n; /* the most force between wheels and floor */
    double turn_traction_nm;
};

struct drive {
    struct drive_limits limits;
    double aim_forward_m_s, aim_turn_rad_s; /* the wanted speed */
    double forward_m_s, turn_rad_s;         /* the speed of the wheels */
    double held_up_s;                       /* time for which the wheels have turned in vain */
};

/* In the robot's frame: forward, to the left, and about the vertical axis. */
struct drive_motion {
    double forward_m_s, left_m_s, turn_rad_s;
};
struct drive_force {
    double forward_n, left_n, turn_nm;
};

/** Starts at rest. speed_max_m_s is the limit that the world sets, whatever the robot can do. */
void drive_init(struct drive *drive, const struct world_robot *robot, double inertia_kg_m2,
                double speed_max_m_s);

/** Sets the mass and inertia of the body with its load. */
void drive_load(struct drive *drive, double mass_kg, double inertia_kg_m2);

/** Stops the wheels at once, after the body was put somewhere else. */
void drive_halt(struct drive *drive);

/**
 * Sets the aim, clamped to the limits, and writes the clamped values back.  Both must be finite.
 */
void drive_aim(struct drive *drive, double *forward_m_s, double *turn_rad_s);

/** Turns the wheels for dt_s.  @return the force on a body that moves as given */
struct drive_force drive_run(struct drive *drive, const struct drive_motion *motion, double dt_s);

/** Compares the motion of the body after dt_s with that of the wheels, to detect a stall. */
void drive_watch(struct drive *drive, const struct drive_motion *motion, double dt_s);

/** @return whether the body has been held up for 0.3 s while the wheels turned */
bool drive_stalled(const struct drive *drive);

/* --- odometer --------------------------------------------------------------------------------- */

/*
 * The pose that a robot estimates from its wheels.  The odometer counts the wheels and not the
 * body: it does not notice slip or a push.
 */

struct odometer {
    struct world_pose pose;         /* estimated; heading in (-pi, pi] */
    double forward_gain, turn_gain; /* reading per true unit; 1: exact */
    double c, s; /* cosine and sine of the heading in the middle of the last step */
    bool turned; /* the heading has changed since c and s were computed */
};

/**
 * Starts at the pose in the file, or at the robot's own pose.  The gains depend on the seed and the
 * robot.
 */
void odometer_init(struct odometer *odometer, const struct world_robot *robot, uint64_t seed,
                   uint32_t index);

/** Counts the wheels for dt_s. */
void odometer_run(struct odometer *odometer, double forward_m_s, double turn_rad_s, double dt_s);

/* --- GPS and compass -------------------------------------------------------------------------- */

/* Absolute position and compass: exact, or with noise and with a drift that is a random walk. */

struct gps {
    double noise_m, compass_noise_rad;
    double drift_m;          /* standard deviation per control step, along each axis */
    double off_x_m, off_y_m; /* drift so far */
};

/* The robot and the control step of a reading. */
struct gps_when {
    uint64_t seed, robot, tick;
};

/* One reading. */
struct gps_fix {
    double x_m, y_m, compass_rad; /* compass in (-pi, pi] */
};

void gps_init(struct gps *gps, const struct world_robot *robot, double step_s);

/** Adds the drift of one control step. */
void gps_walk(struct gps *gps, const struct gps_when *when);

/** Reads position and compass.  The same time gives the same reading. */
struct gps_fix gps_read(const struct gps *gps, struct world_pose pose, const struct gps_when *when);

/* --- battery ---------------------------------------------------------------------------------- */

struct battery {
    double joules, full_j; /* full_j 0: there is no battery, and power never ends */
    double power_w;        /* consumed at all times */
    double take_w;         /* the most power that it can be charged with */
};

void battery_init(struct battery *battery, const struct world_robot *robot);

/**
 * Consumes and charges for dt_s.
 *
 * @param drive_w  mechanical power of the wheels, beside power_w
 * @param give_w   power that a charger at the robot's side offers; 0: no charger
 */
void battery_run(struct battery *battery, double drive_w, double give_w, double dt_s);

/** @return whether the battery is empty; an empty robot does not move */
bool battery_is_empty(const struct battery *battery);

/** @return the charge as a share of full; -1: there is no battery */
double battery_share(const struct battery *battery);

/* --- gripper ---------------------------------------------------------------------------------- */

/*
 * Two paddles at the front of a robot: their motion and their poses.  The engine decides which
 * object they take, and whether there is room (engine/grip.c).
 */

enum { GRIPPER_NOTHING = -1, GRIPPER_PADDLES = 2 };

/* Time from open to closed, and from down to up. */
#define GRIPPER_TIME_S 1.0

struct gripper {
    const struct world_gripper *make; /* NULL: the robot has no gripper */
    bool closes, lifts;               /* the wanted state */
    double closed, lifted;            /* the present state, 0 to 1 */
    int32_t holds;                    /* number of an object, or GRIPPER_NOTHING */
    double c, s; /* cosine and sine of the heading of the case in the robot's frame */
};

void gripper_init(struct gripper *gripper, const struct world_robot *robot);

/** @return whether the paddles are up, where they touch nothing */
bool gripper_is_up(const struct gripper *gripper);

/** @return how far the paddles are closed dt_s later */
double gripper_next_closed(const struct gripper *gripper, double dt_s);

/** @return how far the paddles are lifted dt_s later */
double gripper_next_lifted(const struct gripper *gripper, double dt_s);

/** @return paddle 0 (left) or 1 (right), at the pose that belongs to `closed` */
struct solid gripper_paddle(const struct gripper *gripper, const struct frame *frame, int paddle,
                            double closed);

/**
 * @param beam  out: the light between the paddles, at their tips (outer) or roots
 * @return false: the paddles are closed and there is no beam
 */
bool gripper_beam(const struct gripper *gripper, const struct frame *frame, bool outer,
                  struct solid *beam);

/** @return whether a point lies between the paddles, if they were closed that far */
bool gripper_spans(const struct gripper *gripper, const struct frame *frame, const double point[2],
                   double closed);

#endif
