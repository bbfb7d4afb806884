/* SPDX-License-Identifier: Apache-2.0 */
#include "suite.h"
#include "agent/clips_number.h"
#include "core/random.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NUMBERS = 300000 };

/* What the engine prints. */
static void check(double number)
{
    char want[64], got[CLIPS_NUMBER_BYTES];
    int len = snprintf(want, sizeof want, "%.15g", number);
    if (!strpbrk(want, ".e")) {
        memcpy(want + len, ".0", 3);
    }
    READS(clips_number_print(number, got), want);
}

static void check_both(double number)
{
    check(number);
    check(-number);
}

static void test_ends(void)
{
    static const double numbers[] = {0,
                                     1,
                                     10,
                                     100,
                                     0.1,
                                     0.5,
                                     0.001,
                                     1e-4,
                                     9.999999999999999e-5,
                                     0.00012345678901234567,
                                     1e14,
                                     999999999999999,
                                     1e15,
                                     1e16,
                                     123456789012345.6,
                                     99999999999999.95,
                                     0.99999999999999996,
                                     9.9999999999999995,
                                     9.99999999999999995,
                                     2.5,
                                     1e22,
                                     1e300,
                                     DBL_MIN,
                                     DBL_MAX,
                                     5e-324,
                                     INFINITY,
                                     NAN};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        check_both(numbers[i]);
        check_both(nextafter(numbers[i], 0));
        check_both(nextafter(numbers[i], INFINITY));
    }
}

/* Numbers in the middle between two of 15 digits, and beside it. */
static void test_middles(void)
{
    for (int64_t i = 0; i < 2000; i++) {
        double middle = ((double)(100000000000000 + 4547 * i * i) + 0.5) / 1024;
        check_both(middle);
        check_both(nextafter(middle, 0));
        check_both(nextafter(middle, INFINITY));
        check_both((double)i + 0.5);
        check_both(((double)i + 0.5) * 1e-15 + 0.1);
    }
}

static void test_any(void)
{
    struct mu_random random;
    mu_random_seed(&random, 1, "numbers");
    for (int i = 0; i < NUMBERS; i++) {
        uint64_t bits = mu_random_next(&random);
        double any, measured = (double)(bits >> 11) * 0x1p-53;
        memcpy(&any, &bits, sizeof any);
        check(any);
        check_both(measured * 10000);
        check_both((double)(float)measured * 1000);
        check_both(floor(measured * 1e6) / 100);
        check_both(measured * pow(10, (double)(bits % 22) - 5));
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"ends", test_ends},
        {"middles", test_middles},
        {"any", test_any},
        CU_TEST_INFO_NULL,
    };
    return suite_run("agent/number", tests);
}
