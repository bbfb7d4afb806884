/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/process.h"
#include "runtime/watch.h"
#include "state_walk.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

enum { STATES = MU_GONE + 1 };

/* Every event in every state. */
static void test_the_whole_state_machine(void)
{
    static const enum mu_state next[STATES][LIFE_EVENTS] = {
        /*                 start         suspend       resume        dispose */
        [MU_STANDBY] = {MU_RUNNING, MU_STANDBY, MU_STANDBY, MU_GONE},
        [MU_RUNNING] = {MU_RUNNING, MU_SUSPENDED, MU_RUNNING, MU_GONE},
        [MU_SUSPENDED] = {MU_SUSPENDED, MU_SUSPENDED, MU_RUNNING, MU_GONE},
        [MU_MOVING] = {MU_MOVING, MU_MOVING, MU_MOVING, MU_GONE},
        [MU_GONE] = {MU_GONE, MU_GONE, MU_GONE, MU_GONE},
    };
    for (int state = 0; state < STATES; state++) {
        for (int event = 0; event < LIFE_EVENTS; event++) {
            CU_ASSERT_EQUAL(life_next((enum mu_state)state, (enum life_event)event),
                            next[state][event]);
        }
    }
}

static mu_process process;

static int apply_name(int state, int event)
{
    mu_agent a = {.process = &process, .name_state = (enum life_name)state};
    bool allowed = life_name_on(&a, (enum life_name_event)event);
    CU_ASSERT_EQUAL(a.refused, !allowed);
    CU_ASSERT(allowed || a.name_state == (enum life_name)state);
    return allowed ? (int)a.name_state : -1;
}

static int apply_exit(int state, int event)
{
    mu_agent a = {.process = &process, .exit = (enum life_exit)state};
    process.leaving = 0;
    life_exit_on(&a, (enum life_exit_event)event);
    CU_ASSERT_EQUAL(process.leaving, state == EXIT_PRESENT);
    return (int)a.exit;
}

static int apply_step(int state, int event)
{
    process.steps = (enum process_steps)state;
    process.refused = 0;
    bool allowed = process_step_on(&process, (enum process_step_event)event);
    CU_ASSERT_EQUAL(process.refused, !allowed);
    CU_ASSERT(allowed || process.steps == (enum process_steps)state);
    return allowed ? (int)process.steps : -1;
}

static int apply_up(int state, int event)
{
    process.up_state = (enum process_up)state;
    process_up_on(&process, (enum process_up_event)event);
    return (int)process.up_state;
}

static int apply_watch(int state, int event)
{
    enum watch_phase phase = (enum watch_phase)state;
    watch_phase_on(&phase, (enum watch_event)event);
    return (int)phase;
}

static void test_the_name_of_an_agent(void)
{
    static const char *const rows[NAME_STATES] = {"A.|SU.", "..|FUU", "AR|SS.",
                                                  "AR|AN.", "AR|NN.", "AR|RR."};
    CU_ASSERT(NAME_OWN_EVENTS == 2 && NAME_EVENTS == 5);
    state_walk(apply_name, "UFSANR", rows);
}

static void test_how_an_agent_leaves(void)
{
    static const char *const rows[EXIT_STATES] = {"|WM.", "|.ML", "|MMD", "|.D.", "|.D."};
    CU_ASSERT_EQUAL(EXIT_EVENTS, 3);
    state_walk(apply_exit, "PWMDL", rows);
}

static void test_a_process_in_steps(void)
{
    static const char *const rows[PROCESS_STEPS] = {"GSFD|...F", "GSGD|R..F", "RSRD|.G.F",
                                                    "SSGD|..LF", "LLGD|...F", "....|...."};
    CU_ASSERT(STEP_OWN_EVENTS == 4 && STEP_EVENTS == 8);
    state_walk(apply_step, "FGRSLD", rows);
}

