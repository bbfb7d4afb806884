/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What a process makes of deliveries and steps, without a network: the process is put together in
 * memory, its writers are not open, and what handlers hear is one line of text.
 */
#include "capture.h"
#include "core/text.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <string.h>

enum { PARCELS_MAX = PROCESS_ITEMS + 1 };

static mu_process process;
static muster_Parcel parcels[PARCELS_MAX];
static muster_Percept percepts[2];
static float sonar_m[2] = {0.5f, 4.0f};
static muster_Sense sense;
static muster_Delivery delivery;
static char heard_buffer[1024];
static struct mu_text heard;

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    mu_text_format(&heard, "%s %s%s; ", a->name, accepted ? "welcome" : "no: ", reason);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    mu_text_format(&heard, "%s#%llu %s; ", a->name, (unsigned long long)mail->number,
                   mail->content);
}

static void on_directive(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    mu_text_format(&heard, "%s %s %s; ", a->name, mail->performative, mail->content);
}

static void on_state(void *self, mu_agent *a, enum mu_state state)
{
    (void)self;
    mu_text_format(&heard, "%s is %s; ", a->name, mu_state_text(state));
}

static void on_step(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    mu_text_format(&heard, "%s sees %g; ", a->name, percept->x_m);
}

static void on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    mu_text_format(&heard, "%s acts %g; ", a->name, percept->x_m);
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)self;
    mu_text_format(&heard, "%s %llu-%llu %s; ", a->name, (unsigned long long)first_seq,
                   (unsigned long long)last_seq, mu_outcome_text(outcome));
}

static const struct mu_handlers handlers = {.on_registered = on_registered,
                                            .on_mail = on_mail,
                                            .on_directive = on_directive,
                                            .on_state = on_state,
                                            .on_step = on_step,
                                            .on_act = on_act,
                                            .on_receipt = on_receipt};

/* Registering finds no network, and says so. */
static struct mu_agent *join(const char *name, enum mu_kind kind, uint64_t last_number)
{
    mu_agent *a = NULL;
    capture_begin();
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &a, name, kind, last_number, &handlers), MU_OK);
    capture_end();
    return a;
}

static void set_up(void)
{
    memset(&process, 0, sizeof process);
    memset(&delivery, 0, sizeof delivery);
    memset(&sense, 0, sizeof sense);
    process.role = PROCESS_BODY;
    process_take_memory(&process, 0, 0);
    mu_text_copy(process.name, sizeof process.name, "p1");
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    delivery.process = sense.process = words("p1");
    delivery.parcels._buffer = parcels;
    percepts[0] = (muster_Percept){.robot = words("red"), .x_m = 1.5};
    percepts[0].sonar_m._buffer = sonar_m;
    percepts[0].sonar_m._length = 2;
    percepts[1] = (muster_Percept){.robot = words("stranger"), .x_m = 9.0};
    sense.robots._buffer = percepts;
    sense.robots._length = 2;
    sense.step = 7;
}

/* A mail, or a directive, for somebody whom the broker has accepted. */
static void item(const char *box, uint64_t number, const char *performative, const char *content)
{
    struct mu_agent *a = agent_find(&process, box);
    if (a) {
        a->name_state = NAME_ACCEPTED;
    }
    muster_Mail mail = letter("blue", number, box, content);
    mail.layer = performative[0] ? WIRE_DIRECTIVE : MU_LAYER_SPEECH;
    mail.performative = words(performative);
    parcels[delivery.parcels._length++] =
        (muster_Parcel){.box = words(box), .number = number, .letter = mail};
}

static void deliver_with(const muster_Sense *with)
{
    capture_begin(); /* a change of state registers again */
    step_take_delivery(&process, &delivery, with);
    capture_end();
    delivery.parcels._length = 0;
    delivery.receipts._length = 0;
    delivery.verdicts._length = 0;
    delivery.members._length = 0;
}

static void expect(const char *want)
{
    deliver_with(NULL);
    CU_ASSERT_STRING_EQUAL(heard.at, want);
    mu_text_clear(&heard);
}

static void expect_numbers(uint64_t first, uint64_t last, const char *want)
{
    for (uint64_t number = first; number <= last; number++) {
        item("red", number, "", "x");
    }
    expect(want);
}

