/* SPDX-License-Identifier: Apache-2.0 */
/* Agents that leave, and others that have their names or their places after them. */
#include "capture.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static mu_process process;
static mu_result joined;
static const char *next_name = "next";

/* Says good-bye, and another one takes over. */
static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    mu_agent *next;
    (void)self;
    (void)mail;
    struct mu_mail bye = {.dst = "blue", .content = "bye"};
    CU_ASSERT_EQUAL(mu_agent_send(a, &bye, NULL), MU_OK);
    mu_agent_set_state(a, MU_GONE);
    joined = mu_agent_join(a->process, &next, next_name, MU_KIND_AGENT, 0, NULL);
}

static const struct mu_handlers hears = {.on_mail = on_mail};

static struct mu_agent *begin(uint32_t agents)
{
    mu_agent *red = NULL;
    memset(&process, 0, sizeof process);
    process_take_memory(&process, agents, 0);
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &red, "red", MU_KIND_AGENT, 0, &hears), MU_OK);
    return red;
}

static muster_Delivery delivery(void)
{
    return (muster_Delivery){
        .process = words("p1"), .step = muster_STEP_NOW, .broker = words("main")};
}

static void accept_red(uint64_t last_seq)
{
    muster_Verdict v = {.agent = words("red"),
                        .accepted = true,
                        .last_seq = last_seq,
                        .broker_incarnation = 5,
                        .reason = words("")};
    muster_Delivery d = delivery();
    d.verdicts._buffer = &v;
    d.verdicts._length = 1;
    step_take_delivery(&process, &d, NULL);
}

static void take_mail(uint64_t number)
{
    muster_Parcel item = {
        .box = words("red"), .number = number, .letter = letter("blue", number, "red", "go")};
    muster_Delivery d = delivery();
    d.parcels._buffer = &item;
    d.parcels._length = 1;
    step_take_delivery(&process, &d, NULL);
}

/* What is said of an earlier one's mail is not said of what waits for the broker's yes. */
static void test_a_receipt_of_an_earlier_life(void)
{
    struct mu_agent *red = begin(0);
    muster_Mail mails[4];
    accept_red(0);
    for (int i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, "old"), MU_OK);
    }
    outbox_sent(&red->outbox, 3);
    mu_agent_set_state(red, MU_GONE);
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &red, "red", MU_KIND_AGENT, 0, &hears), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "new"), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "newer"), MU_OK);
    muster_Receipt r = {
        .agent = words("red"), .first_seq = 1, .last_seq = 3, .result = muster_OUTCOME_DELIVERED};
    muster_Delivery d = delivery();
    d.receipts._buffer = &r;
    d.receipts._length = 1;
    step_take_delivery(&process, &d, NULL);
    CU_ASSERT_TRUE(life_name_on(red, NAME_FREE));
    accept_red(3);
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&red->outbox, mails, 4), 2);
    CU_ASSERT_EQUAL(mails[0].seq, 4);
    CU_ASSERT_STRING_EQUAL(mails[0].content, "new");
}

static void test_last_words_go_out_before_the_place_is_given_away(void)
{
    (void)begin(1);
    accept_red(0);
    take_mail(1);
    CU_ASSERT_EQUAL(joined, MU_FULL);
    capture_begin();
    step_hello(&process);
    capture_end();
    CU_ASSERT_EQUAL_FATAL(process.out.acts._length, 1);
    CU_ASSERT_STRING_EQUAL(process.out.acts._buffer[0].mails._buffer[0].content, "bye");
    CU_ASSERT_EQUAL_FATAL(process.out.acks._length, 1);
    CU_ASSERT_EQUAL(process.out.acks._buffer[0].number, 1);
}

/* Who could not join has not taken the name from who is still to be heard. */
static void test_last_words_are_in_the_answer_to_a_step(void)
{
    (void)begin(1);
    accept_red(0);
    muster_Parcel item = {
        .box = words("red"), .number = 1, .letter = letter("blue", 1, "red", "go")};
    muster_Delivery d = delivery();
    d.step = 6;
    d.parcels._buffer = &item;
    d.parcels._length = 1;
    muster_Sense sense = {.process = words("p1"), .step = 7, .lockstep = true};
    next_name = "red";
    capture_begin();
    (void)process_step_on(&process, STEP_LOCKSTEP);
    step_live(&process, &sense, &d);
    capture_end();
    next_name = "next";
    CU_ASSERT_EQUAL(joined, MU_FULL);
    CU_ASSERT_EQUAL_FATAL(process.out.acts._length, 1);
    CU_ASSERT_EQUAL_FATAL(process.out.acts._buffer[0].mails._length, 1);
    CU_ASSERT_STRING_EQUAL(process.out.acts._buffer[0].mails._buffer[0].content, "bye");
}

/* What it took is another one's business, and nothing that it waits for. */
static void test_who_is_refused_owes_nothing(void)
{
    struct mu_agent *red = begin(0);
    red->name_state = NAME_ASKED;
    red->handlers.on_mail = NULL;
    accept_red(0);
    take_mail(1);
    CU_ASSERT_TRUE(queue_has(red, QUEUE_ACK));
    muster_Verdict v = {.agent = words("red"), .broker_incarnation = 5, .reason = words("taken")};
    muster_Delivery refusal = delivery();
    refusal.verdicts._buffer = &v;
    refusal.verdicts._length = 1;
    step_take_delivery(&process, &refusal, NULL);
    CU_ASSERT_FALSE(queue_has(red, QUEUE_ACK));
    take_mail(2); /* was under way to it */
    CU_ASSERT_FALSE(queue_has(red, QUEUE_ACK));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a receipt of an earlier life", test_a_receipt_of_an_earlier_life},
        {"last words", test_last_words_go_out_before_the_place_is_given_away},
        {"last words in a step", test_last_words_are_in_the_answer_to_a_step},
        {"refused", test_who_is_refused_owes_nothing},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/farewell", tests);
}
