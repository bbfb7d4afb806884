/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a run, as the simulator sees it. */
#include "sim/session/parts.h"

#include "core/log.h"

/* Events of peers come first; the others are the session's own. */
static const enum phase next_phase[PHASES][PHASE_EVENTS] = {
    [PHASE_GATHERING] = {[PHASE_GO] = PHASE_CALLED,
                         [PHASE_END] = PHASE_ENDING,
                         [PHASE_COMPLETE] = PHASE_READY,
                         [PHASE_INCOMPLETE] = PHASE_GATHERING},
    [PHASE_READY] = {[PHASE_GO] = PHASE_CALLED,
                     [PHASE_END] = PHASE_ENDING,
                     [PHASE_COMPLETE] = PHASE_READY,
                     [PHASE_INCOMPLETE] = PHASE_GATHERING},
    [PHASE_CALLED] = {[PHASE_END] = PHASE_ENDING,
                      [PHASE_COMPLETE] = PHASE_RUNNING,
                      [PHASE_INCOMPLETE] = PHASE_CALLED},
    [PHASE_RUNNING] = {[PHASE_END] = PHASE_ENDING,
                       [PHASE_DEPARTURE] = PHASE_SETTLING,
                       [PHASE_PAUSES] = PHASE_PAUSED,
                       [PHASE_HOLDS] = PHASE_HELD,
                       [PHASE_FAILS] = PHASE_FAULT},
    [PHASE_SETTLING] = {[PHASE_END] = PHASE_ENDING,
                        [PHASE_DEPARTURE] = PHASE_SETTLING,
                        [PHASE_SETTLED] = PHASE_RUNNING,
                        [PHASE_PAUSES] = PHASE_PAUSED_SETTLING,
                        [PHASE_HOLDS] = PHASE_HELD_SETTLING,
                        [PHASE_FAILS] = PHASE_FAULT},
    [PHASE_PAUSED] =
        {[PHASE_GO] = PHASE_RUNNING, [PHASE_END] = PHASE_ENDING, [PHASE_RESUMES] = PHASE_RUNNING},
    [PHASE_PAUSED_SETTLING] =
        {[PHASE_GO] = PHASE_SETTLING, [PHASE_END] = PHASE_ENDING, [PHASE_RESUMES] = PHASE_SETTLING},
    [PHASE_HELD] = {[PHASE_END] = PHASE_ENDING,
                    [PHASE_DEPARTURE] = PHASE_HELD_SETTLING,
                    [PHASE_RESUMES] = PHASE_RUNNING,
                    [PHASE_FAILS] = PHASE_FAULT},
    [PHASE_HELD_SETTLING] = {[PHASE_END] = PHASE_ENDING,
                             [PHASE_DEPARTURE] = PHASE_HELD_SETTLING,
                             [PHASE_RESUMES] = PHASE_SETTLING,
                             [PHASE_FAILS] = PHASE_FAULT},
    [PHASE_ENDING] = {[PHASE_END] = PHASE_ENDING,
                      [PHASE_DEPARTURE] = PHASE_ENDING,
                      [PHASE_SETTLED] = PHASE_ENDING,
                      [PHASE_PAUSES] = PHASE_ENDING,
                      [PHASE_RESUMES] = PHASE_ENDING,
                      [PHASE_FINISHES] = PHASE_DONE,
                      [PHASE_FAILS] = PHASE_FAULT},
};

bool phase_on(struct session *s, enum phase_event event)
{
    enum phase next = next_phase[s->phase][event];
    if (next == PHASE_REFUSES) {
        MU_ASSERT(event < PHASE_OWN_EVENTS);
        s->refused++;
        mu_log(MU_LOG_INFO, "event-refused", "phase=%d event=%d", (int)s->phase, (int)event);
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
    static const muster_RunState words[PHASES] = {[PHASE_REFUSES] = muster_RUN_WAITING,
                                                  [PHASE_GATHERING] = muster_RUN_WAITING,
                                                  [PHASE_CALLED] = muster_RUN_WAITING,
                                                  [PHASE_READY] = muster_RUN_READY,
                                                  [PHASE_RUNNING] = muster_RUN_RUNNING,
                                                  [PHASE_SETTLING] = muster_RUN_RUNNING,
                                                  [PHASE_PAUSED] = muster_RUN_RUNNING,
                                                  [PHASE_HELD] = muster_RUN_RUNNING,
                                                  [PHASE_PAUSED_SETTLING] = muster_RUN_RUNNING,
                                                  [PHASE_ENDING] = muster_RUN_RUNNING,
                                                  [PHASE_HELD_SETTLING] = muster_RUN_RUNNING,
                                                  [PHASE_DONE] = muster_RUN_DONE,
                                                  [PHASE_FAULT] = muster_RUN_FAULT};
    return words[s->phase];
}
