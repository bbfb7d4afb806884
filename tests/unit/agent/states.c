/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Both tables of states, whole: each event in each state.  What is legal stands here a second time,
 * as words; all else must change nothing, and abort where our own code raises it.
 */
#include "agent/states/states.h"
#include "suite.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const robot_states[ROBOT_STATES] = {
    [ROBOT_VACANT] = "vacant",   [ROBOT_JOINS] = "joins",         [ROBOT_RESTORED] = "restored",
    [ROBOT_ARRIVES] = "arrives", [ROBOT_RETURNS] = "returns",     [ROBOT_RETURNED] = "returned",
    [ROBOT_RESTS] = "rests",     [ROBOT_PERCEIVES] = "perceives", [ROBOT_REPEATS] = "repeats"};

static const char *const robot_events[ROBOT_EVENTS] = {
    [ROBOT_BEGINS] = "begins",         [ROBOT_RECALLS] = "recalls",   [ROBOT_ASKS] = "asks",
    [ROBOT_IS_NAMED] = "is-named",     [ROBOT_FEELS] = "feels",       [ROBOT_SITS_OUT] = "sits-out",
    [ROBOT_SAYS_AGAIN] = "says-again", [ROBOT_HAS_FELT] = "has-felt", [ROBOT_LEAVES] = "leaves"};

/* State, event, next. */
static const char *const robot_legal[][3] = {
    {"vacant", "begins", "joins"},         {"vacant", "recalls", "restored"},
    {"vacant", "asks", "arrives"},         {"vacant", "is-named", "rests"},
    {"vacant", "sits-out", "vacant"},      {"vacant", "leaves", "vacant"},
    {"joins", "is-named", "rests"},        {"joins", "leaves", "vacant"},
    {"restored", "asks", "returns"},       {"arrives", "recalls", "returns"},
    {"arrives", "is-named", "rests"},      {"arrives", "leaves", "vacant"},
    {"returns", "is-named", "returned"},   {"returns", "leaves", "vacant"},
    {"returned", "asks", "returns"},       {"returned", "is-named", "returned"},
    {"returned", "feels", "perceives"},    {"returned", "sits-out", "rests"},
    {"returned", "says-again", "repeats"}, {"returned", "leaves", "vacant"},
    {"rests", "asks", "arrives"},          {"rests", "is-named", "rests"},
    {"rests", "feels", "perceives"},       {"rests", "sits-out", "rests"},
    {"rests", "leaves", "vacant"},         {"perceives", "is-named", "perceives"},
    {"perceives", "feels", "perceives"},   {"perceives", "sits-out", "perceives"},
    {"perceives", "has-felt", "rests"},    {"perceives", "leaves", "vacant"},
    {"repeats", "asks", "arrives"},        {"repeats", "is-named", "repeats"},
    {"repeats", "feels", "perceives"},     {"repeats", "sits-out", "rests"},
    {"repeats", "leaves", "vacant"},
};
enum { ROBOT_LEGAL = sizeof robot_legal / sizeof robot_legal[0] };

static const char *const migration_states[MIGRATION_STATES] = {
    [MIGRATION_STAYS] = "stays",
    [MIGRATION_DEPARTS] = "departs",
    [MIGRATION_LAST_WORDS] = "last-words",
    [MIGRATION_DEPOSITED] = "deposited",
    [MIGRATION_KEPT] = "kept",
    [MIGRATION_SENDS] = "sends",
    [MIGRATION_WAITS] = "waits",
    [MIGRATION_YIELDS] = "yields",
    [MIGRATION_HANDS_OVER] = "hands-over"};

static const char *const migration_events[MIGRATION_EVENTS] = {
    [MIGRATION_BEGINS] = "begins",
    [MIGRATION_BEGINS_APART] = "begins-apart",
    [MIGRATION_TAKES_LEAVE] = "takes-leave",
    [MIGRATION_DEPOSITS] = "deposits",
    [MIGRATION_STANDS_STILL] = "stands-still",
    [MIGRATION_STORED] = "stored",
    [MIGRATION_READY] = "ready",
    [MIGRATION_TAKEN] = "taken",
    [MIGRATION_REFUSED] = "refused",
    [MIGRATION_SENT] = "sent",
    [MIGRATION_AGREED] = "agreed",
    [MIGRATION_DECLINED] = "declined",
    [MIGRATION_SETTLED] = "settled",
    [MIGRATION_SHOWN] = "shown",
    [MIGRATION_FAILS] = "fails",
    [MIGRATION_GONE] = "gone"};

