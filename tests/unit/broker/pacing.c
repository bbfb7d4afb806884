/* SPDX-License-Identifier: Apache-2.0 */
/* Mail that pours into one process, while others exchange a mail now and then. */
#include "broker/control/parts.h"
#include "broker/delivery/delivery.h"
#include "broker_story.h"

static uint64_t red_seq, blue_seq, green_seq;

/* Red floods green; blue and gray are bystanders. */
static void begin(void)
{
    static const char *const names[] = {"red", "green", "blue", "gray"};
    story_begin();
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        story_join(names[i]);
    }
    (void)story_collect();
    red_seq = blue_seq = green_seq = 0;
    story_tick(1000 * MS);
}

static void flood(uint32_t mails)
{
    for (uint32_t i = 0; i < mails; i++) {
        story_send("red", ++red_seq, "green", "m");
    }
}

static void blue_speaks(void)
{
    story_send("blue", ++blue_seq, "gray", "b");
}

/* Takes what is ready.  @return how many mails of it are for green */
static uint32_t green_gets(void)
{
    const char *process;
    muster_Delivery d;
    uint32_t mails = 0;
    while (broker_next(story.b, &process, &d)) {
        mails += strcmp(process, "p-green") == 0 ? d.parcels._length : 0;
        broker_delivered(story.b, story.now_ns);
    }
    return mails;
}

static void green_acks(uint64_t number)
{
    story_ack("green", number);
}

static void test_who_is_alone_gets_all_at_once(void)
{
    begin();
    for (uint64_t round = 1; round <= 5; round++) {
        flood(MU_WINDOW_MAX);
        CU_ASSERT_EQUAL(green_gets(), MU_WINDOW_MAX);
        green_acks(round * MU_WINDOW_MAX);
    }
    CU_ASSERT_EQUAL(pacing_deadline_ns(story.b), UINT64_MAX);
}

static void test_beside_others_it_comes_in_small_pieces(void)
{
    begin();
    flood(PACING_MANY);
    CU_ASSERT_EQUAL(green_gets(), PACING_MANY); /* the first time nobody knows */
    blue_speaks();
    flood(150);
    CU_ASSERT_EQUAL(green_gets(), 0);
    CU_ASSERT_EQUAL(pacing_deadline_ns(story.b), story.now_ns + PACING_PAUSE_NS);
    CU_ASSERT(broker_deadline_ns(story.b) <= story.now_ns + PACING_PAUSE_NS);
    story_tick(PACING_PAUSE_NS - 1);
    CU_ASSERT_EQUAL(green_gets(), 0);
    story_tick(1);
    CU_ASSERT_EQUAL(green_gets(), PACING_MAILS);
    story_tick(PACING_PAUSE_NS);
    CU_ASSERT_EQUAL(green_gets(), PACING_MAILS);
    story_tick(PACING_PAUSE_NS);
    CU_ASSERT_EQUAL(green_gets(), 150 - 2 * PACING_MAILS);
    green_acks(red_seq);
    EXPECT("red 1-166 delivered");
}

static void test_the_others_wait_for_nothing(void)
{
    begin();
    flood(MU_WINDOW_MAX);
    CU_ASSERT_EQUAL(green_gets(), MU_WINDOW_MAX);
    green_acks(MU_WINDOW_MAX);
    flood(MU_WINDOW_MAX);
    blue_speaks();
    EXPECT("red 1-200 delivered; gray #1 blue/1 b");
    CU_ASSERT_EQUAL(green_gets(), 0);
}

static void test_when_the_others_are_quiet_it_goes_on(void)
{
    begin();
    blue_speaks();
    flood(PACING_MANY);
    CU_ASSERT_EQUAL(green_gets(), PACING_MANY);
    story_tick(PACING_QUIET_NS);
    flood(150);
    CU_ASSERT_EQUAL(green_gets(), 150);
}

