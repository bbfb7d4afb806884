/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/states/states.h"

/* Marks the cells that the table has. */
enum { NONE, TO };

#define GOES(state)       \
    {                     \
        TO, ROBOT_##state \
    }

static const struct {
    int has;
    enum robot_state next;
} table[ROBOT_STATES][ROBOT_EVENTS] = {
    [ROBOT_VACANT] = {[ROBOT_BEGINS] = GOES(JOINS),
                      [ROBOT_RECALLS] = GOES(RESTORED),
                      [ROBOT_ASKS] = GOES(ARRIVES),
                      [ROBOT_IS_NAMED] = GOES(RESTS), /* another broker refused it before */
                      [ROBOT_SITS_OUT] = GOES(VACANT),
                      [ROBOT_LEAVES] = GOES(VACANT)},
    [ROBOT_JOINS] = {[ROBOT_IS_NAMED] = GOES(RESTS), [ROBOT_LEAVES] = GOES(VACANT)},
    [ROBOT_RESTORED] = {[ROBOT_ASKS] = GOES(RETURNS)},
    [ROBOT_ARRIVES] = {[ROBOT_RECALLS] = GOES(RETURNS),
                       [ROBOT_IS_NAMED] = GOES(RESTS),
                       [ROBOT_LEAVES] = GOES(VACANT)},
    [ROBOT_RETURNS] = {[ROBOT_IS_NAMED] = GOES(RETURNED), [ROBOT_LEAVES] = GOES(VACANT)},
    [ROBOT_RETURNED] = {[ROBOT_ASKS] = GOES(RETURNS), /* it set out, but no host took it in */
                        [ROBOT_IS_NAMED] = GOES(RETURNED),
                        [ROBOT_FEELS] = GOES(PERCEIVES),
                        [ROBOT_SITS_OUT] = GOES(RESTS),
                        [ROBOT_SAYS_AGAIN] = GOES(REPEATS),
                        [ROBOT_LEAVES] = GOES(VACANT)},
    [ROBOT_RESTS] = {[ROBOT_ASKS] = GOES(ARRIVES),
                     [ROBOT_IS_NAMED] = GOES(RESTS),
                     [ROBOT_FEELS] = GOES(PERCEIVES),
                     [ROBOT_SITS_OUT] = GOES(RESTS),
                     [ROBOT_LEAVES] = GOES(VACANT)},
    [ROBOT_PERCEIVES] = {[ROBOT_IS_NAMED] = GOES(PERCEIVES),
                         [ROBOT_FEELS] = GOES(PERCEIVES),
                         [ROBOT_SITS_OUT] = GOES(PERCEIVES),
                         [ROBOT_HAS_FELT] = GOES(RESTS),
                         [ROBOT_LEAVES] = GOES(VACANT)},
    [ROBOT_REPEATS] = {[ROBOT_ASKS] = GOES(ARRIVES),
                       [ROBOT_IS_NAMED] = GOES(REPEATS),
                       [ROBOT_FEELS] = GOES(PERCEIVES),
                       [ROBOT_SITS_OUT] = GOES(RESTS),
                       [ROBOT_LEAVES] = GOES(VACANT)},
};

bool robot_state_apply(enum robot_state *state, enum robot_event event)
{
    if (table[*state][event].has == NONE) {
        return false;
    }
    *state = table[*state][event].next;
    return true;
}

void robot_state_enter(enum robot_state *state, enum robot_event event)
{
    MU_ASSERT(robot_state_apply(state, event));
}

bool robot_state_arrives(enum robot_state state)
{
    return state == ROBOT_ARRIVES || state == ROBOT_RETURNS;
}

bool robot_state_lives(enum robot_state state)
{
    return state >= ROBOT_RETURNED;
}