/* State, event, the next one of a move and of a copy; "": it does not have the event. */
static const char *const migration_legal[][4] = {
    {"stays", "begins", "departs", "departs"},
    {"stays", "begins-apart", "", "sends"},
    {"departs", "takes-leave", "last-words", ""},
    {"departs", "deposits", "", "deposited"},
    {"departs", "fails", "stays", "stays"},
    {"departs", "gone", "stays", "stays"},
    {"last-words", "deposits", "deposited", ""},
    {"last-words", "fails", "stays", ""},
    {"last-words", "gone", "stays", ""},
    {"deposited", "stands-still", "kept", ""},
    {"deposited", "taken", "stays", "stays"},
    {"deposited", "refused", "stays", "stays"},
    {"kept", "stored", "sends", ""},
    {"kept", "ready", "yields", ""},
    {"kept", "refused", "stays", ""},
    {"kept", "fails", "stays", ""},
    {"sends", "sent", "waits", "waits"},
    {"sends", "fails", "stays", "stays"},
    {"waits", "agreed", "yields", "stays"},
    {"waits", "declined", "stays", "stays"},
    {"waits", "fails", "stays", "stays"},
    {"yields", "settled", "hands-over", ""},
    {"yields", "refused", "stays", ""},
    {"yields", "fails", "stays", ""},
    {"hands-over", "taken", "stays", ""},
    {"hands-over", "shown", "stays", ""},
    {"hands-over", "refused", "stays", ""},
    {"hands-over", "fails", "stays", ""},
};
enum { MIGRATION_LEGAL = sizeof migration_legal / sizeof migration_legal[0] };

/* @return the next state as this file has it; NULL: the event is not legal */
static const char *robot_next(const char *state, const char *event)
{
    for (int i = 0; i < ROBOT_LEGAL; i++) {
        if (strcmp(robot_legal[i][0], state) == 0 && strcmp(robot_legal[i][1], event) == 0) {
            return robot_legal[i][2];
        }
    }
    return NULL;
}

static void test_robot_every_event_in_every_state(void)
{
    int legal = 0;
    for (int s = 0; s < ROBOT_STATES; s++) {
        for (int e = 0; e < ROBOT_EVENTS; e++) {
            enum robot_state state = (enum robot_state)s;
            const char *next = robot_next(robot_states[s], robot_events[e]);
            CU_ASSERT_EQUAL(robot_state_apply(&state, (enum robot_event)e), next != NULL);
            READS(robot_states[state], next ? next : robot_states[s]);
            legal += next != NULL;
        }
    }
    CU_ASSERT_EQUAL(legal, ROBOT_LEGAL);
}

/* The two questions that are asked of a state follow from the same table. */
static void test_robot_who_arrives_and_who_lives(void)
{
    for (int s = 0; s < ROBOT_STATES; s++) {
        enum robot_state state = (enum robot_state)s;
        const char *named = robot_next(robot_states[s], "is-named");
        bool lives = robot_next(robot_states[s], "feels") != NULL;
        CU_ASSERT_EQUAL(robot_state_lives(state), lives || state == ROBOT_PERCEIVES);
        bool asked = state == ROBOT_ARRIVES || state == ROBOT_RETURNS;
        CU_ASSERT_EQUAL(robot_state_arrives(state), asked);
        CU_ASSERT_TRUE(!asked || (named && strcmp(named, robot_states[s]) != 0));
    }
}

static const char *migration_next(const char *state, const char *event, int column)
{
    for (int i = 0; i < MIGRATION_LEGAL; i++) {
        if (strcmp(migration_legal[i][0], state) == 0 &&
            strcmp(migration_legal[i][1], event) == 0) {
            return migration_legal[i][column][0] ? migration_legal[i][column] : NULL;
        }
    }
    return NULL;
}

