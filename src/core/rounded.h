/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file rounded.h
 * Numbers as run.csv has them, for who counts what a reader of it will count.
 */
#ifndef MUSTER_CORE_ROUNDED_H
#define MUSTER_CORE_ROUNDED_H

#include <math.h>

/** @return what a reader makes of the number's six decimals: both parts of the quotient are exact
 */
static inline double mu_rounded(double value)
{
    return (double)llround(value * 1e6) / 1e6;
}

#endif
