/* SPDX-License-Identifier: Apache-2.0 */
/* The whole tables of what a process is to the broker: its session, its turn, its role in a run;
 * and of how a name ends, its bearer, and what is reported of that. */
#include "broker/steps/steps.h"
#include "state_walk.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>

static struct processes processes; /* static: leak checkers see its memory */

static int apply_session(int state, int event)
{
    struct process *at = &processes.at[0];
    *at = (struct process){.session = (enum session)state};
    processes.hearers = processes_hears(at);
    processes_session_on(&processes, 0, (enum session_event)event);
    CU_ASSERT_EQUAL(processes.hearers, processes_hears(at));
    return (int)at->session;
}

static int apply_turn(int state, int event)
{
    struct process *at = &processes.at[0];
    *at = (struct process){.turn = (enum turn_state)state};
    processes.held = at->turn == TURN_HELD;
    processes.refused = at->turn == TURN_REFUSED;
    processes_turn_on(&processes, 0, (enum turn_event)event);
    CU_ASSERT_EQUAL(processes.held, at->turn == TURN_HELD);
    CU_ASSERT_EQUAL(processes.refused, at->turn == TURN_REFUSED);
    return (int)at->turn;
}

static int apply_role(int state, int event)
{
    enum role next = role_next((enum role)state, (enum role_event)event);
    if (next == ROLES) {
        abort(); /* as steps_role_on does */
    }
    return (int)next;
}

static void test_sessions(void)
{
    /* free, Away, There, Hears multicasts; the same and silent: B, U, I */
    static const char *const rows[SESSIONS] = {"|A......", "|.TA.ABf", "|.TAHTU.", "|.TAHHI.",
                                               "|.UB.ABf", "|.UBITU.", "|.UBIHI."};
    static const char *const matched = ".xx.xx"; /* of all but the free one */
    for (int i = 0; i < SESSIONS; i++) {
        struct process at = {.session = (enum session)i};
        CU_ASSERT_EQUAL(processes_is_matched(&at), i > 0 && matched[i - 1] == 'x');
        CU_ASSERT_EQUAL(processes_is_silent(&at), i >= SESSION_AWAY_SILENT);
    }
    CU_ASSERT_EQUAL(SESSION_EVENTS, 7);
    state_walk(apply_session, "fATHBUI", rows);
}

static void test_turns(void)
{
    /* iDle, Held, refused by the Network */
    static const char *const turns[TURNS] = {"|HDNDD", "|HDNHD", "|.NNDD"};
    CU_ASSERT_EQUAL(TURN_EVENTS, 5);
    state_walk(apply_turn, "DHN", turns);
}

static void test_roles(void)
{
    /* Outside, Simulator (P: owed its Delivery), Awaited (B), answered (Y, Z) */
    static const char *const rows[ROLES] = {"|AS..O..", "|....P.O", "|....PSO", "|..YAB.O",
                                            "|..ZBBAO", "|...AZ.O", "|...BZYO"};
    CU_ASSERT_EQUAL(ROLE_EVENTS, 7);
    state_walk(apply_role, "OSPABYZ", rows);
}

static int apply_name(int state, int event)
{
    static struct agent agent;
    struct registry registry = {.agents = &agent};
    agent.named = (enum name_state)state;
    registry_named_on(&registry, 0, (enum name_event)event);
    return (int)agent.named;
}

static void test_names(void)
{
    /* Lasts, ends with the Run, Ends, enDed */
    static const char *const rows[NAMED_STATES] = {"|LER.", "|LRRD", "|LERD", "|L..."};
    CU_ASSERT_EQUAL(NAMED_EVENTS, 4);
    state_walk(apply_name, "LRED", rows);
}

static int apply_bearer(int state, int event)
{
    static struct agent agent;
    struct registry registry = {.agents = &agent};
    agent.bearer = (enum bearer)state;
    names_bearer_on(&registry, 0, (enum bearer_event)event);
    return (int)agent.bearer;
}

static void test_bearers(void)
{
    /* None, Awaited, Owed a verdict, Told */
    static const char *const rows[BEARERS] = {"|O....AN", "|O....AN", "|OOTTN..", "|OOT.N.."};
    CU_ASSERT_EQUAL(BEARER_EVENTS, 7);
    state_walk(apply_bearer, "NAOT", rows);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"sessions", test_sessions}, {"turns", test_turns},     {"roles", test_roles},
        {"names", test_names},       {"bearers", test_bearers}, CU_TEST_INFO_NULL,
    };
    return suite_run("broker/process_states", tests);
}
