/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The elementary functions that programs are linked with: the same bits on every processor, and
 * good ones.  The checksums are what amd64 gives; a function that is not musl's gives another.
 */
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { POINTS = 100000 };

/* FNV-1a, by 64 bits. */
#define HASH_START 1469598103934665603ull

static uint64_t fold(uint64_t hash, double value)
{
    uint64_t bits = 0x7ff8000000000000; /* what is no number is one: its sign is the processor's */
    if (!isnan(value)) {
        memcpy(&bits, &value, sizeof bits);
    }
    return (hash ^ bits) * 1099511628211ull;
}

static double of_bits(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Zeros, the ends of the range, values next to 1 and to multiples of pi/2, what is no number, and
 * the arguments of exp, log, sin and tan whose results are nearest to the middle of two doubles
 * (Lefevre, Muller: "Worst cases for correct rounding of the elementary functions in double
 * precision"). */
static const double hard[] = {
    0.0,
    -0.0,
    0x1p-1074,
    0x1p-1022,
    DBL_MAX,
    -DBL_MAX,
    INFINITY,
    -INFINITY,
    NAN,
    1.0,
    -1.0,
    0x1.fffffffffffffp-1,
    0x1.0000000000001p+0,
    0x1.921fb54442d18p-1,
    0x1.921fb54442d18p+0,
    0x1.921fb54442d18p+1,
    0x1.921fb54442d18p+2,
    0x1.2d97c7f3321d2p+2,
    0x1.6ac5b262ca1ffp+849,
    0x1.6ac5b262ca1ffp+852,
    0x1.9e9cbbfd6080bp-31,
    0x1.62a88613629b6p+678,
    0x1.e0000000001c2p-20,
    0x1.dffffffffff1fp-22,
    0x1.62e42fefa39efp+9,
    -0x1.74910d52d3051p+9,
    0x1.0p+27,
    0x1.0p+54,
    90.0,
    180.0,
};
enum { HARD = sizeof hard / sizeof hard[0] };

/* The hard ones first; then by turns near zero, in the range of angles, and of any size. */
static double point(struct mu_random *r, size_t i)
{
    uint64_t bits = mu_random_next(r);
    double unit = 2 * mu_random_unit(r) - 1;
    return i < HARD ? hard[i] : i % 3 == 0 ? of_bits(bits) : i % 3 == 1 ? 8 * unit : 1000 * unit;
}

/* For a function of two: each hard one with each, then pairs of random ones. */
static double partner(struct mu_random *r, size_t i, double x, double *y)
{
    *y = i < HARD * HARD ? hard[i / HARD] : point(r, HARD + i % 3);
    return i < HARD * HARD ? hard[i % HARD] : x;
}

static double sincos_sin(double x)
{
    double s, c;
    sincos(x, &s, &c);
    return s;
}

static double sincos_cos(double x)
{
    double s, c;
    sincos(x, &s, &c);
    return c;
}

/* A name, its function, the C library's in a long double, and by how many units of the last place
 * they may differ. */
static const struct {
    const char *name;
    double (*of)(double);
    long double (*exact)(long double);
    double ulps;
    uint64_t checksum;
} functions[] = {
    {"sin", sin, sinl, 1, 0x89ca444c34fc79e1},
    {"cos", cos, cosl, 1, 0x19a1d014718a3cff},
    {"sincos: sin", sincos_sin, sinl, 1, 0x89ca444c34fc79e1},
    {"sincos: cos", sincos_cos, cosl, 1, 0x19a1d014718a3cff},
    {"tan", tan, tanl, 1, 0xf82b2123cff136b9},
    {"asin", asin, asinl, 1, 0xe64fe20aa533ad21},
    {"acos", acos, acosl, 1, 0xa3a21de40f64f1f5},
    {"atan", atan, atanl, 1, 0x2b5e9befeff15a25},
    {"sinh", sinh, sinhl, 2, 0xda06e4c5cbb8a249},
    {"cosh", cosh, coshl, 2, 0x35a7ba6643b83f4b},
    {"tanh", tanh, tanhl, 3, 0x0ae420f2bc8470be},
    {"exp", exp, expl, 1, 0x90182c97b798d3d9},
    {"expm1", expm1, expm1l, 1, 0x352dac952b93aa54},
    {"log", log, logl, 1, 0xb6cef8a7fb8684a1},
    {"log10", log10, log10l, 2, 0x1c292612dac02de4},
};

static const struct {
    const char *name;
    double (*of)(double, double);
    long double (*exact)(long double, long double);
    double ulps;
    uint64_t checksum;
} pairs[] = {
    {"atan2", atan2, atan2l, 2, 0x426c26a4ef3804db},
    {"pow", pow, powl, 1, 0x9581c8d1666ac242},
    {"hypot", hypot, hypotl, 1, 0x236f25c694e0585c},
};

/* @return how far a value is from the right one, in units of the last place of a normal number */
static double ulps_off(double value, long double exact)
{
    double right = (double)exact;
    if (isnan(value) || isnan(right) || isinf(value) || isinf(right)) {
        return (isnan(value) && isnan(right)) || value == right ? 0 : HUGE_VAL;
    }
    double next = nextafter(fabs(right), INFINITY);
    double unit = fmax(next - fabs(right), 0x1p-1074);
    return isinf(next) ? 0 : (double)(fabsl((long double)value - exact) / (long double)unit);
}

static void judge(const char *name, uint64_t got, uint64_t wanted, double off, double most)
{
    if (got != wanted || off > most) {
        printf("\n  %s: checksum 0x%016llx, at most %.3f units off\n", name,
               (unsigned long long)got, off);
    }
    CU_ASSERT_EQUAL(got, wanted);
    CU_ASSERT(off <= most || LDBL_MANT_DIG < 64);
}

static void test_functions_of_one(void)
{
    for (size_t f = 0; f < sizeof functions / sizeof functions[0]; f++) {
        struct mu_random r = {.state = 1};
        uint64_t hash = HASH_START;
        double off = 0;
        for (size_t i = 0; i < POINTS; i++) {
            double x = point(&r, i), value = functions[f].of(x);
            hash = fold(hash, value);
            off = fmax(off, ulps_off(value, functions[f].exact((long double)x)));
        }
        judge(functions[f].name, hash, functions[f].checksum, off, functions[f].ulps);
    }
}

static void test_functions_of_two(void)
{
    for (size_t f = 0; f < sizeof pairs / sizeof pairs[0]; f++) {
        struct mu_random r = {.state = 2};
        uint64_t hash = HASH_START;
        double off = 0;
        for (size_t i = 0; i < POINTS; i++) {
            double y, x = partner(&r, i, point(&r, HARD + i), &y), value = pairs[f].of(x, y);
            hash = fold(hash, value);
            off = fmax(off, ulps_off(value, pairs[f].exact((long double)x, (long double)y)));
        }
        judge(pairs[f].name, hash, pairs[f].checksum, off, pairs[f].ulps);
    }
}

/* ODE's collision of meshes has them. */
static void test_functions_of_floats(void)
{
    struct mu_random r = {.state = 3};
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < POINTS; i++) {
        float x = (float)(2 * mu_random_unit(&r) - 1);
        hash = fold(fold(hash, (double)asinf(x)), (double)acosf(x));
    }
    judge("asinf, acosf", hash, 0x92009b5eff8c6283, 0, 0);
}

/* What is exact by its definition stays the C library's: the same tells so. */
static void test_what_is_exact(void)
{
    struct mu_random r = {.state = 4};
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < POINTS; i++) {
        int exponent;
        double y, x = partner(&r, i, point(&r, HARD + i), &y);
        hash = fold(hash, fmod(x, y));
        hash = fold(hash, remainder(x, y));
        hash = fold(hash, sqrt(x));
        hash = fold(hash, scalbn(x, (int)(i % 2100) - 1050));
        hash = fold(fold(hash, floor(x)), ceil(x));
        if (isfinite(x)) { /* else the exponent may be any */
            hash = fold(hash, frexp(x, &exponent));
            hash = fold(hash, exponent);
        }
        hash = fold(hash, fabs(x) < 1e9 ? (double)lround(x) : 0);
    }
    judge("exact ones", hash, 0x9dbc53e7c9d87dca, 0, 0);
}

