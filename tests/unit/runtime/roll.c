/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What a process says of its agents, without a network: which parts are to be written, and when
 * all of them are.
 */
#include "capture.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

enum { AGENTS = 2 * MU_PART_AGENTS + 1 };

static mu_process process;
static const struct mu_handlers handlers;

static void set_up(void)
{
    memset(&process, 0, sizeof process);
    process_take_memory(&process, AGENTS, 2);
    for (int i = 0; i < AGENTS; i++) {
        mu_agent *a;
        char name[16];
        snprintf(name, sizeof name, "a%d", i);
        CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &a, name, MU_KIND_AGENT, 0, &handlers),
                              MU_OK);
    }
}

static void forget(void)
{
    memset(&process.roll, 0, sizeof process.roll); /* as if written */
}

static muster_Delivery delivery(muster_Verdict *verdict, bool roll_call)
{
    muster_Delivery d = {.process = words("p1"), .broker = words("main"), .roll_call = roll_call};
    d.verdicts._buffer = verdict;
    d.verdicts._length = verdict ? 1 : 0;
    return d;
}

static void accept(uint64_t broker_incarnation)
{
    muster_Verdict v = {.agent = words("a0"),
                        .accepted = true,
                        .broker_incarnation = broker_incarnation,
                        .reason = words("")};
    muster_Delivery d = delivery(&v, false);
    step_take_delivery(&process, &d, NULL);
}

static void test_a_change_marks_its_part(void)
{
    CU_ASSERT_EQUAL(process.roll.due_count, 3);
    forget();
    mu_agent_set_state(agent_find(&process, "a70"), MU_SUSPENDED);
    CU_ASSERT(process.roll.due_count == 1 && process.roll.due[1]);
    accept(5);
    CU_ASSERT_EQUAL(process.roll.due_count, 1);
}

static void test_a_roll_call_marks_all(void)
{
    forget();
    muster_Delivery d = delivery(NULL, true);
    step_take_delivery(&process, &d, NULL);
    CU_ASSERT(process.roll.due_count == 3 && process.roll.due[0] && process.roll.due[2]);
}

static void test_another_broker_hears_all_and_is_told_nothing_before_its_answer(void)
{
    accept(5);
    mu_agent *a0 = agent_find(&process, "a0");
    CU_ASSERT_EQUAL(mu_agent_broadcast(a0, "hello"), MU_OK);
    muster_Parcel item = {.box = words("a0"), .number = 1, .letter = letter("blue", 0, "", "")};
    muster_Delivery d = delivery(NULL, false);
    d.parcels._buffer = &item;
    d.parcels._length = 1;
    step_take_delivery(&process, &d, NULL);
    CU_ASSERT(queue_first(&process, QUEUE_SEND) == a0 && queue_first(&process, QUEUE_ACK) == a0);
    CU_ASSERT_EQUAL(process.ack_delay.items, 1);
    forget();
    link_register(&process);
    CU_ASSERT_EQUAL(process.roll.due_count, 3);
    CU_ASSERT_PTR_NULL(queue_first(&process, QUEUE_SEND));
    CU_ASSERT_PTR_NULL(queue_first(&process, QUEUE_ACK));
    CU_ASSERT_EQUAL(process.ack_delay.items, 0);
    accept(6);
    CU_ASSERT_PTR_EQUAL(queue_first(&process, QUEUE_SEND), a0);
    CU_ASSERT_PTR_NULL(queue_first(&process, QUEUE_ACK)); /* the box counts anew */
}

static uint32_t heard;

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    (void)a;
    (void)accepted;
    (void)reason;
    heard++;
}

static void refuse(const char *name, muster_Refusal code)
{
    muster_Verdict v = {
        .agent = words(name), .code = code, .broker_incarnation = 5, .reason = words("why")};
    muster_Delivery d = delivery(&v, false);
    (void)life_name_on(agent_find(&process, name), NAME_WRITTEN);
    step_take_delivery(&process, &d, NULL);
}

