/* SPDX-License-Identifier: Apache-2.0 */
/* How rules drive the body. */
#include "mind/functions/table.h"

#include <math.h>

/* speed-to: mm/s for each mm of distance, deg/s for each deg of bearing, and the most of both. */
enum { SPEED_MAX_MM_S = 450, TURN_MAX_DEG_S = 80 };
static const double speed_gain = 0.9;
static const double turn_gain = 1.6;

void motion_speed_to(void *env, DATA_OBJECT *out)
{
    double a[5]; /* x y compass tx ty */
    EnvSetMultifieldErrorValue(env, out);
    if (!value_numbers(env, "speed-to", 5, a)) {
        return;
    }
    double dx = a[3] - a[0];
    double dy = a[4] - a[1];
    double far =
        hypot(dx, dy) - environment_global(environment_mind(env), ENVIRONMENT_FOLLOW_DISTANCE);
    double error = far > -500 ? value_norm_deg(atan2(dy, dx) * VALUE_DEG - a[2]) : 0;
    /* a robot that looks away from the point turns first */
    double ahead = fabs(error) < 90 ? cos(error / VALUE_DEG) : 0;
    double speed = fmax(0, fmin(far * speed_gain, SPEED_MAX_MM_S)) * ahead * ahead;
    double turn = fmax(-TURN_MAX_DEG_S, fmin(error * turn_gain, TURN_MAX_DEG_S));
    value_floats(env, out, 2, (double[]){speed, turn});
}

static double physical_clamp(double x, double limit)
{
    return limit > 0 ? fmax(-limit, fmin(x, limit)) : x;
}

static void motion_drive(struct mind *m, double forward_m_s, double turn_rad_s)
{
    output_of(m)->act.drives = true;
    output_of(m)->act.forward_m_s = forward_m_s;
    output_of(m)->act.turn_rad_s = turn_rad_s;
    trace_speed(m, forward_m_s, turn_rad_s);
}

void motion_set_speed(void *env, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    double speed[2];
    value_bool(env, out, false);
    if (!value_numbers(env, "setSpeed", 2, speed) || !sensors_have_body(env, "setSpeed")) {
        return;
    }
    if (!isfinite(speed[0]) || !isfinite(speed[1])) {
        value_refuse(env, "setSpeed", "finite numbers: a speed in mm/s and a turn rate in deg/s");
        return;
    }
    motion_drive(m, physical_clamp(speed[0] / 1000, m->options.forward_max_m_s),
                 physical_clamp(speed[1] / VALUE_DEG, m->options.turn_max_rad_s));
    value_bool(env, out, true);
}

void motion_stop(void *env, DATA_OBJECT *out)
{
    bool has = sensors_have_body(env, "stop");
    if (has) {
        motion_drive(environment_mind(env), 0, 0);
    }
    value_bool(env, out, has);
}

void motion_update_sensors(void *env, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    output_of(m)->sense_again = output_of(m)->sense_again || m->state == MIND_FIRING;
    value_bool(env, out, m->state == MIND_FIRING);
}
