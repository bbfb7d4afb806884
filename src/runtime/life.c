/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/life.h"

#include <string.h>

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
