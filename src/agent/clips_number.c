/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Of a watched robot's step most of the time went into printf's numbers, which has big ones to
 * think of.  What robots measure is between 1e-4 and 1e15, and its 15 digits are a whole number of
 * 50 bits there: one product of long doubles, of which the first 64 bits are right.
 */
#include "agent/clips_number.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { DIGITS = 15, EXPONENT_LEAST = -4, EXPONENT_MOST = DIGITS - 1 };

/* Powers of ten; up to 10^27 they are exact. */
static const long double number_tens[] = {1e0L,  1e1L,  1e2L,  1e3L,  1e4L,  1e5L,  1e6L,
                                          1e7L,  1e8L,  1e9L,  1e10L, 1e11L, 1e12L, 1e13L,
                                          1e14L, 1e15L, 1e16L, 1e17L, 1e18L};

/* So near to the middle between two numbers of 15 digits the product does not tell which is nearer;
 * it is off by at most 2^-14. */
static const long double number_doubt = 0x1p-12L;
_Static_assert(LDBL_MANT_DIG >= 64, "else the product is off by more");

/* The digits of a size as a whole number.  @return 0: in doubt */
static uint64_t number_digits(long double size, int exponent)
{
    long double scaled = size * number_tens[EXPONENT_MOST - exponent];
    uint64_t whole = (uint64_t)scaled;
    long double rest = scaled - (long double)whole;
    return fabsl(rest - 0.5L) < number_doubt ? 0 : whole + (rest > 0.5L);
}

/* Where the first digit stands: 0 before the point, -1 behind it. */
static int number_exponent(long double size)
{
    int exponent = size < 1 ? -1 : 0;
    while (exponent < 0 && exponent > EXPONENT_LEAST && size * number_tens[-exponent] < 1) {
        exponent--;
    }
    while (exponent >= 0 && exponent < EXPONENT_MOST && size >= number_tens[exponent + 1]) {
        exponent++;
    }
    return exponent;
}

/* Writes the digits with a point behind the one of that exponent; zeros at the end go, but for one
 * behind the point. */
static void number_write(char *at, uint64_t digits, int exponent)
{
    char all[DIGITS];
    for (int i = DIGITS; i-- > 0; digits /= 10) {
        all[i] = (char)('0' + digits % 10);
    }
    int used = DIGITS;
    while (used > 1 && all[used - 1] == '0') {
        used--;
    }
    if (exponent < 0) {
        *at++ = '0';
        *at++ = '.';
        for (int i = -1; i > exponent; i--) {
            *at++ = '0';
        }
    }
    for (int i = 0; i < used || i <= exponent + 1; i++) {
        if (i == exponent + 1 && exponent >= 0) {
            *at++ = '.';
        }
        *at++ = i < used ? all[i] : '0';
    }
    *at = '\0';
}

static const char *number_print_any(double number, char bytes[CLIPS_NUMBER_BYTES])
{
    int len = snprintf(bytes, CLIPS_NUMBER_BYTES - 2, "%.*g", DIGITS, number);
    if (!strpbrk(bytes, ".e")) {
        memcpy(bytes + len, ".0", 3);
    }
    return bytes;
}

const char *clips_number_print(double number, char bytes[CLIPS_NUMBER_BYTES])
{
    double size = fabs(number);
    if (!(size >= 1e-4 && size < 1e15)) { /* nor is it no number */
        return number_print_any(number, bytes);
    }
    int exponent = number_exponent(size);
    uint64_t digits = number_digits(size, exponent);
    if (digits < 100000000000000u || digits >= 1000000000000000u) {
        return number_print_any(number, bytes);
    }
    bytes[0] = '-';
    number_write(bytes + (number < 0), digits, exponent);
    return bytes;
}
