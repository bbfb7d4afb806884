/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Numbers become text, and text numbers, by the C library: exactly, or files, mail and facts of
 * rules would have other bits elsewhere.  The digits that are right come from integers alone.
 */
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>

enum { ROUNDS = 400, LIMBS = 90, TEXT_MAX = 9 * LIMBS + 32, LIMB = 1000000000, SMALLEST = -1074 };

/* A number of as many digits as it has, nine in each limb, the lowest first. */
struct digits {
    uint32_t limb[LIMBS];
    size_t count;
};

static void digits_times(struct digits *d, uint32_t factor)
{
    uint64_t carry = 0;
    for (size_t i = 0; i < d->count || carry; i++) {
        d->count = i < d->count ? d->count : i + 1;
        carry += (uint64_t)d->limb[i] * factor;
        d->limb[i] = (uint32_t)(carry % LIMB);
        carry /= LIMB;
    }
}

/* Writes mantissa * 2^exponent, all of it, with more digits behind: "5e-1", with "07" "507e-3". */
static void decimal(char text[TEXT_MAX], uint64_t mantissa, int exponent, const char *more)
{
    struct digits d = {{(uint32_t)(mantissa % LIMB), (uint32_t)(mantissa / LIMB % LIMB)}, 2};
    for (int i = 0; i < abs(exponent); i++) {
        digits_times(&d, exponent < 0 ? 5 : 2);
    }
    size_t used = 0;
    for (size_t i = d.count; i-- > 0; used += 9) {
        snprintf(text + used, TEXT_MAX - used, "%09u", d.limb[i]);
    }
    snprintf(text + used, TEXT_MAX - used, "%se%d", more,
             (exponent < 0 ? exponent : 0) - (int)strlen(more));
}

/* A positive double of any size but the largest, every third less than a normal one; and what it
 * is: mantissa * 2^exponent. */
static double any(struct mu_random *r, size_t i, uint64_t *mantissa, int *exponent)
{
    uint64_t bits = mu_random_next(r) % 0x7fe0000000000000 >> (i % 3 == 0 ? 11 : 0);
    double value;
    memcpy(&value, &bits, sizeof value);
    *exponent = (int)(bits >> 52 ? bits >> 52 : 1) + SMALLEST - 1;
    *mantissa = (bits & 0xfffffffffffff) | (bits >> 52 ? 0x10000000000000 : 0);
    return value;
}

/* All digits of a number, as printf writes them, and as few as tell it from any other. */
static void test_what_is_written(void)
{
    struct mu_random r = {.state = 1};
    for (size_t i = 0; i < ROUNDS; i++) {
        uint64_t mantissa;
        int exponent;
        char right[TEXT_MAX], got[TEXT_MAX], text[64];
        double x = any(&r, i, &mantissa, &exponent);
        decimal(right, mantissa, exponent, "");
        char *first = right + strspn(right, "0"), *end = strchr(right, 'e');
        snprintf(got, sizeof got, "%.*e", (int)(end - first) - 1, x);
        CU_ASSERT(got[0] == first[0] &&
                  strncmp(got + 2, first + 1, (size_t)(end - first) - 1) == 0);
        CU_ASSERT_EQUAL(strtod(right, NULL), x);
        snprintf(text, sizeof text, "%.17g", x);
        CU_ASSERT_EQUAL(strtod(text, NULL), x);
    }
}

/* The middle of two doubles is read to the even one, a little more to the upper, a little less to
 * the lower, however many digits tell so. */
static void test_what_is_read(void)
{
    struct mu_random r = {.state = 2};
    for (size_t i = 0; i < ROUNDS; i++) {
        uint64_t mantissa;
        int exponent;
        char text[TEXT_MAX];
        double x = any(&r, i, &mantissa, &exponent), next = nextafter(x, INFINITY);
        decimal(text, 2 * mantissa + 1, exponent - 1, "");
        CU_ASSERT_EQUAL(strtod(text, NULL), mantissa % 2 == 0 ? x : next);
        decimal(text, 2 * mantissa + 1, exponent - 1, "00000000000000000001");
        CU_ASSERT_EQUAL(strtod(text, NULL), next);
        if (exponent <= 0) { /* its last digit is a 5 */
            decimal(text, 2 * mantissa + 1, exponent - 1, "99999999999999999999");
            *(strchr(text, 'e') - 21) = '4';
            CU_ASSERT_EQUAL(strtod(text, NULL), x);
        }
    }
}

/* The ends of the range, and numbers that C libraries were known to read wrongly or not at all. */
static void test_what_is_known_as_hard(void)
{
    static const struct {
        const char *text;
        double value;
    } hard[] = {
        {"2.2250738585072011e-308", 0x0.fffffffffffffp-1022},
        {"2.2250738585072012e-308", 0x1p-1022},
        {"2.2250738585072014e-308", 0x1p-1022},
        {"4.9406564584124654e-324", 0x1p-1074},
        {"2.4703282292062328e-324", 0x1p-1074},
        {"2.4703282292062327e-324", 0},
        {"1.7976931348623157e308", 0x1.fffffffffffffp1023},
        {"1.7976931348623158e308", 0x1.fffffffffffffp1023},
        {"1.7976931348623159e308", INFINITY},
        {"9007199254740993", 0x1p53},
        {"9007199254740993.00000000000000000000000001", 0x1p53 + 2},
        {"6929495644600919.5", 6929495644600920.0},
        {"3.518437208883201171875e13", 35184372088832.015625},
        {"1.448997445238699", 0x1.72f17f1f49aadp0},
        {"0.1", 0x1.999999999999ap-4},
        {"1e23", 0x1.52d02c7e14af6p76},
    };
    for (size_t i = 0; i < sizeof hard / sizeof hard[0]; i++) {
        CU_ASSERT_EQUAL(strtod(hard[i].text, NULL), hard[i].value);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {{"what is written", test_what_is_written},
                           {"what is read", test_what_is_read},
                           {"what is known as hard", test_what_is_known_as_hard},
                           CU_TEST_INFO_NULL};
    return suite_run("decimal", tests);
}
