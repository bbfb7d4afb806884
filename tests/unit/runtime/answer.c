/* SPDX-License-Identifier: Apache-2.0 */
/* An answer to a step is written down in one life of a process, and said again in the next. */
#include "runtime/answer.h"
#include "capture.h"
#include "core/text.h"
#include "muster/memory.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

enum { MAILS = 3, TEXT_MAX = 256 * 1024 };

static mu_process *process;
static mu_agent *red;
static muster_Mail before[MAILS];
static char text_bytes[TEXT_MAX];
static struct mu_text text;
static struct answer kept;

/* A process with red in it, and nothing said yet. */
static void life_begin(void)
{
    const struct mu_handlers none = {.self = NULL};
    process = mu_startup_alloc(sizeof *process);
    process->role = PROCESS_BODY;
    process_take_memory(process, 2, 0);
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &red, "red", MU_KIND_ROBOT, 0, &none), MU_OK);
    red->state = MU_RUNNING;
}

static void set_up(void)
{
    life_begin();
    mu_text_init(&text, text_bytes, sizeof text_bytes);
}

static void mails_say(void)
{
    struct mu_mail plain = {.dst = "blue", .content = "1:2 \"a\nb\" 3"};
    struct mu_mail whole = {.dst = "blue,green",
                            .layer = 7,
                            .performative = "ask-one",
                            .language = "clips",
                            .ontology = "o n",
                            .reply_with = "r1",
                            .in_reply_to = "r0",
                            .conversation = "c",
                            .content = "",
                            .reply_by_ns = UINT64_MAX,
                            .priority = -1,
                            .level = MU_LEVEL_LOGGED,
                            .timed = true,
                            .due_ns = 5,
                            .ttl_ns = 6};
    struct mu_mail order = {.dst = "blue", .directive = true, .performative = "start"};
    CU_ASSERT_EQUAL(mu_agent_send(red, &plain, NULL), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_send(red, &whole, NULL), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_send(red, &order, NULL), MU_OK);
}

/* What red has said in this step, as the answer has it; put together as step.c does. */
static muster_Act *act_make(muster_Mail *mails)
{
    muster_Act *act = &process->acts[red - process->agents];
    uint32_t count = outbox_unsent(&red->outbox, mails, MAILS);
    *act = (muster_Act){.agent = red->name,
                        .drives = red->speed.set,
                        .forward_m_s = red->speed.forward_m_s,
                        .turn_rad_s = red->speed.turn_rad_s,
                        .paddles = (int32_t)red->paddles,
                        .lift = (int32_t)red->lift,
                        .firings = red->firings,
                        .rules = red->rules};
    act->mails._buffer = mails;
    act->mails._length = count;
    return act;
}

static void write_down(void)
{
    (void)act_make(before);
    process->up_state = UP_ANSWERING;
    answer_add(&text, red);
    process->up_state = UP_NONE;
    CU_ASSERT_FALSE(text.cut);
}

static void mail_compare(const muster_Mail *one, const muster_Mail *other)
{
    CU_ASSERT_EQUAL(one->seq, other->seq);
    CU_ASSERT_EQUAL(one->layer, other->layer);
    CU_ASSERT_EQUAL(one->priority, other->priority);
    CU_ASSERT_EQUAL(one->level, other->level);
    CU_ASSERT_EQUAL(one->reply_by_ns, other->reply_by_ns);
    CU_ASSERT_EQUAL(one->due_ns, other->due_ns);
    CU_ASSERT_EQUAL(one->ttl_ns, other->ttl_ns);
    CU_ASSERT_STRING_EQUAL(one->dst, other->dst);
    CU_ASSERT_STRING_EQUAL(one->performative, other->performative);
    CU_ASSERT_STRING_EQUAL(one->language, other->language);
    CU_ASSERT_STRING_EQUAL(one->ontology, other->ontology);
    CU_ASSERT_STRING_EQUAL(one->reply_with, other->reply_with);
    CU_ASSERT_STRING_EQUAL(one->in_reply_to, other->in_reply_to);
    CU_ASSERT_STRING_EQUAL(one->conversation, other->conversation);
    CU_ASSERT_STRING_EQUAL(one->content, other->content);
}

static void note(void *self, enum process_up_due due, int64_t step)
{
    (void)due;
    (void)step;
    answer_add(&text, self);
}

