/* SPDX-License-Identifier: Apache-2.0 */
#include "broker_story.h"
#include "bus/check.h"

static void test_welcome_comes_when_the_reader_is_there(void)
{
    story_begin();
    story_register("red", "p-red");
    EXPECT("");
    CU_ASSERT_TRUE(story_awaits("p-red"));
    CU_ASSERT_EQUAL(story_awaited(), 1);
    story_match("p-red");
    EXPECT("red welcome 0");
    CU_ASSERT_EQUAL(story.members, MU_BROKER_LINES + 1); /* and red itself */
    CU_ASSERT_EQUAL(story_awaited(), 0);
    CU_ASSERT_TRUE(story_serves("p-red"));
    story_register("red", "p-red"); /* a heartbeat */
    EXPECT("");
    CU_ASSERT_EQUAL(story.members, 0);
}

static void test_others_hear_of_changes_alone(void)
{
    story_begin();
    story_join("red");
    story_join("green");
    story_state("green", muster_STATE_SUSPENDED);
    muster_Page news;
    while (broker_page_news(story.b, &news)) {
        CU_ASSERT_STRING_EQUAL(news.broker, "alpha");
    }
    EXPECT("");
    CU_ASSERT_EQUAL(story.members, 2); /* one line, to each of two processes */
    story_state("green", muster_STATE_RUNNING);
    story_state("green", muster_STATE_SUSPENDED);
    CU_ASSERT_TRUE(broker_page_news(story.b, &news));
    /* The broker and its parts, red and green. */
    CU_ASSERT_EQUAL_FATAL(news.lines._length, MU_BROKER_LINES + 2);
    CU_ASSERT_STRING_EQUAL(news.lines._buffer[0], "broker special running alpha - - 9 1000");
    CU_ASSERT_STRING_EQUAL(news.lines._buffer[MU_BROKER_LINES + 1],
                           "green robot suspended alpha p-green here 1 1000");
    CU_ASSERT_FALSE(broker_page_news(story.b, &news));
    registry_mark_page(&story.b->registry, news.part); /* the network did not take it */
    news.part = 99;
    CU_ASSERT_TRUE(broker_page_news(story.b, &news));
    CU_ASSERT_EQUAL(news.part, 0);
    CU_ASSERT_FALSE(broker_page_news(story.b, &news));
    CU_ASSERT_STRING_EQUAL(story_member("green"), "green suspended p-green");
    CU_ASSERT_STRING_EQUAL(story_member("broker"), "broker running ");
    CU_ASSERT_EQUAL(story_status().agents, 2);
}

static void test_names_that_are_refused(void)
{
    static const char *const lines[][2] = {
        {"", ": not a valid name"},
        {"9lives", "9lives: not a valid name"},
        {"all", "all: reserved name"},
        {"robots", "robots: reserved name"},
        {"special", "special: reserved name"},
        {"broker", "broker: reserved name"},
        {"broker.two", "broker.two: reserved name"},
        {"a-name-of-31-characters-and-more", "a-name-of-31-characters-and-more: not a valid name"},
    };
    story_begin();
    story_match("p");
    (void)story_collect();
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        story_register(lines[i][0], "p");
        EXPECT(lines[i][1]);
    }
    muster_Registration r = registration("operator", "p"); /* a robot */
    broker_registration(story.b, &r, 0);
    EXPECT("operator: reserved for a special agent");
    story_register("operator", "p");
    EXPECT("operator welcome 0");
}

static void test_bad_registrations_are_counted(void)
{
    story_begin();
    muster_Registration bad[] = {
        registration("red", ""),  registration("red", "p*"), registration("red", "p"),
        registration("red", "p"), registration("red", "p"),  registration("red", "p"),
        registration("red", "p"), registration("red", "p"),  registration("red", "p"),
        registration(NULL, "p"),  registration("red", NULL)};
    entry_of(&bad[2])->kind = (muster_Kind)77;
    entry_of(&bad[3])->state = (muster_State)-1;
    entry_of(&bad[4])->full = (muster_BoxPolicy)3;
    entry_of(&bad[5])->home = words("beta"); /* only a broker speaks for others */
    bad[6].host = NULL;
    bad[7].part = MU_PARTS_MAX;
    bad[8].agents._length = MU_PART_AGENTS + 1;
    for (uint32_t i = 0; i < 6; i++) {
        broker_registration(story.b, &bad[i], 0);
        CU_ASSERT_EQUAL(story_status().malformed, i + 1);
    }
    for (uint32_t i = 6; i < 11; i++) { /* at the border */
        CU_ASSERT_FALSE(check_registration(&bad[i]));
    }
    CU_ASSERT_STRING_EQUAL(story_member("red"), "nobody");
    CU_ASSERT_EQUAL(story_awaited(), 0);
}

