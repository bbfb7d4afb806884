/* SPDX-License-Identifier: Apache-2.0 */
#include "report/compare/compare.h"

#include <math.h>
#include <stdbool.h>

#define INTERVAL_PROBABILITY 0.95

/* Welford's way: no sum of squares that the mean drowns in. */
void interval_add(struct interval *i, double value)
{
    i->count++;
    double far = value - i->mean;
    i->mean += far / (double)i->count;
    i->squares += far * (value - i->mean);
    i->least = i->count == 1 ? value : fmin(i->least, value);
    i->most = i->count == 1 ? value : fmax(i->most, value);
}

double interval_deviation(const struct interval *i)
{
    return i->count < 2 ? 0 : sqrt(i->squares / (double)(i->count - 1));
}

/* The probability between -t and t, for whole degrees of freedom: Abramowitz and Stegun, Handbook
 * of Mathematical Functions, 26.7.3 (odd) and 26.7.4 (even). */
static double student_between(double t, size_t freedom)
{
    double angle = atan(t / sqrt((double)freedom));
    double cosine2 = cos(angle) * cos(angle);
    bool odd = freedom % 2 == 1;
    double term = odd ? cos(angle) : 1;
    double sum = freedom == 1 ? 0 : term;
    for (size_t k = odd ? 3 : 2; k + 1 < freedom; k += 2) {
        term *= cosine2 * (double)(k - 1) / (double)k;
        sum += term;
    }
    return odd ? M_2_PI * (angle + sin(angle) * sum) : sin(angle) * sum;
}

double interval_student(double probability, size_t freedom)
{
    double low = 0, high = 1;
    while (student_between(high, freedom) < probability && high < 1e9) {
        high *= 2;
    }
    for (int i = 0; i < 100; i++) {
        double middle = (low + high) / 2;
        *(student_between(middle, freedom) < probability ? &low : &high) = middle;
    }
    return (low + high) / 2;
}

double interval_half_width(const struct interval *i)
{
    if (i->count < 2) {
        return NAN;
    }
    double t = interval_student(INTERVAL_PROBABILITY, i->count - 1);
    return t * interval_deviation(i) / sqrt((double)i->count);
}