static void test_what_a_process_is_about_to_say(void)
{
    static const char *const rows[UP_STATES] = {"|AP.N", "|.P..", "|..NN"};
    CU_ASSERT_EQUAL(UP_EVENTS, 4);
    state_walk(apply_up, "NAP", rows);
}

static void test_a_run_that_is_watched(void)
{
    static const char *const rows[WATCH_PHASES] = {"MSAoA|.", "MSMO|.t", "SSSE|.t", "OSooo|.",
                                                   "OSOO|.t", "ESEE|.t", "TSAtt|.", "TSMTt|."};
    CU_ASSERT_EQUAL(WATCH_EVENTS, 6);
    state_walk(apply_watch, "AMSoOEtT", rows);
}

static void test_no_state_is_left_out_of_life(void)
{
    for (int state = 0; state < STATES; state++) {
        CU_ASSERT_STRING_NOT_EQUAL(mu_state_text((enum mu_state)state), "unknown");
    }
    CU_ASSERT_STRING_EQUAL(mu_state_text((enum mu_state)STATES), "unknown");
    CU_ASSERT_EQUAL(life_next((enum mu_state)99, LIFE_START), (enum mu_state)99);
}

static void test_directives_name_events(void)
{
    static const struct {
        const char *performative;
        enum life_event event;
    } names[] = {{"start", LIFE_START},
                 {"suspend", LIFE_SUSPEND},
                 {"resume", LIFE_RESUME},
                 {"dispose", LIFE_DISPOSE}};
    static const char *const others[] = {"",   "Start", "star", "starts", " start",
                                         "do", "step",  "tell", "run",    "start\n"};
    CU_ASSERT_EQUAL(LIFE_EVENTS, 4);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        enum life_event event = LIFE_EVENTS;
        CU_ASSERT_EQUAL(life_event_named(names[i].performative, &event), MU_OK);
        CU_ASSERT_EQUAL(event, names[i].event);
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        enum life_event event = LIFE_EVENTS;
        CU_ASSERT_EQUAL(life_event_named(others[i], &event), MU_ABSENT);
        CU_ASSERT_EQUAL(event, LIFE_EVENTS);
    }
}

/* The words that people and rules see. */
static void test_words(void)
{
    static const char *const kinds[] = {"agent", "robot", "host", "special"};
    static const char *const states[] = {"standby", "running", "suspended", "moving", "absent"};
    static const char *const outcomes[] = {"delivered", "stored",       "expired",
                                           "box-full",  "unknown-name", "duplicate",
                                           "refused",   "dropped",      "no-store"};
    for (int i = 0; i <= MU_KIND_SPECIAL; i++) {
        CU_ASSERT_STRING_EQUAL(mu_kind_text((enum mu_kind)i), kinds[i]);
    }
    for (int i = 0; i < STATES; i++) {
        CU_ASSERT_STRING_EQUAL(mu_state_text((enum mu_state)i), states[i]);
    }
    for (int i = 0; i <= MU_MAIL_NO_STORE; i++) {
        CU_ASSERT_STRING_EQUAL(mu_outcome_text((enum mu_outcome)i), outcomes[i]);
    }
    CU_ASSERT_STRING_EQUAL(mu_kind_text((enum mu_kind) - 1), "unknown");
    CU_ASSERT_STRING_EQUAL(mu_kind_text((enum mu_kind)4), "unknown");
    CU_ASSERT_STRING_EQUAL(mu_outcome_text((enum mu_outcome)9), "unknown");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"every event in every state", test_the_whole_state_machine},
        {"the name of an agent", test_the_name_of_an_agent},
        {"how an agent leaves", test_how_an_agent_leaves},
        {"a process in steps", test_a_process_in_steps},
        {"what a process is about to say", test_what_a_process_is_about_to_say},
        {"a run that is watched", test_a_run_that_is_watched},
        {"no state is left out", test_no_state_is_left_out_of_life},
        {"directives name events", test_directives_name_events},
        {"words for kinds, states, outcomes", test_words},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/life", tests);
}