/* Whoever has moved on has no part in the answer: those behind stand further in front in it. */
static void test_it_is_its_own_answer(void)
{
    const struct mu_handlers none = {.self = NULL};
    muster_Sense sense = {.process = words("p1"), .step = 7};
    mu_agent *blue;
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &blue, "blue", MU_KIND_ROBOT, 0, &none), MU_OK);
    blue->state = MU_STANDBY;
    mu_agent_leave(red);
    process_before_up(process, note, blue);
    mu_agent_fired(blue, 2, "go on");
    capture_begin();
    step_live_freely(process, &sense);
    capture_end();
    CU_ASSERT_PTR_NOT_NULL(strstr(text.at, "5:go on"));
}

static void test_all_of_it_comes_back(void)
{
    mails_say();
    CU_ASSERT_EQUAL(mu_agent_drive(red, 0.1, -1.0 / 3.0), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_grip(red, MU_PADDLES_CLOSE, MU_LIFT_UP), MU_OK);
    mu_agent_fired(red, 2, "wander avoid");
    write_down();
    mu_text_add(&text, "passport");
    const char *at = text.at;
    CU_ASSERT_TRUE_FATAL(answer_read(&at, &kept));
    CU_ASSERT_STRING_EQUAL(at, "passport");
    life_begin();
    CU_ASSERT_TRUE(answer_repeat(red, &kept, false));
    muster_Mail again[MAILS];
    const muster_Act *act = act_make(again);
    CU_ASSERT_EQUAL_FATAL(act->mails._length, MAILS);
    for (int i = 0; i < MAILS; i++) {
        mail_compare(&before[i], &again[i]);
    }
    CU_ASSERT_TRUE(act->drives);
    CU_ASSERT(act->forward_m_s == 0.1 && act->turn_rad_s == -1.0 / 3.0);
    CU_ASSERT(act->paddles == MU_PADDLES_CLOSE && act->lift == MU_LIFT_UP);
    CU_ASSERT_EQUAL(act->firings, 2);
    CU_ASSERT_STRING_EQUAL(act->rules, "wander avoid");
}

/* Its mail is out, with the numbers that it had, and goes out no second time. */
static void test_an_answer_that_all_have_waits_for_the_broker(void)
{
    mails_say();
    write_down();
    const char *at = text.at;
    CU_ASSERT_TRUE_FATAL(answer_read(&at, &kept));
    life_begin();
    outbox_continue(&red->outbox, 50);
    CU_ASSERT_TRUE(answer_recall(red, &kept));
    CU_ASSERT_FALSE(outbox_has_unsent(&red->outbox));
    CU_ASSERT_EQUAL(red->outbox.next_seq, 51);
    for (int i = 0; i < MAILS; i++) {
        const muster_Mail *m = outbox_awaited(&red->outbox, 51 - MAILS + (uint64_t)i);
        CU_ASSERT_PTR_NOT_NULL_FATAL(m);
        CU_ASSERT_STRING_EQUAL(m->dst, before[i].dst);
    }
}

/* Of three mails that went out in earlier steps, the second has its answer. */
static void test_mail_of_earlier_steps_waits_on(void)
{
    outbox_continue(&red->outbox, 40);
    mails_say();
    outbox_sent(&red->outbox, MAILS);
    outbox_confirm(&red->outbox, 42, 42);
    mails_say();
    write_down();
    for (int broker_had = 0; broker_had < 2; broker_had++) {
        const char *at = text.at;
        CU_ASSERT_TRUE_FATAL(answer_read(&at, &kept));
        life_begin();
        outbox_continue(&red->outbox, broker_had ? 46 : 43);
        CU_ASSERT_TRUE(answer_repeat(red, &kept, broker_had));
        const muster_Mail *first = outbox_awaited(&red->outbox, 41);
        const muster_Mail *third = outbox_awaited(&red->outbox, 43);
        CU_ASSERT_FATAL(first && third);
        CU_ASSERT_STRING_EQUAL(first->dst, "blue");
        CU_ASSERT_EQUAL(third->layer, WIRE_DIRECTIVE);
        CU_ASSERT_PTR_NULL(outbox_awaited(&red->outbox, 42));
        muster_Mail again[MAILS];
        CU_ASSERT_EQUAL_FATAL(act_make(again)->mails._length, MAILS);
        CU_ASSERT_EQUAL(again[0].seq, 44);
    }
}

