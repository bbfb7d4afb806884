/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file gripper.h
 * Two paddles at the front of a robot: how they move, and where they are.
 *
 * Which thing they take and whether there is room is the engine's to say (engine/grip.c).
 */
#ifndef MUSTER_SIM_GRIPPER_H
#define MUSTER_SIM_GRIPPER_H

#include "sim/geometry/solid.h"

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

/* The pose of the robot that bears it. */
struct gripper_frame {
    double x, y, c, s;
};

void gripper_init(struct gripper *gripper, const struct world_robot *robot);

/** @return whether the paddles are up, out of everybody's way */
bool gripper_is_up(const struct gripper *gripper);

/** @return how closed the paddles are after dt_s on their way to what is wanted */
double gripper_next_closed(const struct gripper *gripper, double dt_s);

/** @return how high they are then */
double gripper_next_lifted(const struct gripper *gripper, double dt_s);

/** @return a paddle, 0 the left one, where it would be if they were closed so far */
struct solid gripper_paddle(const struct gripper *gripper, const struct gripper_frame *frame,
                            int paddle, double closed);

/**
 * @param beam  receives the light between the paddles, at their tips (outer) or their roots
 * @return false: they are closed, there is none
 */
bool gripper_beam(const struct gripper *gripper, const struct gripper_frame *frame, bool outer,
                  struct solid *beam);

/** @return whether a point lies between the paddles if they were closed so far */
bool gripper_spans(const struct gripper *gripper, const struct gripper_frame *frame,
                   const double point[2], double closed);

#endif
