/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/process.h"

#include <string.h>

/* clang-format off */
/* The letters of the tables; X is a refusal. */
enum {
    X = 255,
    U = NAME_UNSAID, F = NAME_FOLLOWS, S = NAME_ASKED, A = NAME_ACCEPTED, N = NAME_ASKED_AGAIN,
    R = NAME_REFUSED,
    W = EXIT_LAST_WORDS, M = EXIT_DEPARTING, D = EXIT_DEPARTED, L = EXIT_LEFT
};

static const unsigned char next_life[][LIFE_EVENTS] = {
    /*                start          suspend        resume         dispose */
    [MU_STANDBY]   = {MU_RUNNING,   MU_STANDBY,   MU_STANDBY,   MU_GONE},
    [MU_RUNNING]   = {MU_RUNNING,   MU_SUSPENDED, MU_RUNNING,   MU_GONE},
    [MU_SUSPENDED] = {MU_SUSPENDED, MU_SUSPENDED, MU_RUNNING,   MU_GONE},
    [MU_MOVING]    = {MU_MOVING,    MU_MOVING,    MU_MOVING,    MU_GONE},
    [MU_GONE]      = {MU_GONE,      MU_GONE,      MU_GONE,      MU_GONE},
};

static const unsigned char next_name[NAME_STATES][NAME_EVENTS] = {
    /*                    grant refusal written anew free */
    [NAME_UNSAID]      = {A,    X,      S,      U,   X},
    [NAME_FOLLOWS]     = {X,    X,      F,      U,   U},
    [NAME_ASKED]       = {A,    R,      S,      S,   X},
    [NAME_ACCEPTED]    = {A,    R,      A,      N,   X},
    [NAME_ASKED_AGAIN] = {A,    R,      N,      N,   X},
    [NAME_REFUSED]     = {A,    R,      R,      R,   X},
};

static const unsigned char next_exit[EXIT_STATES][EXIT_EVENTS] = {
    /*                   goes moves said all */
    [EXIT_PRESENT]    = {W,   M,    X},
    [EXIT_LAST_WORDS] = {X,   M,    L},
    [EXIT_DEPARTING]  = {M,   M,    D},
    [EXIT_DEPARTED]   = {X,   D,    X},
    [EXIT_LEFT]       = {X,   D,    X},
};
/* clang-format on */

bool life_name_on(mu_agent *a, enum life_name_event event)
{
    unsigned next = next_name[a->name_state][event];
    if (next == X) {
        MU_ASSERT(event < NAME_OWN_EVENTS);
        a->refused++;
        return false;
    }
    a->name_state = (enum life_name)next;
    return true;
}

void life_exit_on(mu_agent *a, enum life_exit_event event)
{
    unsigned next = next_exit[a->exit][event];
    MU_ASSERT(next != X);
    a->process->leaving += a->exit == EXIT_PRESENT;
    a->exit = (enum life_exit)next;
}

bool life_is_leaving(const mu_agent *a)
{
    return a->exit == EXIT_LAST_WORDS || a->exit == EXIT_DEPARTING;
}

bool life_is_elsewhere(const mu_agent *a)
{
    return a->exit == EXIT_DEPARTING || a->exit == EXIT_DEPARTED;
}

enum mu_state life_next(enum mu_state state, enum life_event event)
{
    return (unsigned)state <= MU_GONE ? (enum mu_state)next_life[state][event] : state;
}

enum mu_state life_wanted(enum life_event event)
{
    return event == LIFE_DISPOSE ? MU_GONE : event == LIFE_SUSPEND ? MU_SUSPENDED : MU_RUNNING;
}

mu_result life_event_named(const char *performative, enum life_event *event)
{
    static const char *const names[LIFE_EVENTS] = {[LIFE_START] = "start",
                                                   [LIFE_SUSPEND] = "suspend",
                                                   [LIFE_RESUME] = "resume",
                                                   [LIFE_DISPOSE] = "dispose"};
    for (int i = 0; i < LIFE_EVENTS; i++) {
        if (strcmp(performative, names[i]) == 0) {
            *event = (enum life_event)i;
            return MU_OK;
        }
    }
    return MU_ABSENT;
}
