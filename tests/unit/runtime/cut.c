/* SPDX-License-Identifier: Apache-2.0 */
/* An agent that the network had lost for a while, and that is accepted again. */
#include "capture.h"
#include "core/text.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static mu_process process;
static char heard_buffer[1024];
static struct mu_text heard;
static uint64_t last_wish; /* the number of the mail with which it leaves; 0: none */
static uint64_t disposal;  /* the number of a directive that disposes of it; 0: none */

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    if (mail->number == last_wish) {
        mu_agent_set_state(a, MU_GONE);
    }
    mu_text_format(&heard, "%s#%llu; ", a->name, (unsigned long long)mail->number);
}

static const struct mu_handlers hears = {.on_mail = on_mail};

static struct mu_agent *join(const char *name)
{
    mu_agent *a = NULL;
    memset(&process, 0, sizeof process);
    process_take_memory(&process, 0, 0);
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    capture_begin();
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &a, name, MU_KIND_AGENT, 0, &hears), MU_OK);
    capture_end();
    return a;
}

/* A Delivery with a verdict, or NULL, and the mails of these numbers for red. */
static void deliver(muster_Verdict *v, const uint64_t *numbers, uint32_t count)
{
    muster_Parcel parcels[4];
    muster_Delivery d = {.process = words("p1"), .step = muster_STEP_NOW, .broker = words("b")};
    for (uint32_t i = 0; i < count; i++) {
        parcels[i] = (muster_Parcel){.box = words("red"), .number = numbers[i]};
        parcels[i].letter = letter("blue", numbers[i], "red", "x");
        if (numbers[i] == disposal) {
            parcels[i].letter.layer = WIRE_DIRECTIVE;
            parcels[i].letter.performative = words("dispose");
        }
    }
    d.verdicts._buffer = v;
    d.verdicts._length = v ? 1 : 0;
    d.parcels._buffer = parcels;
    d.parcels._length = count;
    mu_text_clear(&heard);
    step_take_delivery(&process, &d, NULL);
}

/* This life of a broker accepts red and hands it the mails of these numbers. */
static void accept_at(uint64_t incarnation, uint64_t last_seq, const uint64_t *numbers,
                      uint32_t count)
{
    muster_Verdict v = {.agent = words("red"),
                        .accepted = true,
                        .last_seq = last_seq,
                        .broker_incarnation = incarnation,
                        .reason = words("")};
    deliver(&v, numbers, count);
}

static void accept(uint64_t last_seq, const uint64_t *numbers, uint32_t count)
{
    accept_at(5, last_seq, numbers, count);
}

/* Another one has had its name meanwhile, and some of its mail. */
static void test_numbers_go_on_where_another_one_left_off(void)
{
    (void)join("red");
    accept(0, (const uint64_t[]){1, 2, 3}, 3);
    CU_ASSERT_STRING_EQUAL(heard.at, "red#1; red#2; red#3; ");
    accept(0, (const uint64_t[]){7, 9}, 2);
    CU_ASSERT_STRING_EQUAL(heard.at, "red#7; ");
}

static void test_what_has_no_answer_goes_out_again(void)
{
    struct mu_agent *red = join("red");
    muster_Mail mails[4];
    accept(0, NULL, 0);
    for (int i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, "hello"), MU_OK);
    }
    outbox_sent(&red->outbox, 2);
    accept(20, NULL, 0); /* they may have come, and keep their numbers */
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&red->outbox, mails, 4), 3);
    CU_ASSERT(mails[0].seq == 1 && mails[0].again);
    CU_ASSERT(mails[1].seq == 2 && mails[1].again);
    CU_ASSERT(mails[2].seq == 3 && !mails[2].again);
}

/* What it owed an acknowledgement for comes again, and is known however much came in between. */
static void test_going_back_to_a_broker(void)
{
    struct mu_agent *red = join("red");
    accept(0, (const uint64_t[]){1, 2, 3}, 3);
    for (uint64_t number = 1001; number <= 1001 + 2 * DEDUP_MAX; number++) {
        accept_at(6, 0, &number, 1);
    }
    accept(0, (const uint64_t[]){2, 3, 4}, 3);
    CU_ASSERT_STRING_EQUAL(heard.at, "red#4; ");
    capture_begin();
    step_hello(&process);
    capture_end();
    CU_ASSERT_EQUAL_FATAL(process.out.acks._length, 1);
    CU_ASSERT_EQUAL(process.out.acks._buffer[0].number, 4);
    CU_ASSERT_EQUAL(red->handed, 4 + 2 * DEDUP_MAX + 1);
    accept_at(7, 0, (const uint64_t[]){2}, 1); /* a later life counts for itself */
    CU_ASSERT_STRING_EQUAL(heard.at, "red#2; ");
}