/* Lets the agents act and puts an answer together, which stays pending for want of a network. */
static const muster_Up *answer(const muster_Delivery *d)
{
    capture_begin();
    static const muster_Delivery nothing; /* of a step without mail */
    (void)process_step_on(&process, STEP_LOCKSTEP);
    step_live(&process, &sense, d ? d : &nothing);
    capture_end();
    CU_ASSERT_EQUAL(process.up_state, UP_PENDING);
    CU_ASSERT_EQUAL_FATAL(process.out.acts._length, process.agent_count);
    process.up_state = UP_NONE;
    return &process.out;
}

static void test_numbers_in_order(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    expect_numbers(1, 3, "red#1 x; red#2 x; red#3 x; ");
    expect_numbers(4, 4, "red#4 x; ");
    CU_ASSERT_EQUAL(red->last_number, 4);
    CU_ASSERT_EQUAL(red->handed, 4);
}

static void test_duplicates_are_dropped_and_acknowledged_again(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    expect_numbers(1, 3, "red#1 x; red#2 x; red#3 x; ");
    red->name_state = NAME_ASKED;
    CU_ASSERT_EQUAL(answer(NULL)->acks._length, 0); /* not to a broker that has not said yes */
    red->name_state = NAME_ACCEPTED;
    const muster_Up *up = answer(NULL);
    CU_ASSERT_EQUAL_FATAL(up->acks._length, 1);
    CU_ASSERT_STRING_EQUAL(up->acks._buffer[0].box, "red");
    CU_ASSERT_EQUAL(up->acks._buffer[0].number, 3);
    CU_ASSERT_EQUAL(up->acks._buffer[0].handed, 3);
    red->acked_number = 3; /* as if it had gone out */
    CU_ASSERT_EQUAL(answer(NULL)->acks._length, 0);

    mu_text_clear(&heard);
    expect_numbers(2, 3, "");
    up = answer(NULL);
    CU_ASSERT_EQUAL_FATAL(up->acks._length, 1);
    CU_ASSERT_EQUAL(up->acks._buffer[0].number, 3);
    CU_ASSERT_EQUAL(up->acks._buffer[0].handed, 3);
    mu_text_clear(&heard);
    expect_numbers(2, 5, "red#4 x; red#5 x; ");
    CU_ASSERT_EQUAL(red->handed, 5);
}

static void test_a_gap_is_not_taken(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    expect_numbers(1, 1, "red#1 x; ");
    expect_numbers(3, 4, "");
    CU_ASSERT_EQUAL(red->last_number, 1);
    expect_numbers(2, 4, "red#2 x; red#3 x; red#4 x; ");
    item("red", 5, "", "five");
    item("red", 7, "", "seven");
    item("red", 6, "", "six");
    item("red", 7, "", "seven");
    expect("red#5 five; red#6 six; red#7 seven; ");
}

static void test_a_new_life_begins_anywhere(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    expect_numbers(17, 18, "red#17 x; red#18 x; ");
    expect_numbers(20, 20, "");
    CU_ASSERT_EQUAL(red->last_number, 18);
    CU_ASSERT_EQUAL(red->handed, 2);
}

static void test_an_agent_that_keeps_a_record_goes_on(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 20);
    CU_ASSERT_EQUAL(answer(NULL)->acks._length, 0);
    mu_text_clear(&heard);
    expect_numbers(19, 22, "red#21 x; red#22 x; ");
    CU_ASSERT_EQUAL(red->last_number, 22);
    CU_ASSERT_EQUAL(red->handed, 2);
}

static void test_boxes_are_counted_apart(void)
{
    join("red", MU_KIND_AGENT, 0)->name_state = NAME_ACCEPTED;
    join("blue", MU_KIND_AGENT, 0)->name_state = NAME_ACCEPTED;
    item("red", 1, "", "a");
    item("blue", 1, "", "b");
    item("stranger", 1, "", "c");
    item("blue", 2, "", "d");
    item("red", 2, "", "e");
    expect("red#1 a; blue#1 b; blue#2 d; red#2 e; ");
    CU_ASSERT_EQUAL(answer(NULL)->acks._length, 2);
}

static void test_who_has_left_takes_nothing(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    item("red", 1, "dispose", "");
    expect("red is absent; ");
    CU_ASSERT_EQUAL(mu_agent_state(red), MU_GONE);
    expect_numbers(2, 3, "");
    CU_ASSERT_EQUAL(red->last_number, 1);
}

