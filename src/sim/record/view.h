/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file view.h
 * Puts a Frame together: all of one step, as observers see it.
 *
 * No clock and no network.  What others own is copied as it comes, into memory that was taken at
 * start-up; what does not fit is left out and counted.
 */
#ifndef MUSTER_SIM_VIEW_H
#define MUSTER_SIM_VIEW_H

#include "sim/engine/engine.h"
#include "sim/record/orders.h"
#include "sim/record/tally.h"
#include "wire.h"

struct view; /* one in a process */

/** Takes the memory for Frames of a world.  @param simulator  its name; stays with the caller */
struct view *view_open(const struct world *world, const char *simulator);

/** Begins the Frame of a step: without percepts and orders.  Acts stay until view_clear. */
void view_begin(struct view *v, int64_t step, uint64_t time_ns);

/** Says where a robot is, how it moves, and what it has come to. */
void view_take_body(struct view *v, size_t robot, const struct engine_percept *percept,
                    const struct tally *tally);

/** Says where an object is. */
void view_take_object(struct view *v, size_t object, struct world_pose pose);

/** Adds what a robot was sent.  What the percept points to must stay until the Frame is used. */
void view_add_percept(struct view *v, const muster_Percept *percept);

/** Adds what a robot did, or, numbered behind the robots, an agent without a body.  A Frame has
 * acts in that order, then as they came. */
void view_add_act(struct view *v, size_t robot, const muster_Act *act);

/** Keeps mails from outside, until they are taken: step is that of the Frame that shows them. */
void view_add_outside(struct view *v, int64_t step, const muster_Mail *mails, uint32_t count);

/** Adds an order that was carried out. */
void view_add_order(struct view *v, const muster_RunCommand *order);

/** @return the robot's line in the Frame: state, commands and counters are the caller's to set */
muster_RobotView *view_robot(struct view *v, size_t robot);

/** @return the Frame, good until the next call of any of these; digest and wall_ns are the
 *          caller's to set */
muster_Frame *view_finish(struct view *v);

/** Forgets the acts. */
void view_clear(struct view *v);

/** @return how many acts and mails were left out since the beginning */
uint64_t view_left_out(const struct view *v);

#endif
