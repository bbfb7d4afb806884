/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file exits.h
 * How programs end: the exit codes that scripts may rely on.
 */
#ifndef MUSTER_CORE_EXITS_H
#define MUSTER_CORE_EXITS_H

#include "muster/result.h"

#include <stdbool.h>
#include <stddef.h>

/* What each means stands in one table, in exits.c. */
enum mu_exit {
    MU_EXIT_DONE = 0,
    MU_EXIT_EXPECTATION = 1,
    MU_EXIT_USAGE = 2,
    MU_EXIT_FILE = 3,
    MU_EXIT_DDS = 4,
    MU_EXIT_CRASH = 5,
    MU_EXIT_REFUSED = 6,
    MU_EXIT_NO_AGENT = 7,
    MU_EXIT_UNDELIVERED = 8,
    MU_EXIT_WRITE = 9,
    MU_EXIT_SEVERAL = 10,
    MU_EXIT_NETWORK = 11,
    MU_EXIT_UNDONE = 12,
    MU_EXIT_OTHER = 13,
    MU_EXIT_TIME = 124,
    MU_EXIT_INTERRUPTED = 130
};

/** @return whether a run that ended with this code came to its end, well or not as expected */
static inline bool mu_exit_of_whole_run(int code)
{
    return code == MU_EXIT_DONE || code == MU_EXIT_EXPECTATION || code == MU_EXIT_UNDONE;
}

struct mu_exit_row {
    int code;
    const char *word; /* for programs: "no-answer" */
    const char *meaning;
};

/** @return the index-th row of the table of exit codes; NULL past the last */
const struct mu_exit_row *mu_exit_at(size_t index);

/** @return the row of a code; that of a crash if it has none */
const struct mu_exit_row *mu_exit_find(int code);

/** @return the exit code for a result that main() was handed */
int mu_exit_for(mu_result r);

#endif
