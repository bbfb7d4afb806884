/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file engine.h
 * The physics and the senses of one world, without clock, file or network.
 *
 * The same world, options and commands give the same bits, on one machine and the next, with any
 * number of threads.  ODE stays behind this header.  Robots are numbered as in struct world.
 */
#ifndef MUSTER_SIM_ENGINE_H
#define MUSTER_SIM_ENGINE_H

#include "muster/result.h"
#include "sim/sensors/sensors.h"

struct engine_options {
    uint64_t seed;
    uint64_t step_ns;    /* of a control step; a multiple of substep_ns */
    uint64_t substep_ns; /* of the physics; 20 ms when 0 */
    size_t threads;      /* that read the sensors, the caller's included; 0: one */
};

/* Bit for bit the state of a body: x, y, z; quaternion w, x, y, z; linear and angular velocity. */
enum { ENGINE_STATE_DOUBLES = 13 };

/*
 * A push from outside, in the world's frame: a force for a time, or, if time_s is 0, an impulse in
 * N s and N m s.
 */
struct engine_force {
    double x_n, y_n, turn_nm;
    double time_s;
};

/** Builds the bodies.  The world must outlive the engine; one engine in a process. */
struct engine *engine_open(const struct world *world, const struct engine_options *options);

void engine_close(struct engine *e);

/**
 * Sets the speed that a robot's wheels aim at from the next engine_step on.
 *
 * Finite values are clamped to the body's limits.
 *
 * @param forward_m_s, turn_rad_s  in: what is wanted; out: what the body will aim at
 * @return MU_OK, or MU_REFUSED when a value is NaN or infinite (the old aim stays)
 */
MU_MUST_USE mu_result engine_command(struct engine *e, size_t robot, double *forward_m_s,
                                     double *turn_rad_s);

/**
 * Tells a robot's gripper what to do: open (-1), close (1) or stay (0); go down, up or stay.
 *
 * Each takes a second.  Paddles that close on a graspable thing between them take it; it then moves
 * as one body with the robot, and touches nothing while it is up.  They let it go where it is.
 *
 * @return MU_OK; MU_ABSENT: it has no gripper; MU_REFUSED: there is no room for what it would let
 *         down or go, and it stays as it is
 */
MU_MUST_USE mu_result engine_grip(struct engine *e, size_t robot, int32_t paddles, int32_t lift);

/** Moves the world on by one control step. */
void engine_step(struct engine *e);

/* All bits of enum world_sensor. */
#define ENGINE_ALL_SENSES ((1u << WORLD_SENSORS) - 1)

/**
 * Reads what is asked for, of every robot, as of now.
 *
 * A sensor that nobody asks for costs nothing, and reads empty.  One that is not due keeps its
 * reading.
 *
 * @param wanted  for each robot the bits 1 << enum world_sensor
 * @return what each robot feels and sees; the engine's, good until the next step or reading
 */
const struct engine_percept *engine_sense_all(struct engine *e, const uint32_t wanted[]);

/** @return how many bodies there are: the robots, then the objects, each as in struct world */
size_t engine_body_count(const struct engine *e);

/** @return where a body is; heading in (-pi, pi] */
struct world_pose engine_pose(const struct engine *e, size_t body);

/** Copies the state of a body that the run's hash is made of. */
void engine_state(const struct engine *e, size_t body, double state[ENGINE_STATE_DOUBLES]);

/*
 * Changes from outside, between two steps.  reason receives why one was refused, for a person to
 * read; it is the engine's, good until the next such call.
 */

/**
 * Puts a body somewhere else, at rest.  A robot takes along what it holds.
 *
 * @return MU_OK; MU_REFUSED: it would overlap something, lie outside the world, or is being held
 */
MU_MUST_USE mu_result engine_place(struct engine *e, size_t body, struct world_pose pose,
                                   const char **reason);

/** Pushes a body from the next step on, in place of an earlier push.  @return as engine_place */
MU_MUST_USE mu_result engine_push(struct engine *e, size_t body, const struct engine_force *force,
                                  const char **reason);

/**
 * Puts a body to where it started, its devices as they were then.  What a robot holds stays where
 * it is.
 *
 * @return as engine_place: another may stand there now
 */
MU_MUST_USE mu_result engine_reset(struct engine *e, size_t body, const char **reason);

/** Puts all bodies to where they started.  Time goes on. */
void engine_reset_all(struct engine *e);

/** @return the version of ODE, "0.16.2" */
const char *ode_world_version(void);

/** @return how many bytes a snapshot of this engine takes */
size_t engine_save_size(const struct engine *e);

/**
 * Writes all that the engine will need to go on as if nothing had been: bodies, drives, devices,
 * counters.  The same bytes on every machine.  bytes: room for engine_save_size of them.
 */
void engine_save(struct engine *e, unsigned char *bytes);

/**
 * Takes over a snapshot.  Without a fault the same commands give the same bits as they would have
 * given there; with one nothing has changed.
 *
 * @return MU_OK; MU_MALFORMED: not a whole snapshot of this version; MU_REFUSED: it was taken of
 *         another world, or with another seed or step
 */
MU_MUST_USE mu_result engine_restore(struct engine *e, const unsigned char *bytes, size_t count,
                                     const char **reason);

#endif
