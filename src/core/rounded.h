/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file rounded.h
 * Numbers as run.csv has them: a program that counts with them agrees with a reader of that file.
 */
#ifndef MUSTER_CORE_ROUNDED_H
#define MUSTER_CORE_ROUNDED_H

#include <math.h>

/** @return the number that a reader makes of six decimals: both parts of the quotient are exact */
static inline double mu_rounded(double value)
{
    return (double)llround(value * 1e6) / 1e6;
}

#endif
