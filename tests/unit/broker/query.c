/* SPDX-License-Identifier: Apache-2.0 */
#include "broker_story.h"

static muster_Mail question(uint64_t seq, const char *performative, const char *content)
{
    muster_Mail m = letter("red", seq, "broker", content);
    m.layer = 2;
    m.performative = words(performative);
    m.reply_with = words("q1");
    m.conversation = words("c7");
    return m;
}

static void team(void)
{
    story_begin();
    story_join("red");
    story_join("green");
    (void)story_collect();
}

static void test_lookup(void)
{
    team();
    story_mail(question(1, "lookup", "green"));
    EXPECT("red #1 broker/4611686018427387905 member green robot running alpha here 1; "
           "red 1-1 delivered");
    story_gone("p-green");
    story_mail(question(2, "lookup", " \"green\" "));
    EXPECT("red #2 broker/4611686018427387906 member green robot absent alpha here 1; "
           "red 2-2 delivered");
    story_mail(question(3, "lookup", "grue"));
    EXPECT("red #3 broker/4611686018427387907 unknown-name grue; red 3-3 delivered");
    story_mail(question(4, "lookup", "\"a \\\"b\""));
    EXPECT("red #4 broker/4611686018427387908 unknown-name \"a \\\"b\"; red 4-4 delivered");
    story_mail(question(5, "lookup", "broker"));
    EXPECT("red #5 broker/4611686018427387909 member broker special running alpha \"\" 9; "
           "red 5-5 delivered");
}

static void test_answers_are_mails_with_an_envelope(void)
{
    static const char *const cases[][3] = {
        {"lookup", "green", "inform"},          {"lookup", "grue", "failure"},
        {"lookup", "", "not-understood"},       {"lookup", "red green", "not-understood"},
        {"lookup", "\"open", "not-understood"}, {"sing", "", "not-understood"}};
    team();
    for (uint64_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *process;
        muster_Delivery d;
        story_mail(question(i + 1, cases[i][0], cases[i][1]));
        CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
        CU_ASSERT_EQUAL_FATAL(d.parcels._length, 1);
        const muster_Mail *m = &d.parcels._buffer[0].letter;
        CU_ASSERT_STRING_EQUAL(m->performative, cases[i][2]);
        CU_ASSERT_STRING_EQUAL(m->src, "broker");
        CU_ASSERT_STRING_EQUAL(m->dst, "red");
        CU_ASSERT_STRING_EQUAL(m->in_reply_to, "q1");
        CU_ASSERT_STRING_EQUAL(m->reply_with, "");
        CU_ASSERT_STRING_EQUAL(m->conversation, "c7");
        CU_ASSERT_EQUAL(m->layer, 2);
        broker_delivered(story.b, 0);
    }
    CU_ASSERT_EQUAL(story_status().malformed, 3); /* what could not be read */
}

static void test_speech_to_the_broker_is_not_understood(void)
{
    team();
    story_send("red", 1, "broker", "hello");
    EXPECT("red #1 broker/4611686018427387905 performative tell; red 1-1 delivered");
    CU_ASSERT_EQUAL(story_status().sent, 2);
    CU_ASSERT_EQUAL(story_status().delivered, 1);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
}

static void test_listing(void)
{
    team();
    story_mail(question(1, "listing", ""));
    EXPECT("red #1 broker/4611686018427387905 members broker broker.delivery broker.federation "
           "broker.groups "
           "broker.journal broker.mail broker.names broker.services "
           "broker.trust green red; red 1-1 delivered");
}

static void test_long_listing_comes_in_several_mails(void)
{
    char name[MU_NAME_MAX + 1], process[16];
    team();
    for (unsigned i = 0; i < 1000; i++) {
        snprintf(name, sizeof name, "an-agent-with-a-long-name-%05u", i);
        snprintf(process, sizeof process, "p%u", i / MU_LOCAL_AGENTS_MAX);
        story_register(name, process);
    }
    (void)story_collect();
    story_mail(question(1, "listing", ""));
    const char *text = story_collect();
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "red #1 broker/"));
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "red #2 broker/"));
    CU_ASSERT_PTR_NULL(strstr(text, "red #3 broker/"));
    unsigned names = 0;
    for (const char *at = text; (at = strstr(at, "an-agent-")); at++) {
        names++;
    }
    CU_ASSERT_EQUAL(names, 1000);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"lookup", test_lookup},
        {"answers are mails with an envelope", test_answers_are_mails_with_an_envelope},
        {"speech to the broker is not understood", test_speech_to_the_broker_is_not_understood},
        {"listing", test_listing},
        {"a long listing comes in several mails", test_long_listing_comes_in_several_mails},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/query", tests);
}
