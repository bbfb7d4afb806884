/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/process.h"

#include <string.h>

/* The letters of the tables; X is a refusal. */
enum {
    X = 255,
    U = NAME_UNSAID,
    F = NAME_FOLLOWS,
    S = NAME_ASKED,
    A = NAME_ACCEPTED,
    N = NAME_ASKED_AGAIN,
    R = NAME_REFUSED,
    W = EXIT_LAST_WORDS,
    M = EXIT_DEPARTING,
    D = EXIT_DEPARTED,
    L = EXIT_LEFT
};

/* clang-format off */
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
    if (event == LIFE_DISPOSE) {
        return MU_GONE;
    }
    switch (state) {
    case MU_STANDBY: return event == LIFE_START ? MU_RUNNING : state;
    case MU_RUNNING: return event == LIFE_SUSPEND ? MU_SUSPENDED : state;
    case MU_SUSPENDED: return event == LIFE_RESUME ? MU_RUNNING : state;
    case MU_MOVING:
    case MU_GONE: return state;
    }
    return state;
}

enum mu_state life_wanted(enum life_event event)
{
    switch (event) {
    case LIFE_START:
    case LIFE_RESUME: return MU_RUNNING;
    case LIFE_SUSPEND: return MU_SUSPENDED;
    case LIFE_DISPOSE:
    case LIFE_EVENTS: break;
    }
    return MU_GONE;
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