/* There is no network: the first part stays in hand. */
static void write_in_vain(void)
{
    capture_begin();
    roll_write(&process);
    capture_end();
}

/* Only a full broker may think better of it; the agent hears of the refusal once. */
static void test_a_full_broker_is_asked_again(void)
{
    mu_agent *a70 = agent_find(&process, "a70");
    a70->handlers.on_registered = on_registered;
    refuse("a70", muster_REFUSAL_NAME_HELD);
    forget();
    roll_refresh(&process);
    CU_ASSERT(process.roll.due_count == 1 && process.roll.due[0]);
    heard = 0;
    refuse("a70", muster_REFUSAL_FULL);
    CU_ASSERT_EQUAL(heard, 0);
    forget();
    roll_refresh(&process);
    CU_ASSERT(process.roll.due_count == 2 && process.roll.due[1]);
    process.link.broker[0] = 'm';
    forget();
    roll_mark(a70);
    write_in_vain();
    CU_ASSERT_NOT_EQUAL(process.roll.entries[70 % MU_PART_AGENTS].state, muster_STATE_ABSENT);
}

/* What it asked for before it heard may have been granted to it since. */
static void test_who_was_refused_says_that_it_is_not_there(void)
{
    process.link.broker[0] = 'm';
    muster_Verdict no = {.agent = words("a0"), .broker_incarnation = 5, .reason = words("held")};
    muster_Delivery d = delivery(&no, false);
    forget();
    agent_find(&process, "a0")->name_state = NAME_ASKED;
    step_take_delivery(&process, &d, NULL);
    CU_ASSERT(process.roll.due_count == 1 && process.roll.due[0]);
    write_in_vain();
    const muster_Entry *said = process.roll.entries;
    CU_ASSERT_STRING_EQUAL(said[0].name, "a0");
    CU_ASSERT_EQUAL(said[0].state, muster_STATE_ABSENT);
    CU_ASSERT_EQUAL(said[1].state, muster_STATE_RUNNING);
    CU_ASSERT(said[0].newcomer && said[1].newcomer);
    forget();
    accept(5); /* its holder has left, and nobody else was asked */
    CU_ASSERT(process.roll.due_count == 1 && process.roll.due[0]);
    write_in_vain();
    CU_ASSERT_EQUAL(said[0].state, muster_STATE_RUNNING);
    CU_ASSERT(!said[0].newcomer && said[1].newcomer);
}

static void test_nobody_is_told_before_a_broker_is_known(void)
{
    capture_begin();
    roll_write(&process); /* there is no network: writing would fail, and say so */
    capture_end();
    CU_ASSERT_STRING_EQUAL(captured, "");
    CU_ASSERT_EQUAL(process.roll.due_count, 3);
}

/* A refusal on its way may be that of an earlier one of the name, whose place somebody has taken;
 * who is gone hears of nothing. */
static void test_a_verdict_of_another_life(void)
{
    muster_Verdict no = {.agent = words("a0"), .broker_incarnation = 5, .reason = words("held")};
    muster_Delivery d = delivery(&no, false);
    struct mu_agent *a0 = agent_find(&process, "a0");
    a0->handlers.on_registered = on_registered;
    heard = 0;
    step_take_delivery(&process, &d, NULL);
    CU_ASSERT(a0->name_state == NAME_UNSAID && heard == 0);
    mu_agent_leave(a0);
    accept(5);
    CU_ASSERT_EQUAL(heard, 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a change marks its part", test_a_change_marks_its_part},
        {"a roll call marks all", test_a_roll_call_marks_all},
        {"a full broker is asked again", test_a_full_broker_is_asked_again},
        {"another broker hears all, and is told nothing before its answer",
         test_another_broker_hears_all_and_is_told_nothing_before_its_answer},
        {"a verdict of another life", test_a_verdict_of_another_life},
        {"who was refused says that it is not there",
         test_who_was_refused_says_that_it_is_not_there},
        {"nobody is told before a broker is known", test_nobody_is_told_before_a_broker_is_known},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/roll", NULL, NULL, set_up, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