static void test_directives_before_percepts_before_mail(void)
{
    join("red", MU_KIND_ROBOT, 0);
    item("red", 1, "", "one");
    item("red", 2, "start", "");
    item("red", 3, "", "three");
    item("red", 4, "do", "(wander)");
    deliver_with(&sense);
    CU_ASSERT_STRING_EQUAL(heard.at, "red is running; red do (wander); red sees 1.5; "
                                     "red#1 one; red#3 three; ");
}

static void test_directives_of_life_are_the_runtimes(void)
{
    struct mu_agent *red = join("red", MU_KIND_ROBOT, 0);
    CU_ASSERT_EQUAL(mu_agent_state(red), MU_STANDBY);
    static const struct {
        const char *directive, *want;
    } story[] = {
        {"suspend", ""},
        {"resume", ""},
        {"start", "red is running; "},
        {"start", ""},
        {"suspend", "red is suspended; "},
        {"start", ""},
        {"step", "red step 5; "},
        {"resume", "red is running; "},
        {"resume", "red is running; "}, /* after a step it is told not to stop */
    };
    for (uint64_t i = 0; i < sizeof story / sizeof story[0]; i++) {
        item("red", i + 1, story[i].directive, "5");
        expect(story[i].want);
    }
    CU_ASSERT_EQUAL(red->handed, 9);
}

/* Nobody who asks for an answer waits for an agent that has no handler. */
static void test_a_directive_without_a_handler(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    red->handlers.on_directive = NULL;
    red->name_state = NAME_ACCEPTED;
    item("red", 1, "do", "(wander)");
    expect("");
    CU_ASSERT_EQUAL(answer(NULL)->acts._buffer[0].mails._length, 0);
    mu_text_clear(&heard);
    item("red", 2, "do", "(wander)");
    parcels[0].letter.reply_with = words("r7");
    parcels[0].letter.conversation = words("c7");
    expect("");
    const muster_Act *act = answer(NULL)->acts._buffer;
    CU_ASSERT_EQUAL_FATAL(act->mails._length, 1);
    const muster_Mail *mail = act->mails._buffer;
    CU_ASSERT_STRING_EQUAL(mail->dst, "blue");
    CU_ASSERT_STRING_EQUAL(mail->performative, "not-understood");
    CU_ASSERT_STRING_EQUAL(mail->in_reply_to, "r7");
    CU_ASSERT_STRING_EQUAL(mail->conversation, "c7");
    CU_ASSERT_STRING_EQUAL(mail->content, "do");
    CU_ASSERT_EQUAL(mail->layer, MU_LAYER_SPEECH);
}

static void receipts(muster_Receipt *buffer, uint32_t count)
{
    delivery.receipts._buffer = buffer;
    delivery.receipts._length = count;
}

static void test_receipts_confirm(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    uint64_t seq = 0;
    for (uint64_t i = 1; i <= 5; i++) {
        CU_ASSERT_EQUAL(mu_agent_send(red, &(struct mu_mail){.dst = "blue"}, &seq), MU_OK);
        CU_ASSERT_EQUAL(seq, i);
    }
    outbox_sent(&red->outbox, 5);
    muster_Receipt some[] = {
        {.agent = words("red"), .first_seq = 1, .last_seq = 2, .result = muster_OUTCOME_DELIVERED},
        {.agent = words("blue"), .first_seq = 3, .last_seq = 3},
        {.agent = words("red"), .first_seq = 5, .last_seq = 5, .result = muster_OUTCOME_BOX_FULL}};
    receipts(some, 3);
    expect("red 1-2 delivered; red 5-5 box-full; ");
    CU_ASSERT_EQUAL(red->outbox.first_seq, 3);
    /* Of a mail that the runtime sent twice the broker says so, and still has to answer. */
    muster_Receipt twice[] = {
        {.agent = words("red"), .first_seq = 3, .last_seq = 4, .result = muster_OUTCOME_DUPLICATE}};
    for (int i = 1; i <= OUTBOX_HAD; i++) {
        CU_ASSERT_EQUAL(red->outbox.first_seq, 3);
        receipts(twice, 1);
        expect("");
    }
    CU_ASSERT_EQUAL(red->outbox.first_seq, 6); /* its answer must be lost */
}

static muster_Verdict verdict(const char *agent, uint64_t broker, uint64_t last_seq)
{
    return (muster_Verdict){.agent = words(agent),
                            .accepted = true,
                            .last_seq = last_seq,
                            .broker_incarnation = broker,
                            .reason = words("")};
}

static void verdict_deliver(muster_Verdict v, const char *want)
{
    delivery.verdicts._buffer = &v;
    delivery.verdicts._length = 1;
    expect(want);
}

