/* SPDX-License-Identifier: Apache-2.0 */
/** @file units.h  The topics of a module's unit tests: a table that the Makefile prints. */
#ifndef MUSTER_TESTS_UNITS_H
#define MUSTER_TESTS_UNITS_H

struct unit {
    const char *topic; /**< the file's name; NULL ends the table */
    int (*run)(void);  /**< its main.  @return EXIT_SUCCESS if every assertion held */
};

extern const struct unit units[];

#endif
