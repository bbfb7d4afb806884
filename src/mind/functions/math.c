/* SPDX-License-Identifier: Apache-2.0 */
/* Arithmetic of rules: degrees, geometry, random numbers, division that cannot end the process. */
#include "mind/functions/table.h"

#include <limits.h>
#include <math.h>

static double math_sin(double a)
{
    return sin(a / VALUE_DEG);
}

static double math_cos(double a)
{
    return cos(a / VALUE_DEG);
}

static double math_tan(double a)
{
    return tan(a / VALUE_DEG);
}

static double math_asin(double x)
{
    return asin(x) * VALUE_DEG;
}

static double math_acos(double x)
{
    return acos(x) * VALUE_DEG;
}

static double math_atan(double x)
{
    return atan(x) * VALUE_DEG;
}

/* Calls a function of one number; a result that is no number is a CLIPS error. */
static void math_call(void *env, const char *name, double (*function)(double), DATA_OBJECT *out)
{
    double x;
    value_float(env, out, 0);
    if (!value_number(env, name, 1, &x)) {
        return;
    }
    double y = function(x);
    if (!isfinite(y)) {
        value_refuse(env, name, "a number that it has a value for");
        return;
    }
    value_float(env, out, y);
}

/* A function of one number, which a rule calls by that name. */
#define MATH_CALL(function, name, of)          \
    void function(void *env, DATA_OBJECT *out) \
    {                                          \
        math_call(env, name, of, out);         \
    }

MATH_CALL(math_sind, "sind", math_sin)
MATH_CALL(math_cosd, "cosd", math_cos)
MATH_CALL(math_tand, "tand", math_tan)
MATH_CALL(math_asind, "asind", math_asin)
MATH_CALL(math_acosd, "acosd", math_acos)
MATH_CALL(math_atand, "atand", math_atan)
MATH_CALL(math_norm_angle, "norm-angle", value_norm_deg)

void math_atan2d(void *env, DATA_OBJECT *out)
{
    double a[2];
    value_float(env, out, 0);
    if (value_numbers(env, "atan2d", 2, a)) {
        value_float(env, out, value_norm_deg(atan2(a[0], a[1]) * VALUE_DEG));
    }
}

void math_distance(void *env, DATA_OBJECT *out)
{
    double a[4];
    value_float(env, out, 0);
    if (value_numbers(env, "distance", 4, a)) {
        value_float(env, out, hypot(a[2] - a[0], a[3] - a[1]));
    }
}

void math_bearing(void *env, DATA_OBJECT *out)
{
    double a[4];
    value_float(env, out, 0);
    if (value_numbers(env, "bearing", 4, a)) {
        double angle = atan2(a[3] - a[1], a[2] - a[0]) * VALUE_DEG;
        value_float(env, out, value_norm_deg(angle));
    }
}

void math_clamp(void *env, DATA_OBJECT *out)
{
    DATA_OBJECT arg[3];
    double x[3];
    bool whole = true;
    value_float(env, out, 0);
    for (int i = 0; i < 3; i++) {
        if (!EnvArgTypeCheck(env, "clamp", i + 1, INTEGER_OR_FLOAT, &arg[i])) {
            return;
        }
        x[i] = value_of(arg[i].type, arg[i].value);
        whole = whole && arg[i].type == INTEGER;
    }
    if (!(x[1] <= x[2])) {
        value_refuse(env, "clamp", "a number, a lower and an upper limit");
        return;
    }
    int pick = x[0] < x[1] ? 1 : x[0] > x[2] ? 2 : 0;
    if (whole) {
        *out = arg[pick];
    } else {
        value_float(env, out, x[pick]);
    }
}

void math_now(void *env, DATA_OBJECT *out)
{
    value_float(env, out, (double)inputs_of(environment_mind(env))->percept.time_ns * 1e-9);
}

void math_random(void *env, DATA_OBJECT *out)
{
    long long lo = 0;
    long long hi = INT32_MAX;
    int count = EnvRtnArgCount(env);
    value_integer(env, out, 0);
    if (count == 1) {
        value_refuse(env, "random", "no argument or two: the least and the greatest number");
        return;
    }
    if (count == 2 &&
        (!value_whole(env, "random", 1, &lo) || !value_whole(env, "random", 2, &hi))) {
        return;
    }
    if (lo > hi) {
        value_refuse(env, "random", "a least number that is not above the greatest");
        return;
    }
    value_integer(env, out, mu_random_between(&output_of(environment_mind(env))->random, lo, hi));
}

void math_seed(void *env, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    long long seed;
    value_bool(env, out, false);
    if (value_whole(env, "seed", 1, &seed)) {
        mu_random_seed(&output_of(m)->random, (uint64_t)seed, m->options.name);
        value_bool(env, out, true);
    }
}

/* A number cut to a whole one.  @return false, after a CLIPS error */
static bool math_whole(void *env, int index, long long *out)
{
    DATA_OBJECT value;
    if (!EnvArgTypeCheck(env, "div", index, INTEGER_OR_FLOAT, &value)) {
        return false;
    }
    if (value.type == INTEGER) {
        *out = ((struct integerHashNode *)value.value)->contents;
        return true;
    }
    double x = value_of(value.type, value.value);
    if (!(fabs(x) < 9.2e18)) {
        value_refuse(env, "div", "numbers within 64 bits");
        return false;
    }
    *out = (long long)x;
    return true;
}

void math_div(void *env, DATA_OBJECT *out)
{
    long long result;
    long long by;
    int count = EnvRtnArgCount(env);
    value_integer(env, out, 1);
    if (!math_whole(env, 1, &result)) {
        return;
    }
    for (int i = 2; i <= count; i++) {
        if (!math_whole(env, i, &by)) {
            return;
        }
        if (by == 0 || (by == -1 && result == LLONG_MIN)) {
            value_refuse(env, "div", by ? "a result within 64 bits" : "no division by zero");
            return;
        }
        result /= by;
    }
    value_integer(env, out, result);
}

void math_mod(void *env, DATA_OBJECT *out)
{
    DATA_OBJECT arg[2];
    value_integer(env, out, 0);
    for (int i = 0; i < 2; i++) {
        if (!EnvArgTypeCheck(env, "mod", i + 1, INTEGER_OR_FLOAT, &arg[i])) {
            return;
        }
    }
    if (value_of(arg[1].type, arg[1].value) == 0) {
        value_refuse(env, "mod", "no division by zero");
        return;
    }
    if (arg[0].type == FLOAT || arg[1].type == FLOAT) {
        value_float(env, out,
                    fmod(value_of(arg[0].type, arg[0].value), value_of(arg[1].type, arg[1].value)));
        return;
    }
    long long a = ((struct integerHashNode *)arg[0].value)->contents;
    long long b = ((struct integerHashNode *)arg[1].value)->contents;
    value_integer(env, out, b == -1 ? 0 : a % b);
}