static void test_a_verdict_is_news_once(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    muster_Verdict no = {.agent = words("red"), .broker_incarnation = 5, .reason = words("held")};
    verdict_deliver(verdict("red", 5, 0), "red welcome; ");
    verdict_deliver(verdict("red", 5, 0), "");
    verdict_deliver(verdict("stranger", 5, 0), "");
    CU_ASSERT_EQUAL(red->name_state, NAME_ACCEPTED);
    verdict_deliver(no, "red no: held; ");
    verdict_deliver(no, "");
    CU_ASSERT_EQUAL(red->name_state, NAME_REFUSED);
    verdict_deliver(verdict("red", 5, 0), "red welcome; ");
    CU_ASSERT_EQUAL(red->name_state, NAME_ACCEPTED);
    CU_ASSERT_EQUAL(process.broker_incarnation, 5);
}

/* Mails written before the verdict came are numbered after those of an earlier life. */
static void test_a_verdict_goes_on_counting(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    for (int i = 0; i < 5; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, "hello"), MU_OK);
    }
    verdict_deliver(verdict("red", 5, 3), "red welcome; ");
    const muster_Up *up = answer(NULL);
    CU_ASSERT_EQUAL_FATAL(up->acts._buffer[0].mails._length, 5);
    for (uint32_t i = 0; i < 5; i++) {
        CU_ASSERT_EQUAL(up->acts._buffer[0].mails._buffer[i].seq, 4 + i);
    }
}

static void test_another_broker_begins_anew(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    muster_Member line = {.name = words("old"), .broker = words("b1"), .host = words("h")};
    for (int i = 0; i < 4; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, "hello"), MU_OK);
    }
    delivery.members._buffer = &line;
    delivery.members._length = 1;
    verdict_deliver(verdict("red", 5, 0), "red welcome; ");
    CU_ASSERT_PTR_NOT_NULL(mu_process_lookup(&process, "old"));
    outbox_sent(&red->outbox, 4);
    expect_numbers(1, 3, "red#1 x; red#2 x; red#3 x; ");

    /* Whatever number it knows of an earlier life, it answers for none of our mails; and it hands
     * out its own first one in the same delivery, under a number of its own. */
    line.name = words("new");
    delivery.members._buffer = &line;
    delivery.members._length = 1;
    item("red", 701, "", "first");
    item("red", 703, "", "third");
    verdict_deliver(verdict("red", 6, 1000002), "red#701 first; ");
    CU_ASSERT_EQUAL(process.broker_incarnation, 6);
    CU_ASSERT_EQUAL(red->last_number, 701);
    CU_ASSERT_EQUAL(red->outbox.first_seq, 1);
    CU_ASSERT_EQUAL(red->outbox.unsent_seq, 1);
    CU_ASSERT_PTR_NULL(mu_process_lookup(&process, "old"));
    CU_ASSERT_PTR_NOT_NULL(mu_process_lookup(&process, "new"));
    CU_ASSERT_STRING_EQUAL(mu_process_member(&process, 0)->name, "new");
    CU_ASSERT_PTR_NULL(mu_process_member(&process, 1));
}

/* What one broker was told of its box says nothing of the same number at another. */
static void test_another_broker_is_acknowledged_the_same_number(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    verdict_deliver(verdict("red", 5, 0), "red welcome; ");
    expect_numbers(1, 3, "red#1 x; red#2 x; red#3 x; ");
    red->acked_number = 3; /* as if it had gone out */
    verdict_deliver(verdict("red", 6, 0), "");
    expect_numbers(1, 3, "red#1 x; red#2 x; red#3 x; ");
    const muster_Up *up = answer(NULL);
    CU_ASSERT_EQUAL_FATAL(up->acks._length, 1);
    CU_ASSERT_EQUAL(up->acks._buffer[0].number, 3);
}

/* A number of an earlier life, which a new sender would go on after, changes nothing of what is
 * out, and nothing is taken for answered. */
