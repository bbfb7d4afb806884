/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file ode_world.h
 * Rigid bodies in the plane, moved by ODE.  Nothing else of muster sees ODE.
 *
 * Each body moves in x, y and heading alone: all forces and contacts lie in the plane, so that
 * height, roll and pitch stay exactly 0.  There is one such world in a process.
 */
#ifndef MUSTER_SIM_ODE_WORLD_H
#define MUSTER_SIM_ODE_WORLD_H

#include "sim/engine/engine.h"

enum { ODE_WORLD_STANDS = -1 };

struct ode_body_size {
    double mass_kg, length_m, width_m;
    double middle_x_m, middle_y_m; /* of the outline, seen from the body's own point */
    bool disc;                     /* its length is its diameter */
};

/* What the rest of the simulator wants to know of a body. */
struct ode_motion {
    double x, y, c, s;   /* pose; cosine and sine of the heading */
    double vx, vy, turn; /* in the world's frame */
};

/** Starts ODE with room for so many bodies. */
void ode_world_open(size_t bodies_max);

void ode_world_close(void);

/** Adds the next body, numbered from 0.  @return its moment of inertia at its own point, kg m2 */
double ode_world_add(const struct ode_body_size *size, struct world_pose pose);

void ode_world_motion(size_t body, struct ode_motion *motion);

/** Position, quaternion (w x y z), linear and angular velocity. */
void ode_world_state(size_t body, double state[ENGINE_STATE_DOUBLES]);

/** Puts a body into a state that ode_world_state gave, bit for bit, without forces on it. */
void ode_world_set_state(size_t body, const double state[ENGINE_STATE_DOUBLES]);

/** Puts a body at a place, at rest. */
void ode_world_put(size_t body, double x, double y, double heading_rad);

/** Moves a body to a place; it goes on as it went. */
void ode_world_shift(size_t body, double x, double y);

/** Gives a body a velocity, in the world's frame. */
void ode_world_set_velocity(size_t body, double vx, double vy, double turn);

/** Makes a body lighter or heavier: what it carries moves with it. */
void ode_world_weigh(size_t body, double mass_kg, double inertia_kg_m2);

/** Takes a body out of the steps, or into them; it comes back by itself when another one touches
 * it. */
void ode_world_sleep(size_t body, bool sleeps);

/** Lays a body on the floor, which rubs on it from now on. */
void ode_world_add_friction(size_t body);

/* What the floor can bring against a body: along a direction, across it, and against its turn. */
struct ode_friction {
    double along_x, along_y; /* a unit vector */
    double along_n, across_n, turn_nm;
};

/** Sets the friction of a body that lies on the floor, for the steps that come. */
void ode_world_set_friction(size_t body, const struct ode_friction *friction);

/** Pushes a body for the next step, in the world's frame; all finite. */
void ode_world_push(size_t body, double fx_n, double fy_n, double torque_nm);

/** Keeps two bodies, or one and what stands (b is ODE_WORLD_STANDS), apart in the next step. */
void ode_world_touch(size_t a, int b, const struct narrow_contact *contact);

/** Moves all bodies on.  The same seed and state give the same bits. */
void ode_world_step(double dt_s, uint64_t seed);

#endif
