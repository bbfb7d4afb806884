/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file process_states.h
 * The legal combinations of the booleans that a broker keeps of a process.
 */
#ifndef MUSTER_TESTS_PROCESS_STATES_H
#define MUSTER_TESTS_PROCESS_STATES_H

#include "broker/control/parts.h"

#include <string.h>

static inline bool process_states_has(const char *const *legal, const char *found)
{
    while (*legal && strcmp(*legal, found) != 0) {
        legal++;
    }
    return *legal != NULL;
}

/* @return whether each process is in a legal state */
static inline bool process_states_legal(const struct broker *b)
{
    static const char *const turns[] = {"---", "q--", "-h-", "qh-", "--b",
                                        "q-b", "-hb", "qhb", NULL};
    bool legal = true;
    for (uint32_t i = 0; i < b->processes.top; i++) {
        const struct process *at = &b->processes.at[i];
        char turn[] = {at->queued ? 'q' : '-', at->held ? 'h' : '-', at->blocked ? 'b' : '-', 0};
        legal = legal && process_states_has(turns, turn) &&
                (at->session != SESSION_FREE || !at->blocked);
    }
    return legal;
}

#endif
