/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file state_walk.h
 * Walks every event in every state of a transition table.
 */
#ifndef MUSTER_TESTS_STATE_WALK_H
#define MUSTER_TESTS_STATE_WALK_H

#include "capture.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* Applies an event, a number, to a machine in a state, another.  @return its state then; -1: the
 * event was refused, and counted */
typedef int state_apply(int state, int event);

/* @return whether the event ends a program */
static inline bool state_aborts(state_apply *on, int state, int event)
{
    int status = 0;
    capture_begin();
    pid_t child = fork();
    if (child == 0) {
        (void)on(state, event);
        _exit(0);
    }
    CU_ASSERT_EQUAL(waitpid(child, &status, 0), child);
    capture_end();
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

/* letters: one for each state, in their order.  A row for each state has that of the next one for
 * each event; '.' is a refusal.  Events of a peer stand before '|', our own behind it. */
static inline void state_walk(state_apply *on, const char *letters, const char *const rows[])
{
    for (int state = 0; letters[state]; state++) {
        int own = (int)strcspn(rows[state], "|");
        CU_ASSERT_EQUAL(rows[state][own], '|');
        for (int event = 0; event < (int)strlen(rows[state]) - 1; event++) {
            char wanted = rows[state][event < own ? event : event + 1];
            if (wanted == '.' && event >= own) {
                CU_ASSERT_TRUE(state_aborts(on, state, event));
            } else {
                int next = wanted == '.' ? -1 : (int)(strchr(letters, wanted) - letters);
                CU_ASSERT_EQUAL(on(state, event), next);
            }
        }
    }
}

#endif
