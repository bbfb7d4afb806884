/* SPDX-License-Identifier: Apache-2.0 */
/* Random numbers: their distribution, and the independence of their streams. */
#include "sim/geometry/geometry.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>

enum { DRAWS = 200000, BINS = 64 };

/* @return the bits for which draw_unit is nearest to u */
static uint64_t bits_of(double u)
{
    return (uint64_t)(u * 0x1p52) << 12;
}

static void test_normal_inverts_the_distribution(void)
{
    double most = 0;
    for (double u = 1e-9; u < 1; u = u < 0.01 ? u * 1.7 : u + 0.003) {
        double x = draw_normal(bits_of(u));
        double back = 0.5 * erfc(-x * M_SQRT1_2);
        most = fmax(most, fabs(back - draw_unit(bits_of(u))) / fmin(u, 1 - u));
    }
    CU_ASSERT(most < 1e-6 * 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(draw_normal(bits_of(0.975)), 1.959963984540054, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(draw_normal(bits_of(0.001)), -3.090232306167814, 1e-12);
}

static void test_ends_are_finite(void)
{
    CU_ASSERT(isfinite(draw_normal(0)) && draw_normal(0) < -8);
    CU_ASSERT(isfinite(draw_normal(UINT64_MAX)) && draw_normal(UINT64_MAX) > 8);
    CU_ASSERT(draw_unit(0) > 0 && draw_unit(UINT64_MAX) < 1);
}

/*
 * Chi square of BINS bins has BINS - 1 degrees of freedom; 5 deviations beyond that are no chance.
 */
static double chi_square(const unsigned count[BINS], double draws)
{
    double sum = 0;
    for (int k = 0; k < BINS; k++) {
        double off = count[k] - draws / BINS;
        sum += off * off / (draws / BINS);
    }
    return sum;
}

static void test_beams_and_ticks_spread_evenly(void)
{
    for (int over = 0; over < 4; over++) { /* beams, ticks, robots, seeds */
        unsigned high[BINS] = {0};
        unsigned low[BINS] = {0};
        for (uint64_t k = 0; k < DRAWS; k++) {
            uint64_t key =
                draw_key(over == 3 ? k : 1, over == 2 ? k : 0, DRAW_LASER, over == 1 ? k : 0);
            uint64_t bits = draw_bits(key, over == 0 ? k : 0);
            high[bits >> 58]++;
            low[bits & 63]++;
        }
        CU_ASSERT(chi_square(high, DRAWS) < 63 + 5 * sqrt(2 * 63));
        CU_ASSERT(chi_square(low, DRAWS) < 63 + 5 * sqrt(2 * 63));
    }
}

static void test_moments(void)
{
    double sum = 0;
    double square = 0;
    double fourth = 0;
    uint64_t key = draw_key(7, 3, DRAW_GPS, 12);
    for (uint64_t k = 0; k < DRAWS; k++) {
        double x = draw_normal(draw_bits(key, k));
        sum += x;
        square += x * x;
        fourth += x * x * x * x;
    }
    CU_ASSERT_DOUBLE_EQUAL(sum / DRAWS, 0, 5 / sqrt(DRAWS));
    CU_ASSERT_DOUBLE_EQUAL(square / DRAWS, 1, 5 * sqrt(2.0 / DRAWS));
    CU_ASSERT_DOUBLE_EQUAL(fourth / DRAWS, 3, 5 * sqrt(96.0 / DRAWS));
}

static double correlation(uint64_t key_a, uint64_t key_b, uint64_t lag)
{
    double sum = 0;
    for (uint64_t k = 0; k < DRAWS; k++) {
        sum += draw_normal(draw_bits(key_a, k)) * draw_normal(draw_bits(key_b, k + lag));
    }
    return fabs(sum / DRAWS);
}

static void test_streams_are_independent(void)
{
    uint64_t one = draw_key(1, 0, DRAW_SONAR, 0);
    const uint64_t others[] = {draw_key(2, 0, DRAW_SONAR, 0), draw_key(1, 1, DRAW_SONAR, 0),
                               draw_key(1, 0, DRAW_LASER, 0), draw_key(1, 0, DRAW_SONAR, 1),
                               draw_key(0, 1, DRAW_SONAR, 0), draw_key(1, 0, DRAW_LASER, 1)};
    for (size_t k = 0; k < sizeof others / sizeof others[0]; k++) {
        CU_ASSERT_NOT_EQUAL(one, others[k]);
        CU_ASSERT(correlation(one, others[k], 0) < 5 / sqrt(DRAWS));
    }
    for (uint64_t lag = 1; lag < 4; lag++) {
        CU_ASSERT(correlation(one, one, lag) < 5 / sqrt(DRAWS));
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"normal inverts the distribution", test_normal_inverts_the_distribution},
        {"the ends are finite", test_ends_are_finite},
        {"beams, ticks, robots and seeds spread evenly", test_beams_and_ticks_spread_evenly},
        {"moments", test_moments},
        {"streams are independent", test_streams_are_independent},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/draw", tests);
}
