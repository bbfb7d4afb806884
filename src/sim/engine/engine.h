/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file engine.h
 * Physics and sensors of one world, without clock, file or network.
 *
 * The same world, options and commands give the same bits on all machines, with any number of
 * threads.  Robots are numbered as in struct world.  No user of this header sees ODE.
 */
#ifndef MUSTER_SIM_ENGINE_H
#define MUSTER_SIM_ENGINE_H

#include "muster/result.h"
#include "sim/sensors/sensors.h"

struct engine_options {
    uint64_t seed;
    uint64_t step_ns; /* one control step; a multiple of 20 ms, the step of the physics */
    size_t threads;   /* threads that read sensors, including the caller's; 0: one */
};

/* The exact state of a body: x, y, z; quaternion w, x, y, z; linear and angular velocity. */
enum { ENGINE_STATE_DOUBLES = 13 };

/*
 * A push from outside, in the world's frame: a force for a time.  If time_s is 0, the numbers are
 * an impulse, in N s and N m s.
 */
struct engine_force {
    double x_n, y_n, turn_nm;
    double time_s;
};

/** Builds the bodies of a world, which must outlive the engine.  A process has one engine. */
struct engine *engine_open(const struct world *world, const struct engine_options *options);

void engine_close(struct engine *e);

/**
 * Sets the speed that a robot's wheels approach, from the next engine_step on.  Finite values are
 * clamped to the limits of the body.
 *
 * @param forward_m_s, turn_rad_s  in: the wanted speed; out: the clamped speed
 * @return MU_OK; MU_REFUSED: a value is not finite, and the old speed stays
 */
MU_MUST_USE mu_result engine_command(struct engine *e, size_t robot, double *forward_m_s,
                                     double *turn_rad_s);

/**
 * Commands a gripper: paddles open (-1), close (1) or stay (0); lift goes down, up or stays.  Each
 * takes a second.  Closing paddles take a graspable object between them.  A held object moves with
 * the robot as one body, and touches nothing while it is up.  Opening paddles release it where it
 * is.
 *
 * @return MU_OK; MU_ABSENT: the robot has no gripper; MU_REFUSED: the held object has no room
 *         below, and the gripper stays as it is
 */
MU_MUST_USE mu_result engine_grip(struct engine *e, size_t robot, int32_t paddles, int32_t lift);

/** Runs one control step. */
void engine_step(struct engine *e);

/* A robot in one step: its percept, and data that only the simulator has. */
struct engine_sample {
    struct mu_percept percept; /* without name and time; its lists are valid until the next step */
    struct world_pose pose;    /* true pose; heading in (-pi, pi] */
    bool placed;               /* put there from outside: it did not drive there */
};

/**
 * Reads the wanted sensors of every robot.
 *
 * An unwanted sensor costs no time and has an empty reading.  A sensor that is not due keeps its
 * last reading.
 *
 * @param wanted  for each robot, bits of enum mu_sense
 * @return one percept per robot, owned by the engine, valid until the next step or reading
 */
const struct engine_sample *engine_sense_all(struct engine *e, const uint32_t wanted[]);

/** @return the percept with the true pose and without lists, as observers see it */
struct mu_percept engine_truth(const struct engine_sample *sample);

/** @return the number of bodies: all robots, then all objects, numbered as in struct world */
size_t engine_body_count(const struct engine *e);

/** @return the pose of a body; heading in (-pi, pi] */
struct world_pose engine_pose(const struct engine *e, size_t body);

/** Copies the state of a body, from which the hash of the run is computed. */
void engine_state(const struct engine *e, size_t body, double state[ENGINE_STATE_DOUBLES]);

/*
 * Changes from outside, between two steps.  In case of a refusal, `reason` receives its text.  The
 * engine owns the text, which is valid until the next such call.
 */

/**
 * Puts a body at another pose, at rest.  A robot keeps the object that it holds.
 *
 * @return MU_OK; MU_REFUSED: the body would overlap something or lie outside the world, or is held
 */
MU_MUST_USE mu_result engine_place(struct engine *e, size_t body, struct world_pose pose,
                                   const char **reason);

/** Pushes a body from the next step on; an earlier push ends.  @return as engine_place */
MU_MUST_USE mu_result engine_push(struct engine *e, size_t body, const struct engine_force *force,
                                  const char **reason);

/**
 * Resets a body to its start, a robot with its devices.  An object that the robot holds stays where
 * it is.
 *
 * @return as engine_place: another body may stand there now
 */
MU_MUST_USE mu_result engine_reset(struct engine *e, size_t body, const char **reason);

/** Resets all bodies to their start.  Time goes on. */
void engine_reset_all(struct engine *e);

/** @return the version of ODE: "0.16.2" */
const char *ode_world_version(void);

/** @return the size of a snapshot of this engine, in bytes */
size_t engine_save_size(const struct engine *e);

/**
 * Writes all state that changes in a run: bodies, drives, devices, counters.  All machines write
 * the same bytes.
 *
 * @param bytes  room for engine_save_size bytes
 */
void engine_save(struct engine *e, unsigned char *bytes);

/**
 * Restores a snapshot.  From then on, the same commands give the same bits as in the engine that
 * wrote it.  After a refusal nothing has changed.
 *
 * @return MU_OK; MU_MALFORMED: not a whole snapshot of this version; MU_REFUSED: the snapshot is of
 *         another world, seed or step
 */
MU_MUST_USE mu_result engine_restore(struct engine *e, const unsigned char *bytes, size_t count,
                                     const char **reason);

#endif
