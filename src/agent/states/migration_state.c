/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/states/states.h"

/* Purposes that have a transition: bits, 1 << purpose; 0: none. */
enum { MOVE = 1 << MIGRATION_MOVE, CLONE = 1 << MIGRATION_CLONE, BOTH = MOVE | CLONE };

#define GOES(who, state)                          \
    {                                             \
        who, MIGRATION_##state, MIGRATION_##state \
    }

static const struct {
    int who;
    enum migration_state move, clone; /* the next one */
} table[MIGRATION_STATES][MIGRATION_EVENTS] = {
    [MIGRATION_STAYS] =
        {[MIGRATION_BEGINS] = GOES(BOTH, DEPARTS), [MIGRATION_BEGINS_APART] = GOES(CLONE, SENDS)},
    [MIGRATION_DEPARTS] = {[MIGRATION_TAKES_LEAVE] = GOES(MOVE, LAST_WORDS),
                           [MIGRATION_DEPOSITS] = GOES(CLONE, DEPOSITED),
                           [MIGRATION_FAILS] = GOES(BOTH, STAYS),
                           [MIGRATION_GONE] = GOES(BOTH, STAYS)},
    [MIGRATION_LAST_WORDS] = {[MIGRATION_DEPOSITS] = GOES(MOVE, DEPOSITED),
                              [MIGRATION_FAILS] = GOES(MOVE, STAYS),
                              [MIGRATION_GONE] = GOES(MOVE, STAYS)},
    [MIGRATION_DEPOSITED] = {[MIGRATION_STANDS_STILL] = GOES(MOVE, KEPT),
                             [MIGRATION_TAKEN] = GOES(BOTH, STAYS),
                             [MIGRATION_REFUSED] = GOES(BOTH, STAYS)},
    [MIGRATION_KEPT] = {[MIGRATION_STORED] = GOES(MOVE, SENDS),
                        [MIGRATION_READY] = GOES(MOVE, YIELDS),
                        [MIGRATION_REFUSED] = GOES(MOVE, STAYS),
                        [MIGRATION_FAILS] = GOES(MOVE, STAYS)},
    [MIGRATION_SENDS] =
        {[MIGRATION_SENT] = GOES(BOTH, WAITS), [MIGRATION_FAILS] = GOES(BOTH, STAYS)},
    [MIGRATION_WAITS] = {[MIGRATION_AGREED] = {BOTH, MIGRATION_YIELDS, MIGRATION_STAYS},
                         [MIGRATION_DECLINED] = GOES(BOTH, STAYS),
                         [MIGRATION_FAILS] = GOES(BOTH, STAYS)},
    [MIGRATION_YIELDS] = {[MIGRATION_SETTLED] = GOES(MOVE, HANDS_OVER),
                          [MIGRATION_REFUSED] = GOES(MOVE, STAYS),
                          [MIGRATION_FAILS] = GOES(MOVE, STAYS)},
    [MIGRATION_HANDS_OVER] = {[MIGRATION_TAKEN] = GOES(MOVE, STAYS),
                              [MIGRATION_SHOWN] = GOES(MOVE, STAYS),
                              [MIGRATION_REFUSED] = GOES(MOVE, STAYS),
                              [MIGRATION_FAILS] = GOES(MOVE, STAYS)},
};

bool migration_state_has(enum migration_state state, enum migration_purpose purpose,
                         enum migration_event event)
{
    return table[state][event].who & 1 << purpose;
}

bool migration_state_apply(enum migration_state *state, enum migration_purpose purpose,
                           enum migration_event event)
{
    bool has = migration_state_has(*state, purpose, event);
    if (has) {
        *state = purpose == MIGRATION_MOVE ? table[*state][event].move : table[*state][event].clone;
    }
    return has;
}

void migration_state_enter(enum migration_state *state, enum migration_purpose purpose,
                           enum migration_event event)
{
    MU_ASSERT(migration_state_apply(state, purpose, event));
}
