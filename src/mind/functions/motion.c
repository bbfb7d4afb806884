/* SPDX-License-Identifier: Apache-2.0 */
/* The body: what rules sense, and how they drive. */
#include "mind/functions/motion.h"

#include "mind/engine/value.h"
#include "mind/functions/table.h"

#include <math.h>

static const double physical_deg = 180 / 3.14159265358979323846;

/* speed-to: mm/s for each mm of distance, deg/s for each deg of bearing, and the most of both. */
enum { SPEED_MAX_MM_S = 450, TURN_MAX_DEG_S = 80 };
static const double speed_gain = 0.9;
static const double turn_gain = 1.6;

double clips_physical_norm(double angle_deg)
{
    double a = remainder(angle_deg, 360);
    return a <= -180 ? a + 360 : a;
}

void clips_physical_position(const struct mind_percept *p, double out[6])
{
    out[0] = (double)p->time_ns * 1e-9;
    out[1] = p->x_m * 1000;
    out[2] = p->y_m * 1000;
    out[3] = p->forward_m_s * 1000;
    out[4] = p->turn_rad_s * physical_deg;
    out[5] = clips_physical_norm(p->heading_rad * physical_deg);
}

void clips_physical_get_position(void *env, DATA_OBJECT *out)
{
    const struct mind *m = clips_env_mind(env);
    double values[6];
    if (!m->sensed) {
        EnvSetMultifieldErrorValue(env, out);
        return;
    }
    clips_physical_position(&m->percept, values);
    struct multifield *fields = EnvCreateMultifield(env, 7);
    for (size_t i = 0; i < 6; i++) {
        clips_value_set_float(env, fields, i, values[i]);
    }
    clips_value_set_symbol(env, fields, 6, m->percept.stalled ? "TRUE" : "FALSE");
    clips_value_multifield(out, fields);
}

void clips_physical_stalled(void *env, DATA_OBJECT *out)
{
    clips_value_bool(env, out, clips_env_mind(env)->percept.stalled);
}

void clips_physical_sonar(void *env, DATA_OBJECT *out)
{
    const struct mind *m = clips_env_mind(env);
    size_t count = m->percept.sonar_count;
    double ranges_mm[MU_SONARS_MAX];
    long long index;
    clips_value_bool(env, out, false);
    if (EnvRtnArgCount(env) == 0) {
        for (size_t i = 0; i < count; i++) {
            ranges_mm[i] = (double)m->sonar[i] * 1000;
        }
        clips_value_floats(env, out, count, ranges_mm);
        return;
    }
    if (!clips_value_whole(env, "sonar", 1, &index)) {
        return;
    }
    if ((index < 0 || (size_t)index >= count) && EnvRtnArgCount(env) == 2) {
        (void)clips_value_any(env, 2, out);
        return;
    }
    if (index < 0 || (size_t)index >= count) {
        clips_value_refuse(env, "sonar", "the index of a sonar that the body has, from 0");
        return;
    }
    clips_value_float(env, out, (double)m->sonar[index] * 1000);
}

/* Takes the least of an argument, a number or several.  @return false: it holds something else */
static bool physical_least(const DATA_OBJECT *value, double *least)
{
    if (value->type != MULTIFIELD) {
        *least = fmin(*least, clips_value_of(value->type, value->value));
        return value->type == FLOAT || value->type == INTEGER;
    }
    for (long i = value->begin; i <= value->end; i++) {
        const struct field *f = &((struct multifield *)value->value)->theFields[i];
        if (f->type != FLOAT && f->type != INTEGER) {
            return false;
        }
        *least = fmin(*least, clips_value_of(f->type, f->value));
    }
    return true;
}

void clips_physical_sonar_data(void *env, DATA_OBJECT *out)
{
    double least = INFINITY;
    int count = EnvRtnArgCount(env);
    clips_value_float(env, out, 0);
    for (int i = 1; i <= count; i++) {
        DATA_OBJECT value;
        if (!clips_value_any(env, i, &value)) {
            return;
        }
        if (!physical_least(&value, &least)) {
            clips_value_refuse(env, "sonar-data", "ranges in mm");
            return;
        }
    }
    const struct mind *m = clips_env_mind(env);
    double clip = clips_env_global(m, CLIPS_SONAR_CLIP);
    double clear = least - clips_env_global(m, CLIPS_SONAR_MARGIN);
    clips_value_float(env, out, fmax(0, fmin(clear, clip)));
}

void clips_physical_speed_to(void *env, DATA_OBJECT *out)
{
    double a[5]; /* x y compass tx ty */
    EnvSetMultifieldErrorValue(env, out);
    if (!clips_value_numbers(env, "speed-to", 5, a)) {
        return;
    }
    double dx = a[3] - a[0];
    double dy = a[4] - a[1];
    double far = hypot(dx, dy) - clips_env_global(clips_env_mind(env), CLIPS_FOLLOW_DISTANCE);
    double error = far > -500 ? clips_physical_norm(atan2(dy, dx) * physical_deg - a[2]) : 0;
    /* a robot that looks away from the point turns first */
    double ahead = fabs(error) < 90 ? cos(error / physical_deg) : 0;
    double speed = fmax(0, fmin(far * speed_gain, SPEED_MAX_MM_S)) * ahead * ahead;
    double turn = fmax(-TURN_MAX_DEG_S, fmin(error * turn_gain, TURN_MAX_DEG_S));
    clips_value_floats(env, out, 2, (double[]){speed, turn});
}

static double physical_clamp(double x, double limit)
{
    return limit > 0 ? fmax(-limit, fmin(x, limit)) : x;
}

void clips_physical_set_speed(void *env, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    double speed[2];
    clips_value_bool(env, out, false);
    if (!clips_value_numbers(env, "setSpeed", 2, speed)) {
        return;
    }
    if (!isfinite(speed[0]) || !isfinite(speed[1])) {
        clips_value_refuse(env, "setSpeed",
                           "finite numbers: a speed in mm/s and a turn rate in deg/s");
        return;
    }
    m->act.drives = true;
    m->act.forward_m_s = physical_clamp(speed[0] / 1000, m->options.forward_max_m_s);
    m->act.turn_rad_s = physical_clamp(speed[1] / physical_deg, m->options.turn_max_rad_s);
    clips_diary_speed(m);
    clips_value_bool(env, out, true);
}

void clips_physical_stop(void *env, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    m->act.drives = true;
    m->act.forward_m_s = 0;
    m->act.turn_rad_s = 0;
    clips_diary_speed(m);
    clips_value_bool(env, out, true);
}

void clips_physical_update_sensors(void *env, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    m->sense_again = m->sense_again || m->firing;
    clips_value_bool(env, out, m->firing);
}
