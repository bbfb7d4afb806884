/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a run, as the simulator sees it. */
#include "sim/session/parts.h"

#include "core/log.h"

/* The letters of the table; 0 is a refusal. */
enum {
    G = PHASE_GATHERING,
    R = PHASE_READY,
    C = PHASE_CALLED,
    N = PHASE_RUNNING,
    S = PHASE_SETTLING,
    P = PHASE_PAUSED,
    p = PHASE_PAUSED_SETTLING,
    H = PHASE_HELD,
    h = PHASE_HELD_SETTLING,
    E = PHASE_ENDING,
    D = PHASE_DONE,
    F = PHASE_FAULT
};

/* clang-format off */
static const unsigned char next_phase[PHASES][PHASE_EVENTS] = {
    /*                         go end departs all lacks settled pauses holds resumes done fails */
    [PHASE_GATHERING]       = {C, E,  0,      R,  G,    0,      0,     0,    0,      0,   0},
    [PHASE_READY]           = {C, E,  0,      R,  G,    0,      0,     0,    0,      0,   0},
    [PHASE_CALLED]          = {0, E,  0,      N,  C,    0,      0,     0,    0,      0,   0},
    [PHASE_RUNNING]         = {0, E,  S,      0,  0,    0,      P,     H,    0,      0,   F},
    [PHASE_SETTLING]        = {0, E,  S,      0,  0,    N,      p,     h,    0,      0,   F},
    [PHASE_PAUSED]          = {N, E,  0,      0,  0,    0,      0,     0,    N,      0,   0},
    [PHASE_PAUSED_SETTLING] = {S, E,  0,      0,  0,    0,      0,     0,    S,      0,   0},
    [PHASE_HELD]            = {0, E,  h,      0,  0,    0,      0,     0,    N,      0,   F},
    [PHASE_HELD_SETTLING]   = {0, E,  h,      0,  0,    0,      0,     0,    S,      0,   F},
    [PHASE_ENDING]          = {0, E,  E,      0,  0,    E,      E,     0,    E,      D,   F},
};
/* clang-format on */

bool phase_on(struct session *s, enum phase_event event)
{
    enum phase next = (enum phase)next_phase[s->phase][event];
    if (next == PHASE_REFUSES) {
        MU_ASSERT(event < PHASE_OWN_EVENTS);
        s->refused++;
        mu_log(MU_LOG_INFO, "phase-refused", "phase=%d event=%d", (int)s->phase, (int)event);
        return false;
    }
    s->phase = next;
    return true;
}

bool phase_ends(struct session *s)
{
    if (*s->options.signal_came) {
        (void)phase_on(s, PHASE_END);
    }
    return s->phase == PHASE_ENDING;
}

bool phase_has_begun(const struct session *s)
{
    return s->phase >= PHASE_RUNNING;
}

bool phase_is_held(const struct session *s)
{
    return s->phase == PHASE_HELD || s->phase == PHASE_HELD_SETTLING;
}

bool phase_is_paused(const struct session *s)
{
    return s->phase == PHASE_PAUSED || s->phase == PHASE_PAUSED_SETTLING;
}

muster_RunState phase_word(const struct session *s)
{
    static const muster_RunState words[PHASES] = {[PHASE_GATHERING] = muster_RUN_WAITING,
                                                  [PHASE_READY] = muster_RUN_READY,
                                                  [PHASE_CALLED] = muster_RUN_WAITING,
                                                  [PHASE_RUNNING] = muster_RUN_RUNNING,
                                                  [PHASE_SETTLING] = muster_RUN_RUNNING,
                                                  [PHASE_PAUSED] = muster_RUN_RUNNING,
                                                  [PHASE_PAUSED_SETTLING] = muster_RUN_RUNNING,
                                                  [PHASE_HELD] = muster_RUN_RUNNING,
                                                  [PHASE_HELD_SETTLING] = muster_RUN_RUNNING,
                                                  [PHASE_ENDING] = muster_RUN_RUNNING,
                                                  [PHASE_DONE] = muster_RUN_DONE,
                                                  [PHASE_FAULT] = muster_RUN_FAULT};
    return words[s->phase];
}
