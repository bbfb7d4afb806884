/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers as the C library reads and prints them, at a fraction of its time for those that mail
 * has. */
#ifndef MUSTER_MIND_SYNTAX_NUMBER_H
#define MUSTER_MIND_SYNTAX_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

#define NUMBER_MAX 40 /* bytes of a printed number and its end */

/**
 * Reads [-]digits[.digits].
 *
 * @param len  bytes of the word at `at`
 * @param x    filled in as strtod would
 * @return whether it did: false for other forms, for zero, and where it is not sure of the last bit
 */
bool number_read(const char *at, size_t len, double *x);

/** Prints as "%.17g" does.  @return whether there are only digits, and a sign: CLIPS
 * would take that for an INTEGER */
bool number_print(char to[static NUMBER_MAX], double x);

#endif
