/* SPDX-License-Identifier: Apache-2.0 */
/*
 * (clear-way want [far]): a direction that is free by the sonars.  This is the arithmetic of
 * obstacle avoidance over the whole ring; rules/avoid.clp decides what to do with the answer.
 */
#include "mind/functions/table.h"

#include <math.h>

enum { WAY_FRONT = 8 };

/* Where s0 to s7 look, in degrees. */
static const double way_angles[WAY_FRONT] = {90, 50, 30, 10, -10, -30, -50, -90};

/*
 * Factors on the ranges: an obstacle aside counts less, as the body passes by it; s0 and s7 do not
 * count.
 */
static const double way_passes[WAY_FRONT] = {0, 3.5, 2, 1, 1, 2, 3.5, 0};

static const double way_nothing_mm = 5000; /* the range when nothing is seen */

/* A range exceeds its neighbours by at most this: an edge in one beam may reach into the next. */
static const double way_slope_mm = 200;

/* The cost of a direction, in degrees off the wanted one. */
static const double way_cost_deg_mm = 0.15; /* for each mm less than ?*care* */
static const double way_cost_turn = 0.35;   /* for each degree off where the body turns already */
static const double way_turn_s = 1.5;       /* a body that turns at w deg/s turns by w / this */

static const double way_same_deg = 25;  /* the wanted direction wins over one so near to it */
static const double way_aside_deg = 27; /* the least turn to a side when there is no room ahead */

/* How the body leans away from an obstacle close at one side. */
static const double way_close_mm = 380;
static const double way_lean_deg_mm = 0.15;

static double way_range(const double ring_mm[WAY_FRONT], size_t i)
{
    double left = i > 0 ? ring_mm[i - 1] + way_slope_mm : way_nothing_mm;
    double right = i + 1 < WAY_FRONT ? ring_mm[i + 1] + way_slope_mm : way_nothing_mm;
    return fmin(ring_mm[i], fmin(left, right));
}

static double way_direction(const double ring_mm[WAY_FRONT], double want_deg, double turns_deg,
                            double care_mm)
{
    double best_deg = 0;
    double least = INFINITY;
    for (size_t i = 0; i < WAY_FRONT; i++) {
        double angle = way_angles[i];
        double near_mm = fmax(0, care_mm - way_range(ring_mm, i));
        double cost = fabs(angle - want_deg) + way_cost_deg_mm * near_mm +
                      way_cost_turn * fabs(angle - turns_deg);
        if (cost < least) {
            least = cost;
            best_deg = angle;
        }
    }
    return fabs(best_deg - want_deg) <= way_same_deg ? want_deg : best_deg;
}

static double way_room(const double ring_mm[WAY_FRONT])
{
    double room_mm = way_nothing_mm;
    for (size_t i = 1; i + 1 < WAY_FRONT; i++) {
        room_mm = fmin(room_mm, way_passes[i] * ring_mm[i]);
    }
    return room_mm;
}

/* Degrees to the left. */
static double way_lean(const double ring_mm[WAY_FRONT])
{
    double left_mm = fmin(ring_mm[0], fmin(ring_mm[1], ring_mm[2]));
    double right_mm = fmin(ring_mm[5], fmin(ring_mm[6], ring_mm[7]));
    return way_lean_deg_mm * (fmax(0, way_close_mm - right_mm) - fmax(0, way_close_mm - left_mm));
}

void avoidance_clear_way(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    double arg[2] = {0, INFINITY};
    double ring_mm[WAY_FRONT];
    EnvSetMultifieldErrorValue(env, out);
    if (!sensors_have_body(env, "clear-way") ||
        !value_numbers(env, "clear-way", EnvRtnArgCount(env), arg)) {
        return;
    }
    for (size_t i = 0; i < WAY_FRONT; i++) {
        bool seen = inputs_of(m)->percept.sonar_count >= WAY_FRONT &&
                    (double)inputs_of(m)->percept.sonar_m[i] * 1000 <= arg[1];
        ring_mm[i] = seen ? (double)inputs_of(m)->percept.sonar_m[i] * 1000 : way_nothing_mm;
    }
    double want_deg = fmax(-90, fmin(value_norm_deg(arg[0]), 90));
    double turns_deg = inputs_of(m)->percept.turn_rad_s * VALUE_DEG / way_turn_s;
    double way_deg = way_direction(ring_mm, want_deg, fmax(-90, fmin(turns_deg, 90)),
                                   environment_global(m, ENVIRONMENT_CARE));
    way_deg += way_lean(ring_mm);
    double room_mm = fmax(0, way_room(ring_mm) - environment_global(m, ENVIRONMENT_SONAR_MARGIN));
    if (room_mm == 0 && fabs(way_deg) < way_aside_deg) {
        way_deg = copysign(way_aside_deg, way_deg);
    }
    value_floats(env, out, 2, (double[]){way_deg, room_mm});
}
