/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The states of a mind: one table.  A mind does one thing at a time with its CLIPS.  Where output
 * goes, and whether memory is limited, are columns of the state.
 */
#include "mind/engine/engine.h"

#define TO(state)                 \
    {                             \
        STATE_MOVES, MIND_##state \
    }
#define REFUSED                    \
    {                              \
        STATE_REFUSED, MIND_VACANT \
    }
#define ALL_REFUSED                                                           \
    [STATE_LOAD] = REFUSED, [STATE_SENSE] = REFUSED, [STATE_TAKE] = REFUSED,  \
    [STATE_FIRE] = REFUSED, [STATE_HANDLE] = REFUSED, [STATE_LINE] = REFUSED, \
    [STATE_LOOK] = REFUSED, [STATE_SAVE] = REFUSED
#define BUSY                                                \
    {                                                       \
        [STATE_DONE] = TO(READY), [STATE_FAIL] = TO(FAILED) \
    }

/* An empty cell is illegal: only a bug of ours gets there. */
static const struct {
    enum state_outcome outcome;
    enum mind_state next;
} state_table[MIND_STATES][STATE_EVENTS] = {
    [MIND_VACANT] = {ALL_REFUSED, [STATE_BEGIN] = TO(LOADING), [STATE_CLOSE] = TO(VACANT)},
    [MIND_LOADING] = BUSY,
    [MIND_READY] = {[STATE_LOAD] = TO(LOADING),
                    [STATE_SENSE] = TO(SENSING),
                    [STATE_TAKE] = TO(TAKING),
                    [STATE_FIRE] = TO(FIRING),
                    [STATE_HANDLE] = TO(HANDLING),
                    [STATE_LINE] = TO(LINE),
                    [STATE_LOOK] = TO(LOOKING),
                    [STATE_SAVE] = TO(SAVING),
                    [STATE_CLOSE] = TO(VACANT)},
    [MIND_SENSING] = BUSY,
    [MIND_TAKING] = BUSY,
    [MIND_FIRING] = BUSY,
    [MIND_HANDLING] = BUSY,
    [MIND_LINE] = BUSY,
    [MIND_LOOKING] = {[STATE_DONE] = TO(READY)},
    [MIND_SAVING] = BUSY,
    [MIND_FAILED] = {ALL_REFUSED, [STATE_CLOSE] = TO(VACANT)},
};

/* Looking is not limited: it must not make a mind fail that is short of memory. */
static const struct {
    enum state_mode mode;
    bool limited;
    long memory_spare; /* beside what it has, so that a person can tidy up */
} state_columns[MIND_STATES] = {
    [MIND_LOADING] = {.limited = true},
    [MIND_SENSING] = {.limited = true},
    [MIND_TAKING] = {.limited = true},
    [MIND_FIRING] = {STATE_MODE_FIRE, .limited = true},
    [MIND_HANDLING] = {STATE_MODE_FIRE, .limited = true},
    [MIND_LINE] = {STATE_MODE_LINE, .limited = true, .memory_spare = BUDGET_MEMORY_SPARE},
    [MIND_LOOKING] = {STATE_MODE_LINE},
    [MIND_SAVING] = {.limited = true, .memory_spare = BUDGET_MEMORY_SPARE},
};

bool state_on(struct mind *m, enum state_event event)
{
    MU_ASSERT(state_table[m->state][event].outcome != STATE_ILLEGAL);
    if (state_table[m->state][event].outcome == STATE_REFUSED) {
        m->refused_calls++;
        return false;
    }
    m->state = state_table[m->state][event].next;
    return true;
}

enum state_mode state_mode(const struct mind *m)
{
    return state_columns[m->state].mode;
}

bool state_is_limited(const struct mind *m)
{
    return state_columns[m->state].limited;
}

bool state_has_rules(const struct mind *m)
{
    return m->state != MIND_VACANT && m->state != MIND_FAILED;
}

long state_spare(const struct mind *m)
{
    return state_columns[m->state].memory_spare;
}
