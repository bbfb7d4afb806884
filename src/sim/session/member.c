/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a process that takes part in a run. */
#include "sim/session/parts.h"

#include "core/log.h"
#include "core/text.h"

#include <string.h>

/* Events of peers come first; the others are the session's own. */
static const enum member_state next_state[MEMBER_STATES][MEMBER_EVENTS] = {
    [MEMBER_JOINING] = {[MEMBER_HEARTBEAT] = MEMBER_JOINING,
                        [MEMBER_LOSS] = MEMBER_JOINING,
                        [MEMBER_ANSWER] = MEMBER_JOINING,
                        [MEMBER_JOINS] = MEMBER_ACTIVE},
    [MEMBER_ACTIVE] = {[MEMBER_HEARTBEAT] = MEMBER_ACTIVE,
                       [MEMBER_LOSS] = MEMBER_LOST,
                       [MEMBER_CLAIM] = MEMBER_CONTESTED,
                       [MEMBER_ANSWER] = MEMBER_ACTIVE},
    [MEMBER_CONTESTED] = {[MEMBER_HEARTBEAT] = MEMBER_CONTESTED,
                          [MEMBER_LOSS] = MEMBER_SUPERSEDED,
                          [MEMBER_CLAIM] = MEMBER_CONTESTED,
                          [MEMBER_ANSWER] = MEMBER_ACTIVE,
                          [MEMBER_CLAIM_ENDS] = MEMBER_ACTIVE},
    [MEMBER_LOST] = {[MEMBER_HEARTBEAT] = MEMBER_ACTIVE,
                     [MEMBER_LOSS] = MEMBER_LOST,
                     [MEMBER_CLAIM] = MEMBER_SUPERSEDED,
                     [MEMBER_ANSWER] = MEMBER_LOST,
                     [MEMBER_LEAVES_OUT] = MEMBER_LEFT_OUT},
    [MEMBER_SUPERSEDED] = {[MEMBER_LOSS] = MEMBER_SUPERSEDED,
                           [MEMBER_CLAIM] = MEMBER_SUPERSEDED,
                           [MEMBER_ANSWER] = MEMBER_SUPERSEDED,
                           [MEMBER_RELEASES] = MEMBER_RELEASED},
    [MEMBER_RELEASED] = {[MEMBER_LOSS] = MEMBER_RELEASED},
    [MEMBER_LEFT_OUT] = {[MEMBER_LOSS] = MEMBER_LEFT_OUT, [MEMBER_CLAIM] = MEMBER_SUPERSEDED},
};

bool member_on(struct session_process *p, enum member_event event)
{
    enum member_state next = next_state[p->state][event];
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

bool member_is_needed(const struct session_process *p)
{
    return (p->roles & (MEMBER_WATCHES | MEMBER_ONLOOKS)) == MEMBER_WATCHES;
}