static void on_act_say(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    (void)percept;
    mails_say();
    CU_ASSERT_EQUAL(mu_agent_drive(a, 0.5, 0.0), MU_OK);
}

static void before_up(void *self, enum process_up_due due, int64_t step)
{
    (void)step;
    CU_ASSERT_NOT_EQUAL(process->up_state, UP_PENDING);
    if (due == UP_DUE) {
        answer_add(self, red);
    }
}

/* What is kept of a step is kept when all is said, and before anybody hears of it. */
static void test_a_step_is_kept_before_it_goes_out(void)
{
    muster_Percept percept = {.robot = words("red")};
    muster_Sense sense = {.process = words("p1"), .step = 7, .lockstep = true};
    muster_Delivery delivery = {.process = words("p1"), .step = 6};
    sense.robots._buffer = &percept;
    sense.robots._length = 1;
    red->handlers.on_act = on_act_say;
    red->name_state = NAME_ACCEPTED;
    process_before_up(process, before_up, &text);
    capture_begin();
    (void)process_step_on(process, STEP_LOCKSTEP);
    step_live(process, &sense, &delivery);
    capture_end();
    const char *at = text.at;
    CU_ASSERT_TRUE_FATAL(answer_read(&at, &kept));
    CU_ASSERT_EQUAL(kept.mails, MAILS);
    CU_ASSERT(kept.drives && kept.forward_m_s == 0.5);
    CU_ASSERT_NOT_EQUAL(process->up_state, UP_ANSWERING);
}

static void test_who_did_nothing(void)
{
    write_down();
    const char *at = text.at;
    CU_ASSERT_TRUE_FATAL(answer_read(&at, &kept));
    CU_ASSERT_STRING_EQUAL(at, "");
    life_begin();
    CU_ASSERT_TRUE(answer_repeat(red, &kept, false));
    CU_ASSERT_FALSE(red->speed.set);
    CU_ASSERT_FALSE(outbox_has_unsent(&red->outbox));
}

static void test_between_steps_there_is_none(void)
{
    answer_add(&text, red);
    CU_ASSERT_STRING_EQUAL(text.at, "answer none\n");
    const char *at = text.at;
    CU_ASSERT_TRUE(answer_read(&at, &kept));
    CU_ASSERT_PTR_NULL(kept.text);
    CU_ASSERT_STRING_EQUAL(at, "");
}

/* However it is damaged, nothing is read beyond its end. */
static void test_damaged_ones_are_refused(void)
{
    mails_say();
    outbox_sent(&red->outbox, MAILS);
    outbox_confirm(&red->outbox, 2, 2);
    mails_say();
    write_down();
    size_t len = text.len;
    for (size_t cut = 0; cut < len; cut++) {
        char *copy = mu_startup_alloc(cut + 1);
        memcpy(copy, text.at, cut);
        const char *at = copy;
        CU_ASSERT_FALSE(answer_read(&at, &kept));
    }
    for (size_t i = (size_t)(strchr(text.at, '\n') - text.at) + 1; i < len; i++) {
        char was = text.at[i];
        text.at[i] = '9';
        const char *at = text.at;
        for (int way = 0; way < 3 && answer_read(&at, &kept); way++) { /* the sanitizers look */
            life_begin();
            outbox_continue(&red->outbox, 40);
            (void)(way < 2 ? answer_repeat(red, &kept, way == 1) : answer_recall(red, &kept));
            at = text.at;
        }
        text.at[i] = was;
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"it is its own answer", test_it_is_its_own_answer},
        {"all of it comes back", test_all_of_it_comes_back},
        {"an answer that all have waits for the broker",
         test_an_answer_that_all_have_waits_for_the_broker},
        {"mail of earlier steps waits on", test_mail_of_earlier_steps_waits_on},
        {"a step is kept before it goes out", test_a_step_is_kept_before_it_goes_out},
        {"who did nothing", test_who_did_nothing},
        {"between steps there is none", test_between_steps_there_is_none},
        {"damaged ones are refused", test_damaged_ones_are_refused},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/answer", NULL, NULL, set_up, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
