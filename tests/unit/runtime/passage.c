/* SPDX-License-Identifier: Apache-2.0 */
/*
 * An agent that goes from one process to another, as both have it in memory, without a network: how
 * far it had come, when it may go, and what it leaves; and what it says of itself meanwhile.
 */
#include "capture.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

enum { BROKER = 5 };

static mu_process here, there;
static mu_agent *red;
static unsigned mails, creations, arrivals, disposals;

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    (void)mail;
    mails++;
}

static void on_dispose(void *self, mu_agent *a)
{
    (void)self;
    (void)a;
    disposals++;
}

static void on_create(void *self, mu_agent *a)
{
    (void)self;
    (void)a;
    creations++;
}

static void on_arrive(void *self, mu_agent *a)
{
    (void)self;
    (void)a;
    arrivals++;
}

static const struct mu_handlers handlers = {.on_mail = on_mail};
static const struct mu_agent_kind kind = {
    .name = "traveller",
    .hooks = {
        [MU_ON_CREATE] = on_create, [MU_ON_ARRIVE] = on_arrive, [MU_ON_DISPOSE] = on_dispose}};

static void process_begin(mu_process *p, const char *name)
{
    memset(p, 0, sizeof *p);
    p->role = PROCESS_BODY;
    process_take_memory(p, 2, 8);
    mu_text_copy(p->name, sizeof p->name, name);
}

static void accept(mu_process *p, uint64_t incarnation)
{
    muster_Verdict v = {.agent = words("red"),
                        .accepted = true,
                        .broker_incarnation = incarnation,
                        .reason = words("")};
    muster_Delivery d = {.process = words("p"), .broker = words("main"), .step = muster_STEP_NOW};
    d.verdicts._buffer = &v;
    d.verdicts._length = 1;
    step_take_delivery(p, &d, NULL);
}

static void item_take(mu_process *p, uint64_t number)
{
    muster_Parcel item = {
        .box = words("red"), .number = number, .letter = letter("blue", number, "red", "hello")};
    muster_Delivery d = {.process = words("p"), .broker = words("main"), .step = muster_STEP_NOW};
    d.parcels._buffer = &item;
    d.parcels._length = 1;
    step_take_delivery(p, &d, NULL);
}

static void receipt_take(uint64_t seq)
{
    muster_Receipt r = {.agent = words("red"),
                        .first_seq = seq,
                        .last_seq = seq,
                        .result = muster_OUTCOME_DELIVERED};
    muster_Delivery d = {.process = words("p"), .broker = words("main"), .step = muster_STEP_NOW};
    d.receipts._buffer = &r;
    d.receipts._length = 1;
    step_take_delivery(&here, &d, NULL);
}

static void set_up(void)
{
    mails = creations = arrivals = disposals = 0;
    process_begin(&here, "p-here");
    process_begin(&there, "p-there");
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&here, &red, "red", MU_KIND_ROBOT, 0, &handlers), MU_OK);
    mu_agent_be(red, &kind);
    accept(&here, BROKER);
    mu_agent_set_state(red, MU_RUNNING);
}

static void test_it_goes_on_where_it_was(void)
{
    mu_agent *moved = NULL;
    set_up();
    for (uint64_t number = 1; number <= 3; number++) {
        item_take(&here, number);
    }
    memset(&here.roll, 0, sizeof here.roll);
    mu_agent_set_out(red);
    CU_ASSERT_EQUAL(here.roll.due_count, 1); /* the white pages are to know */
    struct mu_passage passage = mu_agent_passage(red);
    CU_ASSERT_EQUAL(passage.last_number, 3);
    CU_ASSERT_EQUAL(passage.handed, 3);
    CU_ASSERT_EQUAL(passage.broker, BROKER);
    CU_ASSERT_EQUAL(passage.epoch, 1);

    CU_ASSERT_EQUAL(mu_agent_arrive(&there, &moved, "no name", &passage, MU_ON_ARRIVE, &handlers),
                    MU_MALFORMED);
    CU_ASSERT_EQUAL_FATAL(mu_agent_arrive(&there, &moved, "red", &passage, MU_ON_ARRIVE, &handlers),
                          MU_OK);
    CU_ASSERT_EQUAL(mu_agent_arrive(&there, &moved, "red", &passage, MU_ON_ARRIVE, &handlers),
                    MU_EXISTS);
    mu_agent_be(moved, &kind);
    CU_ASSERT_EQUAL(mu_agent_state(moved), MU_MOVING);
    item_take(&there, 4); /* before it lives: it comes again */
    CU_ASSERT_EQUAL(mails, 3);
    CU_ASSERT_EQUAL(arrivals, 0);
    accept(&there, BROKER);
    CU_ASSERT_EQUAL(arrivals, 1);
    CU_ASSERT_EQUAL(creations, 1); /* here, once */
    mu_agent_set_state(moved, MU_RUNNING);
    item_take(&there, 3); /* had by its earlier life */
    CU_ASSERT_EQUAL(mails, 3);
    item_take(&there, 4);
    CU_ASSERT_EQUAL(mails, 4);
    passage = mu_agent_passage(moved);
    CU_ASSERT_EQUAL(passage.last_number, 4);
    CU_ASSERT_EQUAL(passage.handed, 4);
    CU_ASSERT_EQUAL(passage.epoch, 1);
}