/* Numbers become text and come back by the C library: the same bits in each. */
static void test_numbers_as_text(void)
{
    struct mu_random r = {.state = 5};
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < POINTS; i++) {
        double x = point(&r, i);
        char exact[64], brief[64];
        snprintf(exact, sizeof exact, "%.17g", isnan(x) ? 0 : x);
        snprintf(brief, sizeof brief, "%.15g", isnan(x) ? 0 : x);
        for (const char *c = exact; *c; c++) {
            hash = (hash ^ (unsigned char)*c) * 1099511628211ull;
        }
        CU_ASSERT(isnan(x) || strtod(exact, NULL) == x);
        hash = fold(hash, strtod(brief, NULL));
    }
    judge("numbers as text", hash, 0x2b64c1c5cca17765, 0, 0);
}

/* The compiler knows nothing of the functions: what it would compute by itself is the same. */
static void test_what_is_constant(void)
{
    volatile double degrees = 57.295779513082323, one = 1.0, ten = 10;
    CU_ASSERT_EQUAL(sin(one), sin(1.0));
    CU_ASSERT_EQUAL(cos(ten / degrees), cos(10 / 57.295779513082323));
    CU_ASSERT_EQUAL(pow(ten, -one / 3), pow(10, -1.0 / 3));
    CU_ASSERT_EQUAL(exp(one), exp(1.0));
}

int main(void)
{
    CU_TestInfo tests[] = {{"functions of one", test_functions_of_one},
                           {"functions of two", test_functions_of_two},
                           {"functions of floats", test_functions_of_floats},
                           {"what is exact", test_what_is_exact},
                           {"numbers as text", test_numbers_as_text},
                           {"what is constant", test_what_is_constant},
                           CU_TEST_INFO_NULL};
    return suite_run("arithmetic", tests);
}
