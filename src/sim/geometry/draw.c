/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/geometry/geometry.h"

#include "core/hash.h"

#define DRAW_STEP \
    0x9e3779b97f4a7c15ull /* The constant of splitmix64 drives neighbouring numbers far apart. */

uint64_t draw_key(uint64_t seed, uint64_t robot, enum draw_use use, uint64_t tick)
{
    uint64_t key = mu_hash_number(seed + DRAW_STEP);
    key = mu_hash_number(key + (robot + 1) * DRAW_STEP);
    key = mu_hash_number(key + ((uint64_t)use + 1) * DRAW_STEP);
    return mu_hash_number(key + (tick + 1) * DRAW_STEP);
}

uint64_t draw_bits(uint64_t key, uint64_t index)
{
    return mu_hash_number(mu_hash_number(key + (index + 1) * DRAW_STEP));
}

double draw_unit(uint64_t bits)
{
    return ((double)(bits >> 12) + 0.5) * 0x1p-52;
}

/* Returns log(x) for 0 < x < 1: the series of atanh((m - 1) / (m + 1)) for the mantissa m. */
static double draw_log(double x)
{
    int exponent;
    double m = frexp(x, &exponent);
    if (m < 0.70710678118654752) {
        m *= 2;
        exponent--;
    }
    double s = (m - 1) / (m + 1);
    double term = 2 * s;
    double sum = 0;
    for (int k = 1; k < 24; k += 2) {
        sum += term / k;
        term *= s * s;
    }
    return sum + exponent * 0.69314718055994531;
}

static double draw_ratio(const double top[8], const double bottom[8], double x)
{
    double a = top[7];
    double b = bottom[7];
    for (int k = 6; k >= 0; k--) {
        a = a * x + top[k];
        b = b * x + bottom[k];
    }
    return a / b;
}

/*
 * The inverse of the normal distribution: M. J. Wichura, "Algorithm AS 241", Applied Statistics 37,
 * 1988; relative error below 1e-15.
 */
static const double middle_top[8] = {3.3871328727963666080e0,  1.3314166789178437745e+2,
                                     1.9715909503065514427e+3, 1.3731693765509461125e+4,
                                     4.5921953931549871457e+4, 6.7265770927008700853e+4,
                                     3.3430575583588128105e+4, 2.5090809287301226727e+3};
static const double middle_bottom[8] = {1,
                                        4.2313330701600911252e+1,
                                        6.8718700749205790830e+2,
                                        5.3941960214247511077e+3,
                                        2.1213794301586595867e+4,
                                        3.9307895800092710610e+4,
                                        2.8729085735721942674e+4,
                                        5.2264952788528545610e+3};
static const double side_top[8] = {1.42343711074968357734e0,  4.63033784615654529590e0,
                                   5.76949722146069140550e0,  3.64784832476320460504e0,
                                   1.27045825245236838258e0,  2.41780725177450611770e-1,
                                   2.27238449892691845833e-2, 7.74545014278341407640e-4};
static const double side_bottom[8] = {1,
                                      2.05319162663775882187e0,
                                      1.67638483018380384940e0,
                                      6.89767334985100004550e-1,
                                      1.48103976427480074590e-1,
                                      1.51986665636164571966e-2,
                                      5.47593808499534494600e-4,
                                      1.05075007164441684324e-9};
static const double far_top[8] = {6.65790464350110377720e0,  5.46378491116411436990e0,
                                  1.78482653991729133580e0,  2.96560571828504891230e-1,
                                  2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                  2.71155556874348757815e-5, 2.01033439929228813265e-7};
static const double far_bottom[8] = {1,
                                     5.99832206555887937690e-1,
                                     1.36929880922735805310e-1,
                                     1.48753612908506148525e-2,
                                     7.86869131145613259100e-4,
                                     1.84631831751005468180e-5,
                                     1.42151175831644588870e-7,
                                     2.04426310338993978564e-15};

double draw_normal(uint64_t bits)
{
    double u = draw_unit(bits);
    double q = u - 0.5;
    if (fabs(q) <= 0.425) {
        return q * draw_ratio(middle_top, middle_bottom, 0.180625 - q * q);
    }
    double r = sqrt(-draw_log(q < 0 ? u : 1 - u));
    double x = r <= 5 ? draw_ratio(side_top, side_bottom, r - 1.6)
                      : draw_ratio(far_top, far_bottom, r - 5);
    return q < 0 ? -x : x;
}
