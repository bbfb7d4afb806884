/* SPDX-License-Identifier: Apache-2.0 */
#include "mind/syntax/number.h"

#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

static unsigned wrong, taken;

static void reads_as_in_c(const char *word)
{
    double ours, theirs = strtod(word, NULL);
    if (number_read(word, strlen(word), &ours)) {
        taken++;
        wrong += memcmp(&ours, &theirs, sizeof theirs) != 0;
    }
}

static void prints_as_in_c(double x)
{
    char ours[NUMBER_MAX], theirs[NUMBER_MAX];
    bool whole = number_print(ours, x);
    snprintf(theirs, sizeof theirs, "%.17g", x);
    wrong += strcmp(ours, theirs) != 0 || whole == (strpbrk(theirs, ".en") != NULL);
    reads_as_in_c(theirs);
}

/* Numbers of all sizes that mail has, some of them as a person would write them. */
static void test_many(void)
{
    enum { MANY = 200000 };
    struct mu_random r;
    mu_random_seed(&r, suite_setting("MUSTER_SEED", 1), "numbers");
    wrong = taken = 0;
    for (int i = 0; i < MANY; i++) {
        char word[64];
        double x = ldexp(mu_random_unit(&r) - 0.5, (int)mu_random_between(&r, -15, 52));
        prints_as_in_c(x);
        prints_as_in_c(round(x * 1000) / 1000);
        snprintf(word, sizeof word, "%.*f", (int)mu_random_between(&r, 0, 9), x);
        reads_as_in_c(word);
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT(LDBL_MANT_DIG < 64 || taken > MANY);
}

/* Powers of ten and their neighbours, halves of the last digit, and what is left to the C library.
 */
static void test_edges(void)
{
    static const double others[] = {0.0, -0.0, 1e-5, 1e300, DBL_MIN, DBL_MAX, HUGE_VAL, 9.5e-5,
                                    5e-324, 0x1.8p49,
                                    /* a half of the last digit, upwards and downwards to even */
                                    1 + 0x1p-17, -1 - 0x1p-17, 1 + 0x3p-17};
    wrong = 0;
    for (int e = -6; e < 18; e++) {
        double x = pow(10, e);
        prints_as_in_c(x);
        prints_as_in_c(-nextafter(x, 0));
        prints_as_in_c(nextafter(x, 2 * x));
        prints_as_in_c(9.5 * x);
        prints_as_in_c(x + 0x1p-30);
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        prints_as_in_c(others[i]);
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

/* In the middle between two doubles, just beside it, and where one rounding more would be wrong. */
static void test_halves(void)
{
    static const char *const words[] = {
        "9007199254740993.0",  "9007199254740993.1", "9007199254740992.9",  "4503599627370497.5",
        "4503599627370497.4",  "1.0000000000000001", "1.00000000000000011", "2251799813685249.25",
        "0.50000000000000006", "8.4999999999999991", "562949953421312.06",  "0.30000000000000002"};
    wrong = 0;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        reads_as_in_c(words[i]);
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

static void test_other_forms_are_not_taken(void)
{
    static const char *const words[] = {"",     "-",     ".",   "-.",  "1e3",
                                        "+1.5", "1.5.2", "0.0", "0x1", "1 .5",
                                        "inf",  "nan",   "--1", "1,5", "1234567890123456789.0"};
    double x;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        CU_ASSERT_FALSE(number_read(words[i], strlen(words[i]), &x));
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"many numbers are printed and read as the C library does", test_many},
        {"so are those at the edges", test_edges},
        {"and those in the middle between two", test_halves},
        {"other forms are not taken", test_other_forms_are_not_taken},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/number", tests);
}
