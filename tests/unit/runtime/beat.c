/* SPDX-License-Identifier: Apache-2.0 */
/* Robots that the world has no body for live through the steps of their process, too. */
#include "capture.h"
#include "core/text.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static mu_process process;
static muster_Percept percepts[1];
static muster_Sense sense;
static char heard_buffer[256];
static struct mu_text heard;

static void on_step(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    mu_text_format(&heard, "%s sees %g; ", a->name, percept->x_m);
}

static void on_beat(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    mu_text_format(&heard, "%s beat %lld; ", a->name, (long long)percept->step);
}

static void on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)percept;
    (void)self;
    mu_text_format(&heard, "%s acts; ", a->name);
}

static struct mu_agent *join(const char *name, enum mu_kind kind)
{
    static const struct mu_handlers handlers = {
        .on_step = on_step, .on_beat = on_beat, .on_act = on_act};
    mu_agent *a = NULL;
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &a, name, kind, 0, &handlers), MU_OK);
    a->name_state = NAME_ACCEPTED;
    a->state = MU_RUNNING;
    return a;
}

static void set_up(void)
{
    memset(&process, 0, sizeof process);
    process.role = PROCESS_BODY;
    process_take_memory(&process, 3, 0);
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    percepts[0] = (muster_Percept){.robot = words("red"), .x_m = 1.5};
    sense = (muster_Sense){.process = words("p1"), .step = 7};
    sense.robots._buffer = percepts;
    sense.robots._length = 1;
}

static const muster_Up *live(void)
{
    static const muster_Delivery nothing;
    capture_begin();
    (void)process_step_on(&process, STEP_LOCKSTEP);
    step_live(&process, &sense, &nothing);
    capture_end();
    process.up_state = UP_NONE;
    return &process.out;
}

static void expect(const char *want)
{
    (void)live();
    CU_ASSERT_STRING_EQUAL(heard.at, want);
    mu_text_clear(&heard);
}

static void test_who_has_no_body_has_a_beat(void)
{
    struct mu_agent *ruby = join("ruby", MU_KIND_ROBOT);
    join("red", MU_KIND_ROBOT);
    join("north", MU_KIND_HOST);
    expect("red sees 1.5; ruby beat 7; red acts; ruby acts; ");
    ruby->state = MU_STANDBY;
    expect("red sees 1.5; ruby beat 7; red acts; ");
    sense.robots._length = 0; /* red has lost its body */
    expect("ruby beat 7; red beat 7; red acts; ");
    ruby->name_state = NAME_ASKED; /* it has not got its name */
    expect("red beat 7; red acts; ");
    mu_agent_set_state(ruby, MU_GONE);
    expect("red beat 7; red acts; ");
}

static void test_an_agent_that_is_no_robot_has_a_beat(void)
{
    join("boss", MU_KIND_AGENT);
    join("observer", MU_KIND_SPECIAL);
    sense.robots._length = 0;
    expect("boss beat 7; boss acts; ");
}

/* The one that comes answers for a name, not the one that had it. */
static void test_a_name_answers_once(void)
{
    struct mu_agent *first = join("ruby", MU_KIND_ROBOT);
    mu_agent_set_state(first, MU_GONE);
    CU_ASSERT_EQUAL(live()->acts._length, 1);
    CU_ASSERT_EQUAL(live()->acts._buffer[0].state, muster_STATE_ABSENT);
    join("ruby", MU_KIND_ROBOT);
    const muster_Up *up = live();
    CU_ASSERT_EQUAL_FATAL(up->acts._length, 1);
    CU_ASSERT_EQUAL(up->acts._buffer[0].state, muster_STATE_RUNNING);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"who has no body has a beat", test_who_has_no_body_has_a_beat},
        {"an agent that is no robot has a beat", test_an_agent_that_is_no_robot_has_a_beat},
        {"a name answers once", test_a_name_answers_once},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/beat", NULL, NULL, set_up, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