static void test_a_broker_that_is_back_renumbers_nothing(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    verdict_deliver(verdict("red", 5, 0), "red welcome; ");
    for (int i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, "hello"), MU_OK);
    }
    outbox_sent(&red->outbox, 2);
    for (int i = 0; i < 2; i++) { /* said twice */
        verdict_deliver(verdict("red", 6, 1 << 20), "");
        CU_ASSERT_EQUAL(red->outbox.first_seq, 1);
        CU_ASSERT_EQUAL(red->outbox.next_seq, 4);
        CU_ASSERT_EQUAL(red->outbox.unsent_seq, 1);
    }
    const muster_Up *up = answer(NULL);
    CU_ASSERT_EQUAL_FATAL(up->acts._buffer[0].mails._length, 3);
    CU_ASSERT_EQUAL(up->acts._buffer[0].first_seq, 1);
    CU_ASSERT_TRUE(up->acts._buffer[0].mails._buffer[1].again);
    CU_ASSERT_FALSE(up->acts._buffer[0].mails._buffer[2].again);
    mu_text_clear(&heard);
    outbox_sent(&red->outbox, 3);
    outbox_confirm(&red->outbox, 1, 3);
    verdict_deliver(verdict("red", 6, 1 << 20), "");
    CU_ASSERT_EQUAL(red->outbox.next_seq, (1 << 20) + 1);
}

static void again_parcel(uint64_t number, uint64_t seq)
{
    item("red", number, "", "x");
    parcels[delivery.parcels._length - 1].letter.seq = seq;
    parcels[delivery.parcels._length - 1].letter.again = true;
}

/* What another broker has handed over, to an earlier life even, is known by sender and number. */
static void test_mail_that_came_through_another_broker(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 2);
    verdict_deliver(verdict("red", 5, 0), "red welcome; ");
    expect_numbers(1, 3, "red#3 x; ");
    again_parcel(9001, 2);
    again_parcel(9002, 3);
    again_parcel(9003, 4);
    verdict_deliver(verdict("red", 6, 0), "red#9003 x; ");
    CU_ASSERT_EQUAL(red->repeats, 2);
    CU_ASSERT_EQUAL(red->last_number, 9003); /* acknowledged all the same */
    item("red", 9004, "", "new");
    parcels[0].letter.seq = 2; /* not marked: a sender may count anew */
    expect("red#9004 new; ");
}

static void test_receipts_for_an_earlier_process_of_that_name(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    muster_Receipt receipts[2] = {
        {.agent = words("red"), .first_seq = 1, .last_seq = 40},
        {.agent = words("red"), .first_seq = 41, .last_seq = 41},
    };
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "hello"), MU_OK);
    verdict_deliver(verdict("red", 5, 40), "red welcome; ");
    outbox_sent(&red->outbox, 1);
    delivery.receipts._buffer = receipts;
    delivery.receipts._length = 2;
    expect("red 41-41 delivered; ");
}

static void test_the_order_of_a_step(void)
{
    struct mu_agent *red = join("red", MU_KIND_ROBOT, 0);
    join("mind", MU_KIND_AGENT, 0); /* without a body it acts in its handlers alone */
    (void)answer(NULL);
    CU_ASSERT_STRING_EQUAL(heard.at, "red sees 1.5; "); /* in standby it does not act */
    mu_text_clear(&heard);
    item("red", 1, "", "go");
    item("red", 2, "start", "");
    const muster_Up *up = answer(&delivery);
    CU_ASSERT_STRING_EQUAL(heard.at, "red is running; red sees 1.5; red#1 go; red acts 1.5; ");
    CU_ASSERT_EQUAL(up->step, 7);
    CU_ASSERT_STRING_EQUAL(up->process, "p1");
    CU_ASSERT_STRING_EQUAL(up->acts._buffer[0].agent, "red");
    CU_ASSERT_STRING_EQUAL(up->acts._buffer[1].agent, "mind");
    CU_ASSERT_EQUAL(up->acts._buffer[0].state, muster_STATE_RUNNING);
    CU_ASSERT_EQUAL(red->handed, 2);
}

static void on_step_keep(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)a;
    *(struct mu_percept *)self = *percept;
}

static void test_a_percept_is_passed_on_whole(void)
{
    static struct mu_percept got;
    join("red", MU_KIND_ROBOT, 0);
    sense.time_ns = 700;
    percepts[0] = (muster_Percept){.robot = words("red"),
                                   .x_m = 1,
                                   .y_m = 2,
                                   .heading_rad = 3,
                                   .forward_m_s = 4,
                                   .turn_rad_s = 5,
                                   .stalled = true};
    percepts[0].sonar_m._buffer = sonar_m;
    percepts[0].sonar_m._length = 2;
    process.agents[0].handlers.self = &got;
    process.agents[0].handlers.on_step = on_step_keep;
    (void)answer(NULL);
    CU_ASSERT(got.step == 7 && got.time_ns == 700 && got.stalled);
    CU_ASSERT_DOUBLE_EQUAL(got.x_m, 1, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.y_m, 2, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.heading_rad, 3, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.forward_m_s, 4, 0);
    CU_ASSERT_DOUBLE_EQUAL(got.turn_rad_s, 5, 0);
    CU_ASSERT_EQUAL(got.sonar_count, 2);
    CU_ASSERT_PTR_EQUAL(got.sonar_m, sonar_m);
}

