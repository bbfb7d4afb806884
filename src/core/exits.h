/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file exits.h
 * How programs end: the exit codes that scripts may rely on.
 */
#ifndef MUSTER_CORE_EXITS_H
#define MUSTER_CORE_EXITS_H

#include "muster/result.h"

#include <stdbool.h>

enum mu_exit {
    MU_EXIT_DONE = 0,
    MU_EXIT_EXPECTATION = 1, /* an expectation failed */
    MU_EXIT_USAGE = 2,       /* wrong usage */
    MU_EXIT_FILE = 3,        /* a bad file */
    MU_EXIT_DDS = 4,         /* no broker or agent answers */
    MU_EXIT_CRASH = 5,       /* a process of the run crashed */
    MU_EXIT_REFUSED = 6,     /* refused: by policy, by the agent's state, or a held name */
    MU_EXIT_NO_AGENT = 7,    /* no such agent, group or service, or no agent fits the address */
    MU_EXIT_UNDELIVERED = 8, /* not delivered: expired, dropped, no room; or refused by an answer */
    MU_EXIT_WRITE = 9,       /* cannot write */
    MU_EXIT_SEVERAL = 10,    /* several runs live: say which */
    MU_EXIT_NETWORK = 11,    /* no such network, interface or domain */
    MU_EXIT_UNDONE = 12,     /* something that the experiment named did not happen */
    MU_EXIT_TIME = 124,      /* time limit, or an answer that did not come */
    MU_EXIT_INTERRUPTED = 130
};

/** @return whether a run that ended with this code came to its end, well or not as expected */
static inline bool mu_exit_of_whole_run(int code)
{
    return code == MU_EXIT_DONE || code == MU_EXIT_EXPECTATION || code == MU_EXIT_UNDONE;
}

/** @return the exit code for a result that main() was handed */
int mu_exit_for(mu_result r);

#endif
