/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file engine.h
 * The physics and the senses of one world, without clock, file or network.
 *
 * The same world, options and commands give the same bits, on one machine and the next.  One
 * thread.  ODE stays behind this header.  Robots are numbered as in struct world.
 */
#ifndef MUSTER_SIM_ENGINE_H
#define MUSTER_SIM_ENGINE_H

#include "muster/result.h"
#include "world/world.h"

#include <stdint.h>

struct engine_options {
    uint64_t seed;
    uint64_t step_ns;    /* of a control step; a multiple of substep_ns */
    uint64_t substep_ns; /* of the physics; 20 ms when 0 */
};

/* What a robot feels and sees. */
struct engine_percept {
    struct world_pose pose;         /* heading in (-pi, pi] */
    double forward_m_s, turn_rad_s; /* as it really moves, in its own frame */
    bool stalled;                   /* its wheels have been held up for 0.3 s */
    size_t sonar_count;
    float sonar_m[MU_SONARS_MAX];
};

/* Bit for bit the state of a body: x, y, z; quaternion w, x, y, z; linear and angular velocity. */
enum { ENGINE_STATE_DOUBLES = 13 };

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

/** Moves the world on by one control step. */
void engine_step(struct engine *e);

/** Reads a robot's senses as of now. */
void engine_sense(struct engine *e, size_t robot, struct engine_percept *out);

/** Copies the state that the run's hash is made of. */
void engine_state(const struct engine *e, size_t robot, double state[ENGINE_STATE_DOUBLES]);

#endif