static void test_who_does_not_run_stands_still(void)
{
    struct mu_agent *red = join("red", MU_KIND_ROBOT, 0);
    static const enum mu_state states[] = {MU_STANDBY, MU_SUSPENDED, MU_MOVING, MU_RUNNING};
    for (size_t i = 0; i < 4; i++) {
        red->state = states[i];
        CU_ASSERT_EQUAL(mu_agent_drive(red, 0.5, -0.25), MU_OK);
        const muster_Act *act = answer(NULL)->acts._buffer;
        bool runs = states[i] == MU_RUNNING;
        CU_ASSERT_TRUE(act->drives);
        CU_ASSERT_DOUBLE_EQUAL(act->forward_m_s, runs ? 0.5 : 0.0, 0);
        CU_ASSERT_DOUBLE_EQUAL(act->turn_rad_s, runs ? -0.25 : 0.0, 0);
        CU_ASSERT_EQUAL(act->state, (muster_State)states[i]);
    }
    red->speed.set = false;
    CU_ASSERT_FALSE(answer(NULL)->acts._buffer[0].drives);
}

static void test_a_speed_is_a_number(void)
{
    struct mu_agent *red = join("red", MU_KIND_ROBOT, 0);
    const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    CU_ASSERT_EQUAL(mu_agent_drive(red, 0.5, 0.25), MU_OK);
    for (size_t i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(mu_agent_drive(red, bad[i], 0.0), MU_REFUSED);
        CU_ASSERT_EQUAL(mu_agent_drive(red, 0.0, bad[i]), MU_REFUSED);
    }
    CU_ASSERT_DOUBLE_EQUAL(red->speed.forward_m_s, 0.5, 0);
    CU_ASSERT_DOUBLE_EQUAL(red->speed.turn_rad_s, 0.25, 0);
}

static void test_rules_that_fired_are_told(void)
{
    struct mu_agent *red = join("red", MU_KIND_ROBOT, 0);
    static char rules[2 * PROCESS_RULES_MAX];
    mu_agent_fired(red, 3, "a b c");
    const muster_Act *act = answer(NULL)->acts._buffer;
    CU_ASSERT_EQUAL(act->firings, 3);
    CU_ASSERT_STRING_EQUAL(act->rules, "a b c");
    memset(rules, 'r', sizeof rules - 1);
    mu_agent_fired(red, 4, rules);
    CU_ASSERT_EQUAL(strlen(answer(NULL)->acts._buffer[0].rules), PROCESS_RULES_MAX);
}

static void test_notes_are_told(void)
{
    struct mu_agent *red = join("red", MU_KIND_ROBOT, 0);
    static char long_note[MU_NOTE_MAX + 100];
    mu_agent_note(red, "one\n");
    mu_agent_note(red, "two\n");
    CU_ASSERT_STRING_EQUAL(answer(NULL)->acts._buffer[0].diary, "one\ntwo\n");
    memset(long_note, 'n', sizeof long_note - 1);
    mu_agent_note(red, long_note);
    CU_ASSERT_EQUAL(strlen(answer(NULL)->acts._buffer[0].diary), MU_NOTE_MAX);
}

static void test_mail_waits_for_the_verdict(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "hello"), MU_OK);
    CU_ASSERT_EQUAL(answer(NULL)->acts._buffer[0].mails._length, 0);
    red->name_state = NAME_ACCEPTED;
    const muster_Act *act = answer(NULL)->acts._buffer;
    CU_ASSERT_EQUAL_FATAL(act->mails._length, 1);
    CU_ASSERT_STRING_EQUAL(act->mails._buffer[0].src, "red");
    CU_ASSERT_STRING_EQUAL(act->mails._buffer[0].dst, "all");
    CU_ASSERT_STRING_EQUAL(act->mails._buffer[0].content, "hello");
    CU_ASSERT_EQUAL(act->mails._buffer[0].layer, MU_LAYER_SPEECH);
    CU_ASSERT_EQUAL(act->mails._buffer[0].due_ns, -1);
}

