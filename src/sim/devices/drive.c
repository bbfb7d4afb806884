/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/devices/devices.h"

/* Coefficient of rubber on a hard floor. */
#define DRIVE_FRICTION 0.6

/* Distance of a wheel from the middle, as a share of the width. */
#define DRIVE_WHEEL_AT 0.4

/*
 * A stall: the wheels turn faster than the first two, and the body moves less than a quarter of it.
 */
#define DRIVE_STALL_FORWARD_M_S 0.02
#define DRIVE_STALL_TURN_RAD_S  0.05
#define DRIVE_STALL_PART        0.25
#define DRIVE_STALL_AFTER_S     0.3

static double drive_clamp(double value, double least, double most)
{
    return value < least ? least : value > most ? most : value;
}

void drive_init(struct drive *drive, const struct world_robot *robot, double inertia_kg_m2,
                double speed_max_m_s)
{
    *drive = (struct drive){
        .limits = {.forward_max_m_s = fmin(robot->forward_max_m_s, speed_max_m_s),
                   .reverse_max_m_s = fmin(robot->reverse_max_m_s, speed_max_m_s),
                   .turn_max_rad_s = robot->turn_max_rad_s,
                   .forward_accel_m_s2 = robot->forward_accel_m_s2,
                   .turn_accel_rad_s2 = robot->turn_accel_rad_s2,
                   .width_m = robot->width_m},
    };
    drive_load(drive, robot->mass_kg, inertia_kg_m2);
}

void drive_load(struct drive *drive, double mass_kg, double inertia_kg_m2)
{
    struct drive_limits *l = &drive->limits;
    l->mass_kg = mass_kg;
    l->inertia_kg_m2 = inertia_kg_m2;
    l->traction_n = DRIVE_FRICTION * mass_kg * DRIVE_GRAVITY_M_S2;
    l->turn_traction_nm = l->traction_n * DRIVE_WHEEL_AT * l->width_m;
}

void drive_halt(struct drive *drive)
{
    drive->forward_m_s = 0;
    drive->turn_rad_s = 0;
    drive->held_up_s = 0;
}

void drive_aim(struct drive *drive, double *forward_m_s, double *turn_rad_s)
{
    const struct drive_limits *l = &drive->limits;
    *forward_m_s = drive_clamp(*forward_m_s, -l->reverse_max_m_s, l->forward_max_m_s);
    *turn_rad_s = drive_clamp(*turn_rad_s, -l->turn_max_rad_s, l->turn_max_rad_s);
    drive->aim_forward_m_s = *forward_m_s;
    drive->aim_turn_rad_s = *turn_rad_s;
}

static double drive_ramp(double now, double aim, double change_max)
{
    return now + drive_clamp(aim - now, -change_max, change_max);
}

static bool drive_held_up(double wheels, double body, double least)
{
    return fabs(wheels) > least && fabs(body) < DRIVE_STALL_PART * fabs(wheels);
}

struct drive_force drive_run(struct drive *drive, const struct drive_motion *motion, double dt_s)
{
    const struct drive_limits *l = &drive->limits;
    drive->forward_m_s =
        drive_ramp(drive->forward_m_s, drive->aim_forward_m_s, l->forward_accel_m_s2 * dt_s);
    drive->turn_rad_s =
        drive_ramp(drive->turn_rad_s, drive->aim_turn_rad_s, l->turn_accel_rad_s2 * dt_s);
    double forward = l->mass_kg * (drive->forward_m_s - motion->forward_m_s) / dt_s;
    double left = -l->mass_kg * motion->left_m_s / dt_s;
    double turn = l->inertia_kg_m2 * (drive->turn_rad_s - motion->turn_rad_s) / dt_s;
    return (struct drive_force){
        .forward_n = drive_clamp(forward, -l->traction_n, l->traction_n),
        .left_n = drive_clamp(left, -l->traction_n, l->traction_n),
        .turn_nm = drive_clamp(turn, -l->turn_traction_nm, l->turn_traction_nm),
    };
}

void drive_watch(struct drive *drive, const struct drive_motion *motion, double dt_s)
{
    bool forward = drive_held_up(drive->forward_m_s, motion->forward_m_s, DRIVE_STALL_FORWARD_M_S);
    bool turn = drive_held_up(drive->turn_rad_s, motion->turn_rad_s, DRIVE_STALL_TURN_RAD_S);
    drive->held_up_s = forward || turn ? drive->held_up_s + dt_s : 0;
}

bool drive_stalled(const struct drive *drive)
{
    return drive->held_up_s > DRIVE_STALL_AFTER_S - 1e-6; /* sums of steps are not exact */
}
