/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file interval.h
 * What several runs say of one number: its mean, how far the runs differ, and how sure the mean is.
 */
#ifndef MUSTER_REPORT_INTERVAL_H
#define MUSTER_REPORT_INTERVAL_H

#include <stddef.h>

/* All zero: nothing has been added. */
struct interval {
    size_t count;
    double mean, least, most;
    double squares; /* sum of the squared distances from the mean */
};

void interval_add(struct interval *i, double value);

/** @return the standard deviation of the values, as of a sample (n - 1); 0 for fewer than two */
double interval_deviation(const struct interval *i);

/**
 * Half the width of the interval that has the mean of all possible runs in it 95 times of 100, if
 * the values are normally distributed (Student's t).
 *
 * @return NaN for fewer than two values, of which nothing can be said
 */
double interval_half_width(const struct interval *i);

/** @return t with so much probability between -t and t, for degrees of freedom from 1 on */
double interval_student(double probability, size_t freedom);

#endif