static void test_both_ends_of_a_flood_are_no_others(void)
{
    begin();
    for (int i = 0; i < 3; i++) {
        flood(50);
        story_send("green", ++green_seq, "red", "credit");
        CU_ASSERT_EQUAL(green_gets(), 50);
        green_acks(red_seq);
    }
}

static void test_a_few_mails_are_no_flood(void)
{
    begin();
    for (uint64_t round = 1; round <= 10; round++) {
        blue_speaks();
        flood(PACING_MANY - 1);
        CU_ASSERT_EQUAL(green_gets(), PACING_MANY - 1);
        green_acks(red_seq);
    }
}

static void test_a_directive_passes(void)
{
    begin();
    flood(PACING_MANY);
    (void)green_gets();
    blue_speaks();
    flood(100);
    CU_ASSERT_EQUAL(green_gets(), 0);
    story_register("operator", "p-operator");
    story_match("p-operator");
    (void)green_gets();
    story_mail(directive("operator", 1, "green", "(stop)"));
    CU_ASSERT_EQUAL(green_gets(), PACING_MAILS); /* it, and what there is room for */
}

static void test_a_process_that_ends_is_not_waited_for(void)
{
    begin();
    flood(PACING_MANY);
    (void)green_gets();
    blue_speaks();
    flood(100);
    CU_ASSERT_EQUAL(green_gets(), 0);
    story_gone("p-green");
    broker_matched(story.b, "p-green", false, story.now_ns);
    story_tick(20000 * MS);
    CU_ASSERT_EQUAL(pacing_deadline_ns(story.b), UINT64_MAX);
    story_register("green", "p-green");
    story_match("p-green");
    CU_ASSERT_EQUAL(green_gets(), PACING_MANY + 100);
}

/* Green is no longer flooded, and gets a mail all the time: gray, which is, waits for its own pause
 * alone. */
static void test_who_is_held_holds_up_nobody(void)
{
    uint64_t white_seq = 0;
    uint32_t gray_got = 0;
    begin();
    story_join("white");
    flood(PACING_MANY);
    (void)green_gets();
    story_ack("green", red_seq);
    blue_speaks();
    flood(1);
    (void)green_gets();
    CU_ASSERT_EQUAL(story.b->pacing.held.count, 1);
    story_register("green2", "p-green"); /* the broker's word to it passes */
    (void)green_gets();
    for (int round = 0; round < 400; round++) { /* of half a millisecond */
        for (int i = 0; i < 150 && round % 4 == 0 && white_seq < 450; i++) {
            story_send("white", ++white_seq, "gray", "w");
        }
        const char *process;
        muster_Delivery d;
        while (broker_next(story.b, &process, &d)) {
            uint32_t mails = d.parcels._length;
            uint64_t number = mails ? d.parcels._buffer[mails - 1].number : 0;
            bool is_gray = strcmp(process, "p-gray") == 0;
            broker_delivered(story.b, story.now_ns);
            gray_got += is_gray ? mails : 0;
            if (number && (is_gray || strcmp(process, "p-green") == 0)) {
                story_ack(is_gray ? "gray" : "green", number);
            }
        }
        story_tick(PACING_PAUSE_NS / 2);
        flood(1);
    }
    CU_ASSERT_EQUAL(gray_got, white_seq);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"who is alone gets all at once", test_who_is_alone_gets_all_at_once},
        {"beside others it comes in small pieces", test_beside_others_it_comes_in_small_pieces},
        {"the others wait for nothing", test_the_others_wait_for_nothing},
        {"when the others are quiet it goes on", test_when_the_others_are_quiet_it_goes_on},
        {"both ends of a flood are no others", test_both_ends_of_a_flood_are_no_others},
        {"a few mails are no flood", test_a_few_mails_are_no_flood},
        {"a directive passes", test_a_directive_passes},
        {"a process that ends is not waited for", test_a_process_that_ends_is_not_waited_for},
        {"who is held holds up nobody", test_who_is_held_holds_up_nobody},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/floods", tests);
}