static void test_migration_every_event_in_every_state(void)
{
    int legal = 0;
    for (int s = 0; s < MIGRATION_STATES; s++) {
        for (int e = 0; e < MIGRATION_EVENTS; e++) {
            int has = 0;
            for (int copies = 0; copies < 2; copies++) {
                enum migration_purpose purpose = copies ? MIGRATION_CLONE : MIGRATION_MOVE;
                enum migration_state state = (enum migration_state)s;
                enum migration_event event = (enum migration_event)e;
                const char *next =
                    migration_next(migration_states[s], migration_events[e], 2 + copies);
                CU_ASSERT_EQUAL(migration_state_has(state, purpose, event), next != NULL);
                CU_ASSERT_EQUAL(migration_state_apply(&state, purpose, event), next != NULL);
                READS(migration_states[state], next ? next : migration_states[s]);
                has += next != NULL;
            }
            legal += has > 0;
        }
    }
    CU_ASSERT_EQUAL(legal, MIGRATION_LEGAL);
}

/* Nobody is on a way for a launch. */
static void test_migration_a_launch_has_no_state(void)
{
    for (int s = 0; s < MIGRATION_STATES; s++) {
        for (int e = 0; e < MIGRATION_EVENTS; e++) {
            CU_ASSERT_FALSE(migration_state_has((enum migration_state)s, MIGRATION_LAUNCH,
                                                (enum migration_event)e));
        }
    }
}

/* From everywhere a migration can come to an end. */
static void test_migration_no_state_is_a_trap(void)
{
    for (int column = 2; column < 4; column++) {
        bool ends[MIGRATION_STATES] = {[MIGRATION_STAYS] = true};
        for (int round = 0; round < MIGRATION_STATES; round++) {
            for (int s = 0; s < MIGRATION_STATES; s++) {
                for (int e = 0; e < MIGRATION_EVENTS; e++) {
                    const char *next =
                        migration_next(migration_states[s], migration_events[e], column);
                    for (int to = 0; next && to < MIGRATION_STATES; to++) {
                        ends[s] |= ends[to] && strcmp(next, migration_states[to]) == 0;
                    }
                }
            }
        }
        for (int s = 0; s < MIGRATION_STATES; s++) {
            bool reached = column == 2 || s == MIGRATION_STAYS || s == MIGRATION_DEPARTS ||
                           s == MIGRATION_DEPOSITED || s == MIGRATION_SENDS || s == MIGRATION_WAITS;
            CU_ASSERT_EQUAL(ends[s], reached);
        }
    }
}

/* @return whether a child process that does this is aborted */
static bool aborts(void (*act)(void))
{
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        struct rlimit none = {0, 0};
        (void)setrlimit(RLIMIT_CORE, &none);
        (void)freopen("/dev/null", "w", stderr);
        act();
        _exit(0);
    }
    int status = 0;
    CU_ASSERT_EQUAL_FATAL(waitpid(child, &status, 0), child);
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

static void robot_begins_twice(void)
{
    enum robot_state state = ROBOT_VACANT;
    robot_state_enter(&state, ROBOT_BEGINS);
    robot_state_enter(&state, ROBOT_BEGINS);
}

static void robot_begins_once(void)
{
    enum robot_state state = ROBOT_VACANT;
    robot_state_enter(&state, ROBOT_BEGINS);
}

static void copy_yields(void)
{
    enum migration_state state = MIGRATION_KEPT;
    migration_state_enter(&state, MIGRATION_CLONE, MIGRATION_READY);
}

static void move_yields(void)
{
    enum migration_state state = MIGRATION_KEPT;
    migration_state_enter(&state, MIGRATION_MOVE, MIGRATION_READY);
}

static void test_our_own_mistakes_abort(void)
{
    CU_ASSERT_TRUE(aborts(robot_begins_twice));
    CU_ASSERT_FALSE(aborts(robot_begins_once));
    CU_ASSERT_TRUE(aborts(copy_yields));
    CU_ASSERT_FALSE(aborts(move_yields));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a robot: every event in every state", test_robot_every_event_in_every_state},
        {"a robot: who arrives and who lives", test_robot_who_arrives_and_who_lives},
        {"a migration: every event in every state", test_migration_every_event_in_every_state},
        {"a migration: a launch has no state", test_migration_a_launch_has_no_state},
        {"a migration: no state is a trap", test_migration_no_state_is_a_trap},
        {"our own mistakes abort", test_our_own_mistakes_abort},
        CU_TEST_INFO_NULL};
    return suite_run("agent/states", tests);
}