static void test_limit_mails_in_one_answer(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    struct mu_agent *blue = join("blue", MU_KIND_AGENT, 0);
    red->name_state = blue->name_state = NAME_ACCEPTED;
    for (int i = 0; i < PROCESS_UP_MAILS + 1; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, ""), MU_OK);
    }
    for (int i = 0; i < PROCESS_UP_MAILS - 1; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(blue, ""), MU_OK);
    }
    const muster_Up *up = answer(NULL);
    CU_ASSERT_EQUAL(up->acts._buffer[0].mails._length, PROCESS_UP_MAILS);
    CU_ASSERT_EQUAL(up->acts._buffer[1].mails._length, PROCESS_UP_MAILS - 1);
}

static void test_limit_bytes_in_one_answer(void)
{
    static char content[MU_CONTENT_MAX + 1];
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    struct mu_agent *blue = join("blue", MU_KIND_AGENT, 0);
    red->name_state = blue->name_state = NAME_ACCEPTED;
    memset(content, 'c', MU_CONTENT_MAX);
    for (int i = 0; i < 6; i++) {
        CU_ASSERT_EQUAL(mu_agent_broadcast(red, content), MU_OK);
    }
    CU_ASSERT_EQUAL(mu_agent_broadcast(blue, content), MU_OK);
    const muster_Up *up = answer(NULL);
    CU_ASSERT_EQUAL(up->acts._buffer[0].mails._length, PROCESS_UP_BYTES / MU_CONTENT_MAX - 1);
    CU_ASSERT_EQUAL(up->acts._buffer[1].mails._length, 1); /* each has its own room */
}

static void test_limit_parcels_in_one_delivery(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    for (uint64_t number = 1; number <= PARCELS_MAX; number++) {
        item("red", number, "", "");
    }
    red->handlers.on_mail = NULL;
    deliver_with(NULL);
    CU_ASSERT_EQUAL(red->last_number, PROCESS_ITEMS);
    CU_ASSERT_EQUAL(red->handed, PROCESS_ITEMS);
}

static void test_limit_agents(void)
{
    mu_agent *a = NULL;
    char name[16];
    CU_ASSERT_EQUAL(mu_agent_join(&process, &a, "9", MU_KIND_AGENT, 0, &handlers), MU_MALFORMED);
    CU_ASSERT_EQUAL(process.agent_count, 0);
    for (int i = 0; i < MU_LOCAL_AGENTS; i++) {
        snprintf(name, sizeof name, "a%d", i);
        CU_ASSERT_STRING_EQUAL(mu_agent_name(join(name, MU_KIND_AGENT, 0)), name);
    }
    CU_ASSERT_EQUAL(mu_agent_join(&process, &a, "more", MU_KIND_AGENT, 0, &handlers), MU_FULL);
    CU_ASSERT_EQUAL(process.agent_count, MU_LOCAL_AGENTS);
    CU_ASSERT_EQUAL(mu_agent_broadcast(agent_find(&process, "a5"), "unsaid"), MU_OK);
    mu_agent_set_state(agent_find(&process, "a5"), MU_GONE);
    struct mu_agent *more = join("more", MU_KIND_AGENT, 0);
    CU_ASSERT_PTR_EQUAL(more, &process.agents[5]);
    CU_ASSERT_PTR_EQUAL(agent_find(&process, "more"), more);
    CU_ASSERT_PTR_NULL(agent_find(&process, "a5"));
    CU_ASSERT(more->exit == EXIT_PRESENT && !outbox_has_unsent(&more->outbox));
    CU_ASSERT_EQUAL(mu_agent_join(&process, &a, "a5", MU_KIND_AGENT, 0, &handlers), MU_FULL);
}

/* Out of lock step who has nothing to say is not in an Up. */
static void test_an_up_has_those_who_speak(void)
{
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    struct mu_agent *blue = join("blue", MU_KIND_AGENT, 0);
    struct mu_agent *green = join("green", MU_KIND_AGENT, 0);
    (void)red;
    CU_ASSERT_EQUAL(mu_agent_broadcast(green, "early"), MU_OK);
    verdict_deliver(verdict("blue", 5, 0), "blue welcome; ");
    CU_ASSERT_EQUAL(mu_agent_broadcast(blue, "hello"), MU_OK);
    capture_begin();
    step_hello(&process);
    capture_end();
    CU_ASSERT_EQUAL(process.up_state, UP_PENDING);
    CU_ASSERT_EQUAL_FATAL(process.out.acts._length, 1);
    CU_ASSERT_STRING_EQUAL(process.out.acts._buffer[0].agent, "blue");
    process.up_state = UP_NONE;
    verdict_deliver(verdict("green", 5, 0), "green welcome; ");
    capture_begin();
    step_hello(&process);
    capture_end();
    CU_ASSERT_EQUAL(process.out.acts._length, 2);
}

