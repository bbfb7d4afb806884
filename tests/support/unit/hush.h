/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file hush.h
 * Silences standard error where faults come in thousands: a few are of use to a person, not these.
 */
#ifndef MUSTER_TESTS_HUSH_H
#define MUSTER_TESTS_HUSH_H

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

/** @return what unhush wants */
static inline int hush(void)
{
    fflush(stderr);
    int kept = dup(STDERR_FILENO);
    int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    close(nowhere);
    return kept;
}

static inline void unhush(int kept)
{
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
}

#endif
