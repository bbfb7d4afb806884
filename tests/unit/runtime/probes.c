/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Questions that only look, as their asker's process keeps them, without a network: which are out,
 * and what becomes of them when somebody leaves or a broker goes.
 */
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static mu_process process;
static mu_agent *red, *blue;
static struct {
    uint64_t number;
    enum probe_end end;
    char text[32];
    unsigned count;
} ended;

static void on_end(void *self, uint64_t number, enum probe_end end, const char *text)
{
    CU_ASSERT_PTR_EQUAL(self, &ended);
    ended.number = number;
    ended.end = end;
    mu_text_copy(ended.text, sizeof ended.text, text);
    ended.count++;
}

static mu_agent *agent_join(const char *name)
{
    static const struct mu_handlers none;
    mu_agent *a;
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &a, name, MU_KIND_AGENT, 0, &none), MU_OK);
    a->name_state = NAME_ACCEPTED;
    probes_hear(a, on_end, &ended);
    return a;
}

static void set_up(void)
{
    memset(&process, 0, sizeof process);
    memset(&ended, 0, sizeof ended);
    process_take_memory(&process, 4, 2);
    process.link.incarnation = 7;
    red = agent_join("red");
    blue = agent_join("blue");
}

static uint64_t ask(mu_agent *a)
{
    uint64_t number = 0;
    CU_ASSERT_EQUAL(probes_ask(a, "green", "(facts)", &number), MU_OK);
    return number;
}

/* Answers come in a Delivery. */
static void answer(const char *asker, uint64_t number, muster_GlanceWord word, const char *text)
{
    muster_Glance g = {.word = word,
                       .asker = words(asker),
                       .number = number,
                       .agent = words("green"),
                       .text = words(text)};
    muster_Delivery d = {.broker_incarnation = 7};
    d.glances._buffer = &g;
    d.glances._length = 1;
    probes_take(&process, &d);
}

static void test_question_and_answer(void)
{
    muster_Up up = {.process = words("p1")};
    set_up();
    uint64_t first = ask(red), second = ask(blue);
    CU_ASSERT_TRUE(second > first);
    CU_ASSERT_TRUE(probes_fill(&process, &up));
    CU_ASSERT_EQUAL_FATAL(up.glances._length, 2);
    CU_ASSERT_STRING_EQUAL(up.glances._buffer[0].asker, "red");
    CU_ASSERT_STRING_EQUAL(up.glances._buffer[1].asker, "blue");
    CU_ASSERT_STRING_EQUAL(up.glances._buffer[1].text, "(facts)");
    answer("red", first, muster_GLANCE_DONE, "early"); /* to what nobody has heard yet */
    CU_ASSERT_EQUAL(ended.count, 0);
    probes_sent(&process, &up);
    CU_ASSERT_FALSE(probes_fill(&process, &up));
    answer("blue", first, muster_GLANCE_DONE, "of another's question");
    CU_ASSERT_EQUAL(ended.count, 0);
    answer("red", first, muster_GLANCE_DONE, "f-0");
    CU_ASSERT_EQUAL(ended.number, first);
    CU_ASSERT_EQUAL(ended.end, PROBE_DONE);
    CU_ASSERT_STRING_EQUAL(ended.text, "f-0");
    answer("red", first, muster_GLANCE_DONE, "again");
    CU_ASSERT_EQUAL(ended.count, 1);
    CU_ASSERT_EQUAL(process.probes.count, 1);
}

/* While the network takes no Up, one who has asked leaves and another asks: what goes out then is
 * what was put together, and the last question is still to go. */
static void test_an_up_that_waits(void)
{
    muster_Up up = {.process = words("p1")};
    set_up();
    (void)ask(red);
    (void)ask(blue);
    CU_ASSERT_TRUE(probes_fill(&process, &up));
    probes_forget(red);
    CU_ASSERT_EQUAL(ended.end, PROBE_DECLINED);
    uint64_t later = ask(blue);
    probes_sent(&process, &up);
    CU_ASSERT_TRUE(probes_fill(&process, &up));
    CU_ASSERT_EQUAL_FATAL(up.glances._length, 1);
    CU_ASSERT_EQUAL(up.glances._buffer[0].number, later);
}

/* What another broker was asked is not known to this one: who asked asks in another way. */
static void test_another_broker(void)
{
    muster_Up up = {.process = words("p1")};
    set_up();
    uint64_t out = ask(red);
    CU_ASSERT_TRUE(probes_fill(&process, &up));
    probes_sent(&process, &up);
    (void)ask(blue); /* has not gone out: the new broker is asked */
    process.link.incarnation = 8;
    probes_review(&process);
    CU_ASSERT_EQUAL(ended.count, 1);
    CU_ASSERT_EQUAL(ended.number, out);
    CU_ASSERT_EQUAL(ended.end, PROBE_DECLINED);
    CU_ASSERT_EQUAL(process.probes.count, 1);
    CU_ASSERT_TRUE(probes_fill(&process, &up));
}

static void test_limit_questions(void)
{
    uint64_t number;
    set_up();
    for (int i = 0; i < MU_GLANCES_EACH; i++) {
        (void)ask(red);
    }
    CU_ASSERT_EQUAL(probes_ask(blue, "green", "(facts)", &number), MU_FULL);
    probes_forget(red);
    CU_ASSERT_EQUAL(ended.count, MU_GLANCES_EACH);
    (void)ask(blue);
    CU_ASSERT_EQUAL(probes_ask(blue, "green", "(assert (a))", &number), MU_REFUSED);
    CU_ASSERT_EQUAL(probes_ask(blue, "no name", "(facts)", &number), MU_REFUSED);
    blue->name_state = NAME_ASKED;
    CU_ASSERT_EQUAL(probes_ask(blue, "green", "(facts)", &number), MU_FULL);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"question and answer", test_question_and_answer},
        {"an Up that waits", test_an_up_that_waits},
        {"another broker", test_another_broker},
        {"limit: questions", test_limit_questions},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/probes", tests);
}
