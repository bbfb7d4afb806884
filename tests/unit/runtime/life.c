/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/life.h"
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
        {"no state is left out", test_no_state_is_left_out_of_life},
        {"directives name events", test_directives_name_events},
        {"words for kinds, states, outcomes", test_words},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/life", tests);
}
