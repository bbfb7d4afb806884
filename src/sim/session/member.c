/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a process that takes part in a run. */
#include "sim/session/parts.h"

#include "core/log.h"
#include "core/text.h"

#include <string.h>

/* The letters of the table; 0 is a refusal. */
enum {
    J = MEMBER_JOINING,
    A = MEMBER_ACTIVE,
    C = MEMBER_CONTESTED,
    L = MEMBER_LOST,
    S = MEMBER_SUPERSEDED,
    R = MEMBER_RELEASED,
    O = MEMBER_LEFT_OUT
};

/* clang-format off */
static const unsigned char next_state[MEMBER_STATES][MEMBER_EVENTS] = {
    /*                     heartbeat loss claim answer joins claim ends leaves out releases */
    [MEMBER_JOINING]    = {J,        J,   0,    J,     A,    0,         0,         0},
    [MEMBER_ACTIVE]     = {A,        L,   C,    A,     0,    0,         0,         0},
    [MEMBER_CONTESTED]  = {C,        S,   C,    A,     0,    A,         0,         0},
    [MEMBER_LOST]       = {A,        L,   S,    L,     0,    0,         O,         0},
    [MEMBER_SUPERSEDED] = {0,        S,   S,    S,     0,    0,         0,         R},
    [MEMBER_RELEASED]   = {0,        R,   0,    0,     0,    0,         0,         0},
    [MEMBER_LEFT_OUT]   = {0,        O,   S,    0,     0,    0,         0,         0},
};
/* clang-format on */

bool member_on(struct session_process *p, enum member_event event)
{
    enum member_state next = (enum member_state)next_state[p->state][event];
    if (next == MEMBER_REFUSES) {
        MU_ASSERT(event < MEMBER_OWN_EVENTS);
        if (p->refused++ == 0) {
            mu_log(MU_LOG_WARNING, "member-refused", "process=%s state=%d event=%d", p->name,
                   (int)p->state, (int)event);
        }
        return false;
    }
    p->state = next;
    return true;
}

void member_claim(struct session_process *p, const char *claimer)
{
    if (strcmp(p->name, claimer) != 0 && member_on(p, MEMBER_CLAIM)) {
        mu_text_copy(p->claimer, sizeof p->claimer, claimer);
    }
}

void member_claim_ends(struct session_process *p, const char *claimer)
{
    if (p->state == MEMBER_CONTESTED && strcmp(p->claimer, claimer) == 0) {
        (void)member_on(p, MEMBER_CLAIM_ENDS);
    }
}

bool member_is_in_steps(const struct session_process *p)
{
    return p->state != MEMBER_RELEASED && p->state != MEMBER_LEFT_OUT;
}

bool member_attends(const struct session_process *p)
{
    return p->sight != MEMBER_HAS_BODIES || p->host[0] != '\0';
}

bool member_is_needed(const struct session_process *p)
{
    return p->sight == MEMBER_WATCHES;
}
