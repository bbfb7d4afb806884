/* SPDX-License-Identifier: Apache-2.0 */
/* One quotient or product of long doubles, with its bound of error.  Where all that it may be
 * rounds to one result, that is the right one; else the C library does it.  A long double of 53
 * bits is never sure, so nothing depends on how many it has. */
#include "mind/syntax/number.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* The bound of one sum or product; the smallest difference of a pair of doubles (ppc64el) is none.
 */
#define EPSILON fmaxl(LDBL_EPSILON, 0x1p-100L)

enum { READ_DIGITS = 18, PRINT_DIGITS = 17, EXPONENT_MIN = -4, EXPONENT_MAX = 14 };
enum { HALF_DIGITS = PRINT_DIGITS / 2, HALF = 100000000 };

/* Exact: 5 to the power of 20 has 47 bits. */
static const long double tens[] = {1e0L,  1e1L,  1e2L,  1e3L,  1e4L,  1e5L,  1e6L,
                                   1e7L,  1e8L,  1e9L,  1e10L, 1e11L, 1e12L, 1e13L,
                                   1e14L, 1e15L, 1e16L, 1e17L, 1e18L, 1e19L, 1e20L};

static const char *digits_add(const char *at, const char *end, uint64_t *digits)
{
    for (; at < end && *at >= '0' && *at <= '9'; at++) {
        *digits = *digits * 10 + (uint64_t)(*at - '0');
    }
    return at;
}

/* @return the digits of a word without its sign as an integer, 0: another form; and how many of
 * them stand behind the point */
static uint64_t digits_read(const char *at, const char *end, int *places)
{
    uint64_t digits = 0;
    const char *point = digits_add(at, end, &digits);
    bool has_point = point < end && *point == '.';
    bool whole = digits_add(point + has_point, end, &digits) == end;
    *places = (int)(end - point) - has_point;
    return whole && end - at - has_point <= READ_DIGITS ? digits : 0;
}

bool number_read(const char *at, size_t len, double *x)
{
    int places;
    bool minus = len > 0 && *at == '-';
    uint64_t digits = digits_read(at + minus, at + len, &places);
    if (digits == 0) {
        return false;
    }
    long double size = (long double)digits / tens[places];
    long double error = size * EPSILON; /* at most half of it, and the sums' half */
    double least = (double)(size - error);
    *x = minus ? -least : least;
    return least == (double)(size + error);
}

/* @return the first 17 digits of size, rounded, and the exponent of the first; 0: not sure */
static uint64_t digits_of(double size, int *exponent)
{
    int e = size >= 1 ? 0 : EXPONENT_MIN;
    while (e < EXPONENT_MAX && (e < -1 ? size * tens[-e - 1] >= 1 : size >= tens[e + 1])) {
        e++;
    }
    long double scaled = size * tens[PRINT_DIGITS - 1 - e];
    uint64_t digits = (uint64_t)llrintl(scaled);
    long double cut = fabsl(scaled - (long double)digits); /* exact */
    bool sure = 0.5L - cut > scaled * EPSILON &&           /* the product has half of it */
                digits >= (uint64_t)tens[PRINT_DIGITS - 1] && digits < (uint64_t)tens[PRINT_DIGITS];
    *exponent = e;
    return sure ? digits : 0;
}

static void pair_print(char *to, uint32_t below_100)
{
    to[0] = (char)('0' + below_100 / 10);
    to[1] = (char)('0' + below_100 % 10);
}

/* Writes digits with a point before place `point` of them, without zeros at the end.  @return
 * whether none is behind the point */
static bool digits_print(char *to, uint64_t digits, int point)
{
    char all[PRINT_DIGITS - EXPONENT_MIN] = "0000";
    int zeros = point < 1 ? 1 - point : 0, count = zeros + PRINT_DIGITS;
    uint32_t last = (uint32_t)(digits % HALF), first = (uint32_t)(digits / HALF); /* 8, and 9 */
    for (int at = count - 2; at >= count - HALF_DIGITS; at -= 2, last /= 100, first /= 100) {
        pair_print(all + at, last % 100); /* four digits at a time */
        pair_print(all + at - HALF_DIGITS, first % 100);
    }
    all[zeros] = (char)('0' + first);
    point += zeros;
    while (count > point && all[count - 1] == '0') {
        count--;
    }
    memcpy(to, all, (size_t)point);
    bool whole = count == point;
    if (!whole) {
        to[point] = '.';
        memcpy(to + point + 1, all + point, (size_t)(count - point));
        count++;
    }
    to[count] = '\0';
    return whole;
}

bool number_print(char to[static NUMBER_MAX], double x)
{
    int exponent;
    double size = fabs(x);
    uint64_t digits = size >= 1e-4 && size < 1e15 ? digits_of(size, &exponent) : 0;
    if (digits == 0) {
        snprintf(to, NUMBER_MAX, "%.17g", x);
        return !strpbrk(to, ".en"); /* of an exponent, inf or nan */
    }
    if (x < 0) {
        *to++ = '-';
    }
    return digits_print(to, digits, exponent + 1);
}
