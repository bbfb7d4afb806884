/* SPDX-License-Identifier: Apache-2.0 */
/* The phases of a run as a watch sees it. */
#include "muster/result.h"
#include "runtime/watch.h"

/* clang-format off */
/* The letters of the table; X: that may not be. */
enum {
    X = 255,
    A = WATCH_AWAY, M = WATCH_MET, S = WATCH_SEEN,
    o = WATCH_OVER_AWAY, O = WATCH_OVER_MET, E = WATCH_OVER_SEEN,
    t = WATCH_TOLD_AWAY, T = WATCH_TOLD_MET
};

static const unsigned char next_phase[WATCH_PHASES][WATCH_EVENTS] = {
    /*                   meets scene goes on ends leaves tells */
    [WATCH_AWAY]      = {M,    S,    A,      o,   A,     X},
    [WATCH_MET]       = {M,    S,    M,      O,   X,     t},
    [WATCH_SEEN]      = {S,    S,    S,      E,   X,     t},
    [WATCH_OVER_AWAY] = {O,    S,    o,      o,   o,     X},
    [WATCH_OVER_MET]  = {O,    S,    O,      O,   X,     t},
    [WATCH_OVER_SEEN] = {E,    S,    E,      E,   X,     t},
    [WATCH_TOLD_AWAY] = {T,    S,    A,      t,   t,     X},
    [WATCH_TOLD_MET]  = {T,    S,    M,      T,   t,     X},
};
/* clang-format on */

void watch_phase_on(enum watch_phase *phase, enum watch_event event)
{
    unsigned next = next_phase[*phase][event];
    MU_ASSERT(next != X);
    *phase = (enum watch_phase)next;
}

bool watch_may_tell(enum watch_phase phase)
{
    return next_phase[phase][WATCH_TELLS] != X;
}
