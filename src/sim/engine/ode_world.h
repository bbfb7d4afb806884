/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file ode_world.h
 * Rigid bodies in the plane, moved by ODE. No other file includes ODE's headers.
 *
 * A body moves in x, y and heading alone.  All forces and contacts lie in the plane, so that
 * height, roll and pitch stay exactly 0.  A process has one such world.
 */
#ifndef MUSTER_SIM_ODE_WORLD_H
#define MUSTER_SIM_ODE_WORLD_H

#include "sim/engine/engine.h"

enum { ODE_WORLD_STANDS = -1 };

struct ode_body_size {
    double mass_kg, length_m, width_m;
    double middle_x_m, middle_y_m; /* of the outline, in the body's frame */
    bool disc;                     /* length_m is its diameter */
};

/* The motion of a body in the plane. */
struct ode_motion {
    double x, y, c, s;   /* pose; cosine and sine of the heading */
    double vx, vy, turn; /* in the world's frame */
};

/** Starts ODE, and takes memory for that many bodies. */
void ode_world_open(size_t bodies_max);

void ode_world_close(void);

/**
 * Adds the next body, numbered from 0.  @return its moment of inertia about its own point, in kg m2
 */
double ode_world_add(const struct ode_body_size *size, struct world_pose pose);

void ode_world_motion(size_t body, struct ode_motion *motion);

/** Writes position, quaternion (w x y z), linear and angular velocity. */
void ode_world_state(size_t body, double state[ENGINE_STATE_DOUBLES]);

/** Sets a state that ode_world_state gave, bit for bit, and removes all forces. */
void ode_world_set_state(size_t body, const double state[ENGINE_STATE_DOUBLES]);

/** Puts a body at a pose, at rest. */
void ode_world_put(size_t body, double x, double y, double heading_rad);

/** Moves a body to a position.  Its velocity does not change. */
void ode_world_shift(size_t body, double x, double y);

/** Sets the velocity of a body, in the world's frame. */
void ode_world_set_velocity(size_t body, double vx, double vy, double turn);

/** Sets mass and inertia of a body with its load. */
void ode_world_weigh(size_t body, double mass_kg, double inertia_kg_m2);

/**
 * Excludes a body from the steps, or includes it again.  A contact with another body also wakes it.
 */
void ode_world_sleep(size_t body, bool sleeps);

/** Adds friction of the floor to a body, with the limits that ode_world_set_friction sets. */
void ode_world_add_friction(size_t body);

/* The most friction against a body: along a direction, across it, and against its turn. */
struct ode_friction {
    double along_x, along_y; /* a unit vector */
    double along_n, across_n, turn_nm;
};

/** Sets the friction of a body, for all later steps. */
void ode_world_set_friction(size_t body, const struct ode_friction *friction);

/** Pushes a body in the next step, in the world's frame.  All numbers must be finite. */
void ode_world_push(size_t body, double fx_n, double fy_n, double torque_nm);

/** Adds a contact for the next step, between two bodies, or a body and ODE_WORLD_STANDS. */
void ode_world_touch(size_t a, int b, const struct narrow_contact *contact);

/** Moves all bodies by one step.  The same seed and state give the same bits. */
void ode_world_step(double dt_s, uint64_t seed);

#endif