static void test_restarted_sender_goes_on_counting(void)
{
    story_begin();
    story_join("red");
    story_join("green");
    story_send("red", 41, "green", "hello");
    EXPECT("green #1 red/41 hello");
    story_gone("p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    (void)story_collect();
    story_register("red", "p-again");
    story_match("p-again");
    EXPECT("red welcome 41");
    muster_Registration r = registration("red", "p-again"); /* the same process name, restarted */
    r.incarnation = 2;
    broker_registration(story.b, &r, 0);
    EXPECT("red welcome 41");
    r.incarnation = 1; /* an old sample, late */
    entry_of(&r)->state = muster_STATE_SUSPENDED;
    broker_registration(story.b, &r, 0);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-again");
}

/* It would forget them with the first answer to a name, which says which broker this is. */
static void test_pages_are_told_with_the_first_agent(void)
{
    story_begin();
    story_join("red");
    story_register("red", "p-late"); /* waits for the name */
    story_match("p-late");
    EXPECT("");
    CU_ASSERT_EQUAL(story.members, 0);
    story_register("green", "p-late");
    EXPECT("green welcome 0");
    CU_ASSERT_EQUAL(story.members, 2 * (2 + MU_BROKER_LINES) - (1 + MU_BROKER_LINES));
}

static void test_limit_agents(void)
{
    char name[16], process[16];
    story_begin();
    for (unsigned i = 0; i < MU_AGENTS_MAX; i++) {
        CU_ASSERT_TRUE(broker_takes_names(story.b));
        snprintf(name, sizeof name, "r%u", i);
        snprintf(process, sizeof process, "p%u", i / MU_LOCAL_AGENTS_MAX);
        story_register(name, i + 1 < MU_AGENTS_MAX ? process : "q");
    }
    CU_ASSERT_EQUAL(story_status().agents, MU_AGENTS_MAX);
    CU_ASSERT_FALSE(broker_takes_names(story.b));
    story_gone("q"); /* its name stays */
    CU_ASSERT_EQUAL(story_status().agents, MU_AGENTS_MAX - 1);
    CU_ASSERT_FALSE(broker_takes_names(story.b));
    story_register(name, "q");
    CU_ASSERT_EQUAL(story_status().agents, MU_AGENTS_MAX);
    story_match("q");
    (void)story_collect();
    CU_ASSERT_EQUAL(story.members, MU_AGENTS_MAX + MU_BROKER_LINES);
    story_register("more", "q");
    EXPECT("more: the white pages are full");
    story_leave("r7", "p0"); /* a name once known stays known */
    story_register("more", "q");
    EXPECT("more: the white pages are full");
    story_register("r7", "q");
    EXPECT("r7 welcome 0");
}

static void test_who_has_not_matched(void)
{
    static const char *const processes[] = {"p0", "p1", "p2", "p3"};
    char name[16];
    story_begin();
    for (unsigned i = 0; i < 4; i++) {
        snprintf(name, sizeof name, "r%u", i);
        story_register(name, processes[i]);
    }
    story_match("p1");
    story_match("p3");
    story_match("p3");
    story_gone("p0"); /* its place is free, and p2 stays where it was */
    CU_ASSERT_FALSE(story_awaits("p0") || story_awaits("p1") || story_awaits("p3"));
    CU_ASSERT_TRUE(story_awaits("p2"));
    broker_matched(story.b, "p1", false, story.now_ns);
    broker_matched(story.b, "p1", false, story.now_ns);
    story_match("p2");
    CU_ASSERT_TRUE(story_awaits("p1"));
    CU_ASSERT_FALSE(story_awaits("p2"));
    story_register("r0", "p0");
    CU_ASSERT_TRUE(story_awaits("p0"));
    CU_ASSERT_TRUE(story_awaited() <= 2);
}

static void test_limit_processes(void)
{
    char name[16], process[16];
    story_begin();
    for (unsigned i = 0; i < MU_PROCESSES_MAX; i++) {
        snprintf(name, sizeof name, "r%u", i);
        snprintf(process, sizeof process, "p%u", i);
        story_register(name, process);
    }
    CU_ASSERT_EQUAL(story_awaited(), MU_PROCESSES_MAX);
    story_register("more", "one-too-many");
    CU_ASSERT_EQUAL(story_status().malformed, 1);
    CU_ASSERT_STRING_EQUAL(story_member("more"), "nobody");
    story_gone("p3");
    story_register("more", "one-too-many");
    CU_ASSERT_STRING_EQUAL(story_member("more"), "more running one-too-many");
}

static void test_refused_strangers_make_way(void)
{
    char process[16];
    story_begin();
    for (unsigned i = 0; i < 2 * MU_PROCESSES_MAX; i++) {
        snprintf(process, sizeof process, "p%u", i);
        story_register("all", process);
    }
    CU_ASSERT_EQUAL(story_status().malformed, 0);
    story_join("red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a welcome comes when the reader is there", test_welcome_comes_when_the_reader_is_there},
        {"others hear of changes alone", test_others_hear_of_changes_alone},
        {"names that are refused", test_names_that_are_refused},
        {"bad registrations are counted", test_bad_registrations_are_counted},
        {"a restarted sender goes on counting", test_restarted_sender_goes_on_counting},
        {"pages are told with the first agent", test_pages_are_told_with_the_first_agent},
        {"limit: agents", test_limit_agents},
        {"who has not matched", test_who_has_not_matched},
        {"limit: processes", test_limit_processes},
        {"refused strangers make way", test_refused_strangers_make_way},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/registry", tests);
}
