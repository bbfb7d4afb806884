/* SPDX-License-Identifier: Apache-2.0 */
/* How many letters, bytes and boxes a multicast has, and how many it takes to make one. */
#include "circular_story.h"

/* --- letters ---------------------------------------------------------------------------------- */

static void test_limit_letters(void)
{
    crowd_of(4);
    for (uint32_t i = 0; i < BUS_CIRCULAR_LETTERS + 1; i++) {
        say("all", "x");
    }
    const char *text = story_collect();
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "; all: a #18, b #18, c #18, d #18 | red/21 x"));
    CU_ASSERT_EQUAL(story.b->dispatch.count.multicasts, 2);
    acknowledge(BUS_CIRCULAR_LETTERS + 2);
    EXPECT("red 5-21 delivered");
    all_is_over();
}

static void test_limit_bytes(void)
{
    static char long_text[15001];
    const char *process;
    muster_Delivery d;
    uint32_t letters[2];
    memset(long_text, 'x', sizeof long_text - 1);
    crowd_of(4);
    for (int i = 0; i < 3; i++) {
        say("all", long_text);
    }
    for (int i = 0; i < 2; i++) {
        CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
        letters[i] = d.letters._length;
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_EQUAL(letters[0], 2);
    CU_ASSERT_EQUAL(letters[1], 1);
    EXPECT("");
}

/* Those who find no room go as any mail does, behind the others. */
static void test_limit_waiting(void)
{
    crowd_of(4);
    for (uint32_t i = 0; i < MULTICAST_WAITING + 1; i++) {
        say("all", "x");
    }
    CU_ASSERT_EQUAL(story.b->multicast.count, MULTICAST_WAITING);
    const char *text = story_collect();
    CU_ASSERT_PTR_NOT_NULL(
        strstr(text, "; a #66 red/69 x; b #66 red/69 x; c #66 red/69 x; d #66 red/69 x"));
    CU_ASSERT_EQUAL(story.b->dispatch.count.multicasts, MULTICAST_WAITING / BUS_CIRCULAR_LETTERS);
    acknowledge(MULTICAST_WAITING + 2);
    EXPECT("red 5-69 delivered");
    all_is_over();
}

/* --- boxes ------------------------------------------------------------------------------------ */

static void test_few_have_a_delivery_each(void)
{
    crowd_of(8);
    say("a,b,c", "hi");
    EXPECT("a #2 red/9 hi; b #2 red/9 hi; c #2 red/9 hi");
    say("a,b,c,d", "ho");
    EXPECT("all: a #3, b #3, c #3, d #2 | red/10 ho");
    crowd_of(9); /* most of those who hear it would hear it in vain */
    say("a,b,c,d", "hi");
    EXPECT("a #2 red/10 hi; b #2 red/10 hi; c #2 red/10 hi; d #2 red/10 hi");
    say("a,b,c,d,e", "ho");
    EXPECT("all: a #3, b #3, c #3, d #3, e #2 | red/11 ho");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

/* Agents of a process, from m0 on, which hears multicasts. */
static void many_join(const char *process, uint32_t first, uint32_t count)
{
    char name[32];
    story_match(process);
    for (uint32_t i = first; i < first + count; i++) {
        snprintf(name, sizeof name, "m%u", (unsigned)i);
        story_register(name, process);
    }
    (void)story_collect();
    broker_hears(story.b, process);
    for (uint32_t i = first; i < first + count; i++) {
        struct one_up u;
        snprintf(name, sizeof name, "m%u", (unsigned)i);
        say(name, "hello");
        (void)story_collect();
        one_up(&u, name, process, NULL, 0, 1);
        story_hear(&u.up);
    }
    (void)story_collect();
}

/* What went out: boxes in multicasts, and delivery items in Deliveries. */
static struct {
    uint32_t multicasts, boxes, parcels;
} out;

static void count_out(void)
{
    const char *process;
    muster_Delivery d;
    memset(&out, 0, sizeof out);
    while (broker_next(story.b, &process, &d)) {
        out.multicasts += d.seats._length > 0;
        out.boxes += d.seats._length;
        out.parcels += d.parcels._length;
        story_note(&d);
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_many_agents_of_few_processes(void)
{
    crowd_of(3);
    many_join("p-m", 0, 3);
    say("a,b,m0,m1,m2", "hi");
    count_out();
    CU_ASSERT_EQUAL(out.multicasts, 0);
    CU_ASSERT_EQUAL(out.parcels, 5);
    say("a,b,c,m0,m1,m2", "hi");
    count_out();
    CU_ASSERT_EQUAL(out.boxes, 6);
    CU_ASSERT_EQUAL(out.parcels, 0);
}

static void test_limit_agents_of_a_process(void)
{
    crowd_of(4);
    many_join("p-m", 0, BUS_CIRCULAR_BOXES + 5);
    say("all", "hi");
    count_out();
    CU_ASSERT_EQUAL(out.multicasts, 1);
    CU_ASSERT_EQUAL(out.boxes, 4 + BUS_CIRCULAR_BOXES);
    CU_ASSERT_EQUAL(out.parcels, 5);
}

static void test_limit_boxes(void)
{
    char process[16];
    const uint32_t each = 60, processes = 18;
    crowd_of(4);
    for (uint32_t i = 0; i < processes; i++) {
        snprintf(process, sizeof process, "q%lu", (unsigned long)i);
        many_join(process, i * each, each);
    }
    say("all", "hi");
    count_out();
    CU_ASSERT_EQUAL(out.multicasts, 1);
    CU_ASSERT_EQUAL(out.boxes, MULTICAST_BOXES);
    CU_ASSERT_EQUAL(out.parcels, 4 + processes * each - MULTICAST_BOXES);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"limit: letters", test_limit_letters},
        {"limit: bytes", test_limit_bytes},
        {"limit: waiting", test_limit_waiting},
        {"few have a Delivery each", test_few_have_a_delivery_each},
        {"many agents of few processes", test_many_agents_of_few_processes},
        {"limit: agents of a process", test_limit_agents_of_a_process},
        {"limit: boxes", test_limit_boxes},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/circular_limits", tests);
}
