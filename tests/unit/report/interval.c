/* SPDX-License-Identifier: Apache-2.0 */
#include "report/compare/compare.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>

/* From the tables of t, two-sided. */
static void test_student(void)
{
    static const struct {
        double probability;
        size_t freedom;
        double t;
    } rows[] = {{0.95, 1, 12.7062},  {0.95, 2, 4.30265},   {0.95, 3, 3.18245},  {0.95, 4, 2.77645},
                {0.95, 5, 2.57058},  {0.95, 9, 2.26216},   {0.95, 10, 2.22814}, {0.95, 29, 2.04523},
                {0.95, 30, 2.04227}, {0.95, 999, 1.96234}, {0.99, 4, 4.60409},  {0.9, 7, 1.89458}};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        double t = interval_student(rows[i].probability, rows[i].freedom);
        CU_ASSERT_DOUBLE_EQUAL(t, rows[i].t, 6e-6 * rows[i].t);
    }
}

/* Gosset's own example: extra hours of sleep of ten patients (Biometrika 6, 1908). */
static void test_the_hours_of_sleep(void)
{
    static const double hours[] = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
    struct interval i = {0};
    for (size_t k = 0; k < sizeof hours / sizeof hours[0]; k++) {
        interval_add(&i, hours[k]);
    }
    CU_ASSERT_EQUAL(i.count, 10);
    CU_ASSERT_DOUBLE_EQUAL(i.mean, 2.33, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(interval_deviation(&i), 2.002249, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(interval_half_width(&i), 2.26216 * 2.002249 / sqrt(10), 1e-4);
    CU_ASSERT_DOUBLE_EQUAL(i.least, -0.1, 0);
    CU_ASSERT_DOUBLE_EQUAL(i.most, 5.5, 0);
}

static void test_few_values(void)
{
    struct interval i = {0};
    CU_ASSERT(isnan(interval_half_width(&i)));
    interval_add(&i, -3);
    CU_ASSERT(isnan(interval_half_width(&i)));
    CU_ASSERT_DOUBLE_EQUAL(i.mean, -3, 0);
    CU_ASSERT_DOUBLE_EQUAL(i.most, -3, 0);
    CU_ASSERT_DOUBLE_EQUAL(interval_deviation(&i), 0, 0);
    interval_add(&i, -3);
    CU_ASSERT_DOUBLE_EQUAL(interval_half_width(&i), 0, 0);
}

/* A large mean must not drown a small spread. */
static void test_far_from_zero(void)
{
    struct interval i = {0};
    for (int k = 0; k < 1000; k++) {
        interval_add(&i, 1e9 + (k % 2));
    }
    CU_ASSERT_DOUBLE_EQUAL(i.mean, 1e9 + 0.5, 1e-6);
    CU_ASSERT_DOUBLE_EQUAL(interval_deviation(&i), 0.50025, 1e-5);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"Student's t", test_student},
        {"the hours of sleep", test_the_hours_of_sleep},
        {"few values", test_few_values},
        {"far from zero", test_far_from_zero},
        CU_TEST_INFO_NULL,
    };
    return suite_run("report/interval", tests);
}
