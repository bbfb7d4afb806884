/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a process: in the simulator's steps, and of the Up that it puts together. */
#include "runtime/process.h"

/* clang-format off */
/* The letters of the tables; X is a refusal. */
enum {
    X = 255,
    F = PROCESS_FREE, G = PROCESS_GREETED, R = PROCESS_READY, S = PROCESS_STEPPING,
    L = PROCESS_LIVED, D = PROCESS_DONE,
    N = UP_NONE, A = UP_ANSWERING, P = UP_PENDING
};

static const unsigned char next_steps[PROCESS_STEPS][STEP_EVENTS] = {
    /*                    greeting lock step free last matched unmatched lived over */
    [PROCESS_FREE]     = {G,       S,        F,   D,   X,      X,        X,    F},
    [PROCESS_GREETED]  = {G,       S,        G,   D,   R,      X,        X,    F},
    [PROCESS_READY]    = {R,       S,        R,   D,   X,      G,        X,    F},
    [PROCESS_STEPPING] = {S,       S,        G,   D,   X,      X,        L,    F},
    [PROCESS_LIVED]    = {L,       L,        G,   D,   X,      X,        X,    F},
    [PROCESS_DONE]     = {X,       X,        X,   X,   X,      X,        X,    X},
};

static const unsigned char next_up[UP_STATES][UP_EVENTS] = {
    /*                answers goes written dropped */
    [UP_NONE]      = {A,      P,   X,      N},
    [UP_ANSWERING] = {X,      P,   X,      X},
    [UP_PENDING]   = {X,      X,   N,      N},
};
/* clang-format on */

bool process_step_on(mu_process *p, enum process_step_event event)
{
    unsigned next = next_steps[p->steps][event];
    if (next == X) {
        MU_ASSERT(event < STEP_OWN_EVENTS);
        p->refused++;
        return false;
    }
    p->steps = (enum process_steps)next;
    return true;
}

void process_up_on(mu_process *p, enum process_up_event event)
{
    unsigned next = next_up[p->up_state][event];
    MU_ASSERT(next != X);
    p->up_state = (enum process_up)next;
}