static void expect_ack(uint64_t incarnation, uint64_t number)
{
    process.up_state = UP_NONE; /* as if what was said before had gone out */
    capture_begin();
    step_hello(&process);
    capture_end();
    CU_ASSERT_EQUAL(process.out.broker_incarnation, incarnation);
    CU_ASSERT_EQUAL_FATAL(process.out.acks._length, number > 0);
    if (number > 0) {
        CU_ASSERT_EQUAL(process.out.acks._buffer[0].number, number);
    }
}

/* Its number alone may be that of another mail in another life's box. */
static void test_an_acknowledgement_says_to_which_life(void)
{
    (void)join("red");
    accept_at(5, 0, (const uint64_t[]){1, 2}, 2);
    expect_ack(5, 2);
    accept_at(6, 0, NULL, 0);
    expect_ack(6, 0);
    deliver(NULL, (const uint64_t[]){1}, 1);
    expect_ack(6, 1);
    accept_at(5, 0, NULL, 0); /* where it had two, and comes back */
    deliver(NULL, (const uint64_t[]){2}, 1);
    expect_ack(5, 2);
}

/* What the network has not taken yet is the next that goes out, and is marked for it. */
static void test_what_is_pending_does_not_move(void)
{
    struct mu_agent *red = join("red");
    muster_Mail mails[4];
    accept(0, NULL, 0);
    for (int i = 0; i < 4; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, "hello"), MU_OK);
    }
    outbox_sent(&red->outbox, 2);
    agent_progress(red);
    red->progress_ns = 1; /* long ago */
    capture_begin();
    step_hello(&process); /* there is no network: the third and the fourth are pending */
    step_flush(&process);
    capture_end();
    CU_ASSERT_EQUAL(process.up_state, UP_PENDING);
    CU_ASSERT_EQUAL_FATAL(outbox_unsent(&red->outbox, mails, 4), 2);
    CU_ASSERT(mails[0].seq == 3 && !mails[0].again);
}

static void expect_taken(const struct mu_agent *a, uint64_t number)
{
    CU_ASSERT_EQUAL(a->handed, number);
    CU_ASSERT_EQUAL(mu_agent_passage(a).last_number, number);
    capture_begin();
    step_hello(&process);
    capture_end();
    CU_ASSERT_EQUAL_FATAL(process.out.acks._length, number > 0);
    if (number > 0) {
        CU_ASSERT_EQUAL(process.out.acks._buffer[0].number, number);
    }
}

/* It has not taken what lies behind the mail with which it leaves. */
static void test_who_leaves_gives_the_rest_back(void)
{
    struct mu_agent *red = join("red");
    last_wish = 2;
    accept(0, (const uint64_t[]){1, 2, 3, 4}, 4);
    last_wish = 0;
    CU_ASSERT_STRING_EQUAL(heard.at, "red#1; red#2; ");
    expect_taken(red, 2);
}

/* What came while nobody bore the name is gone: what was sent behind it must not be taken either.
 */
static void test_a_new_life_takes_nothing_before_its_verdict(void)
{
    struct mu_agent *red = join("red");
    accept(0, (const uint64_t[]){1}, 1);
    mu_agent_leave(red);
    deliver(NULL, (const uint64_t[]){2}, 1);
    capture_begin();
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &red, "red", MU_KIND_AGENT, 0, &hears), MU_OK);
    capture_end();
    deliver(NULL, (const uint64_t[]){3}, 1);
    accept(0, NULL, 0); /* of the one that leaves */
    CU_ASSERT_STRING_EQUAL(heard.at, "");
    CU_ASSERT_TRUE(life_name_on(red, NAME_FREE));
    accept(0, (const uint64_t[]){2, 3}, 2);
    CU_ASSERT_STRING_EQUAL(heard.at, "red#2; red#3; ");
}

/* Else its next life would be disposed of, too. */
static void test_what_a_directive_has_overtaken_is_taken(void)
{
    struct mu_agent *red = join("red");
    disposal = 2;
    accept(0, (const uint64_t[]){1, 2}, 2);
    CU_ASSERT_STRING_EQUAL(heard.at, "");
    expect_taken(red, 2);
    red = join("red");
    disposal = 1;
    accept(0, (const uint64_t[]){1, 2, 3}, 3);
    disposal = 0;
    CU_ASSERT_STRING_EQUAL(heard.at, "");
    expect_taken(red, 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"numbers go on", test_numbers_go_on_where_another_one_left_off},
        {"what has no answer", test_what_has_no_answer_goes_out_again},
        {"going back to a broker", test_going_back_to_a_broker},
        {"an acknowledgement says to which life", test_an_acknowledgement_says_to_which_life},
        {"what is pending does not move", test_what_is_pending_does_not_move},
        {"who leaves gives the rest back", test_who_leaves_gives_the_rest_back},
        {"a new life and its verdict", test_a_new_life_takes_nothing_before_its_verdict},
        {"what a directive has overtaken is taken", test_what_a_directive_has_overtaken_is_taken},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/cut", tests);
}