/* The numbers of another broker's boxes are others. */
static void test_it_meets_another_broker(void)
{
    mu_agent *moved = NULL;
    set_up();
    item_take(&here, 1);
    struct mu_passage passage = mu_agent_passage(red);
    CU_ASSERT_EQUAL_FATAL(mu_agent_arrive(&there, &moved, "red", &passage, MU_ON_ARRIVE, &handlers),
                          MU_OK);
    accept(&there, BROKER + 1);
    mu_agent_set_state(moved, MU_RUNNING);
    item_take(&there, 1);
    CU_ASSERT_EQUAL(mails, 2);
}

static void test_when_it_is_settled(void)
{
    uint64_t seq = 0;
    set_up();
    CU_ASSERT_TRUE(mu_agent_is_settled(red));
    CU_ASSERT_EQUAL(mu_agent_send(red, &(struct mu_mail){.dst = "blue", .content = "x"}, &seq),
                    MU_OK);
    CU_ASSERT_FALSE(mu_agent_is_settled(red)); /* not out */
    outbox_sent(&red->outbox, 1);
    CU_ASSERT_FALSE(mu_agent_is_settled(red)); /* not answered for */
    receipt_take(seq);
    CU_ASSERT_TRUE(mu_agent_is_settled(red));
    item_take(&here, 1);
    CU_ASSERT_FALSE(mu_agent_is_settled(red)); /* not acknowledged */
    red->acked_number = red->last_number;
    queue_remove(red, QUEUE_ACK);
    here.up_state = UP_PENDING;
    CU_ASSERT_FALSE(mu_agent_is_settled(red)); /* the network has not taken the last Up */
    here.up_state = UP_NONE;
    CU_ASSERT_TRUE(mu_agent_is_settled(red));
    red->name_state = NAME_ASKED;
    CU_ASSERT_FALSE(mu_agent_is_settled(red));
}

static void test_who_leaves_is_not_disposed_of(void)
{
    mu_agent *again = NULL;
    set_up();
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "bye"), MU_OK);
    item_take(&here, 1);
    mu_agent_leave(red);
    CU_ASSERT_EQUAL(mu_agent_state(red), MU_GONE);
    CU_ASSERT_EQUAL(disposals, 0);
    CU_ASSERT_PTR_NULL(queue_first(&here, QUEUE_SEND)); /* its next life says it */
    CU_ASSERT_PTR_NULL(queue_first(&here, QUEUE_ACK));
    CU_ASSERT_EQUAL(mu_agent_join(&here, &again, "red", MU_KIND_ROBOT, 0, &handlers), MU_OK);
    mu_agent_be(again, &kind);
    CU_ASSERT_TRUE(life_name_on(again, NAME_FREE));
    accept(&here, BROKER);
    mu_agent_set_state(again, MU_GONE);
    CU_ASSERT_EQUAL(disposals, 1);
}

/* The act of an agent in the answer to a step; the network, which is not there, says so. */
static const muster_Act *act_of_step(void)
{
    muster_Sense sense = {.process = words("p-here"), .step = 3};
    capture_begin();
    step_live_freely(&here, &sense);
    capture_end();
    here.up_state = UP_NONE;
    CU_ASSERT_EQUAL_FATAL(here.out.acts._length, 1);
    return &here.out.acts._buffer[0];
}

static void test_what_it_says_of_a_step(void)
{
    static char long_goal[2 * MU_FIELD_MAX];
    set_up();
    mu_agent_fired_also(red, 0, "");
    mu_agent_fired_also(red, 1, "wander");
    mu_agent_fired_also(red, 2, "avoid avoid");
    mu_agent_want(red, "gohome 3000.0 0.0");
    const muster_Act *act = act_of_step();
    CU_ASSERT_EQUAL(act->firings, 3);
    CU_ASSERT_STRING_EQUAL(act->rules, "wander avoid avoid");
    CU_ASSERT_STRING_EQUAL(act->goal, "gohome 3000.0 0.0");
    mu_agent_fired(red, 1, "stop"); /* instead of all that */
    memset(long_goal, 'g', sizeof long_goal - 1);
    mu_agent_want(red, long_goal);
    act = act_of_step();
    CU_ASSERT_STRING_EQUAL(act->rules, "stop");
    CU_ASSERT_EQUAL(strlen(act->goal), MU_FIELD_MAX);
}

static void test_who_suspends_itself_says_why(void)
{
    set_up();
    CU_ASSERT_EQUAL(mu_agent_drive(red, 0.5, 0), MU_OK);
    mu_agent_suspend(red, "no memory");
    CU_ASSERT_EQUAL(mu_agent_state(red), MU_SUSPENDED);
    CU_ASSERT_STRING_EQUAL(red->reason, "no memory");
    CU_ASSERT_EQUAL(act_of_step()->forward_m_s, 0); /* it stands still */
    mu_agent_suspend(red, "once more");
    CU_ASSERT_STRING_EQUAL(red->reason, "no memory");
    mu_agent_set_state(red, MU_RUNNING);
    CU_ASSERT_STRING_EQUAL(red->reason, "");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"it goes on where it was", test_it_goes_on_where_it_was},
        {"it meets another broker", test_it_meets_another_broker},
        {"when it is settled", test_when_it_is_settled},
        {"who leaves is not disposed of", test_who_leaves_is_not_disposed_of},
        {"what it says of a step", test_what_it_says_of_a_step},
        {"who suspends itself says why", test_who_suspends_itself_says_why},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/passage", tests);
}