static void test_a_name_is_taken_up_again(void)
{
    struct mu_agent *first = join("red", MU_KIND_AGENT, 0);
    mu_agent *a = NULL;
    CU_ASSERT_EQUAL(mu_agent_join(&process, &a, "red", MU_KIND_AGENT, 0, &handlers), MU_EXISTS);
    mu_agent_set_state(first, MU_GONE);
    mu_text_clear(&heard);
    struct mu_agent *second = join("red", MU_KIND_AGENT, 0);
    CU_ASSERT_PTR_NOT_EQUAL(first, second);
    CU_ASSERT_PTR_EQUAL(agent_find(&process, "red"), second);
    expect_numbers(1, 1, "red#1 x; ");
    CU_ASSERT_EQUAL(second->handed, 1);
    CU_ASSERT_EQUAL(first->handed, 0);
}

static void test_limit_outbox_of_an_agent(void)
{
    process_take_memory(&process, 3, 2);
    struct mu_agent *red = join("red", MU_KIND_AGENT, 0);
    static char content[MU_CONTENT_MAX + 1];
    memset(content, 'c', MU_CONTENT_MAX);
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, content), MU_OK); /* the largest fits */
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "two"), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "three"), MU_FULL);
}

int main(void)
{
    CU_TestInfo boxes[] = {
        {"numbers in order", test_numbers_in_order},
        {"duplicates are dropped and acknowledged again",
         test_duplicates_are_dropped_and_acknowledged_again},
        {"a gap is not taken", test_a_gap_is_not_taken},
        {"a new life begins anywhere", test_a_new_life_begins_anywhere},
        {"who keeps a record goes on", test_an_agent_that_keeps_a_record_goes_on},
        {"boxes are counted apart", test_boxes_are_counted_apart},
        {"who has left takes nothing", test_who_has_left_takes_nothing},
        {"directives before percepts before mail", test_directives_before_percepts_before_mail},
        {"directives of life are the runtime's", test_directives_of_life_are_the_runtimes},
        {"a directive without a handler", test_a_directive_without_a_handler},
        {"limit: parcels in one delivery", test_limit_parcels_in_one_delivery},
        CU_TEST_INFO_NULL,
    };
    CU_TestInfo notices[] = {
        {"receipts confirm", test_receipts_confirm},
        {"a verdict is news once", test_a_verdict_is_news_once},
        {"a verdict goes on counting", test_a_verdict_goes_on_counting},
        {"another broker begins anew", test_another_broker_begins_anew},
        {"another broker, the same number", test_another_broker_is_acknowledged_the_same_number},
        {"a broker that is back", test_a_broker_that_is_back_renumbers_nothing},
        {"mail through another broker", test_mail_that_came_through_another_broker},
        {"receipts for an earlier process", test_receipts_for_an_earlier_process_of_that_name},
        CU_TEST_INFO_NULL,
    };
    CU_TestInfo answers[] = {
        {"the order of a step", test_the_order_of_a_step},
        {"a percept is passed on whole", test_a_percept_is_passed_on_whole},
        {"who does not run stands still", test_who_does_not_run_stands_still},
        {"a speed is a number", test_a_speed_is_a_number},
        {"rules that fired are told", test_rules_that_fired_are_told},
        {"notes are told", test_notes_are_told},
        {"mail waits for the verdict", test_mail_waits_for_the_verdict},
        {"limit: mails in one answer", test_limit_mails_in_one_answer},
        {"limit: bytes in one answer", test_limit_bytes_in_one_answer},
        {"limit: agents in one process", test_limit_agents},
        {"limit: outbox of an agent", test_limit_outbox_of_an_agent},
        {"an Up has those who speak", test_an_up_has_those_who_speak},
        {"a name is taken up again", test_a_name_is_taken_up_again},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/step: boxes", NULL, NULL, set_up, NULL, boxes},
                             {"runtime/step: notices", NULL, NULL, set_up, NULL, notices},
                             {"runtime/step: answers", NULL, NULL, set_up, NULL, answers},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
