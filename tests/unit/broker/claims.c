/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "broker_story.h"

static void test_held_name_is_refused_in_the_end(void)
{
    story_begin();
    story_join("red");
    story_match("thief");
    (void)story_collect();
    story_register("red", "thief");
    EXPECT("");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 1500 * MS);
    story_tick(1500 * MS - 1);
    EXPECT("");
    story_tick(1);
    EXPECT("red: held by another participant");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
}

static void register_epoch(const char *process, uint64_t epoch)
{
    muster_Registration r = registration("red", process);
    entry_of(&r)->epoch = epoch;
    broker_registration(story.b, &r, story.now_ns);
}

/* An agent that has set out twice has left a copy behind at the first try. */
static void test_a_copy_that_is_out_of_date_inherits_nothing(void)
{
    story_begin();
    story_join("red");
    story_match("p1");
    story_match("p2");
    (void)story_collect();
    register_epoch("p-red", 1);
    register_epoch("p1", 1);
    EXPECT("");
    register_epoch("p-red", 2); /* it stays, or tries another way */
    EXPECT("red: out of date");
    register_epoch("p1", 1);
    EXPECT("red: out of date");
    register_epoch("p2", 2);
    EXPECT("");
    story_gone("p-red");
    EXPECT("red welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p2");
    story_gone("p2");
    story_match("p3");
    (void)story_collect();
    register_epoch("p3", 0); /* another agent of that name, when nobody has it */
    EXPECT("red welcome 0");
}

static void test_held_name_is_inherited(void)
{
    story_begin();
    story_join("red");
    story_match("heir");
    story_match("late");
    (void)story_collect();
    story_register("red", "heir");
    story_register("red", "late");
    story_gone("late"); /* it does not hold the name: nothing happens */
    story_gone("p-red");
    EXPECT("red welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running heir");
    story_gone("p-red"); /* of the old process, once more */
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running heir");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
}

static void three_wait_for_red(void)
{
    story_begin();
    story_join("red");
    for (int i = 0; i < 3; i++) {
        char process[] = {'p', (char)('1' + i), '\0'};
        story_match(process);
        (void)story_collect();
        story_register("red", process);
        story_register("red", process); /* its heartbeat gives it no second claim */
        EXPECT("");
        story_tick(500 * MS);
    }
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 2); /* p1 has waited for 1.5 s */
    EXPECT("red: held by another participant");
}

/* A controller that was started again and again, each time killed soon: the last one lives. */
static void test_a_name_goes_to_who_asked_first(void)
{
    three_wait_for_red();
    story_gone("p-red");
    EXPECT("red welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p2");
    story_tick(400 * MS);
    story_gone("p2");
    EXPECT("red welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p3");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
}

static void test_who_waits_in_the_middle_gives_up(void)
{
    three_wait_for_red();
    story_gone("p-red");
    story_register("red", "p1"); /* once more, behind the others */
    story_leave("red", "p3");
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 1);
    story_gone("p2");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p1");
    story_gone("p1");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p1");
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 0);
}

/* Whoever waits behind it is refused in its own time. */
static void test_an_heir_keeps_the_name(void)
{
    three_wait_for_red();
    story_gone("p-red");
    EXPECT("red welcome 0");
    story_tick(500 * MS); /* p3 has waited for 1 s */
    EXPECT("");
    story_tick(500 * MS);
    EXPECT("red: held by another participant");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p2");
}

/* Of copies that wait, the one that is older than the heir has nothing to wait for. */
static void test_an_heir_makes_older_copies_void(void)
{
    story_begin();
    story_join("red");
    story_match("p1");
    story_match("p2");
    (void)story_collect();
    register_epoch("p1", 2);
    register_epoch("p2", 1);
    EXPECT("");
    story_gone("p-red");
    EXPECT("red welcome 0; red: out of date");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p1");
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 0);
}

/* A process that waits for more names than there is room for is refused the rest. */
static void test_claims_have_a_limit(void)
{
    static struct claims c;
    static struct mu_list of[CLAIMS_MAX];
    mu_pool_init(&c.pool, CLAIMS_MAX);
    for (uint32_t i = 0; i < CLAIMS_MAX; i++) {
        CU_ASSERT_TRUE_FATAL(claims_add(&c, &of[i / 2], &(struct claim){.process = i % 2}));
    }
    CU_ASSERT_FALSE(claims_add(&c, &of[7], &(struct claim){.process = 9}));
    claims_drop(&c, &of[7], claims_find(&c, &of[7], 1));
    CU_ASSERT_TRUE(claims_add(&c, &of[7], &(struct claim){.process = 9}));
    claims_drop(&c, &of[7], claims_find(&c, &of[7], 0));
    CU_ASSERT_EQUAL(claims_find(&c, &of[7], 0), MU_NONE);
    CU_ASSERT_EQUAL(claims_find(&c, &of[7], 9), mu_list_first(&of[7]));
    CU_ASSERT_EQUAL(c.pool.live, CLAIMS_MAX - 1);
}

static void test_claim_is_given_up(void)
{
    story_begin();
    story_join("red");
    story_register("red", "p2");
    CU_ASSERT_TRUE(story_awaits("p2"));
    CU_ASSERT_EQUAL(story_awaited(), 1);
    story_gone("p2");
    CU_ASSERT_EQUAL(story_awaited(), 0);
    CU_ASSERT_FALSE(story_serves("p2"));
    story_tick(2000 * MS);
    EXPECT("");
}

/* Both claim in one slot of their process: the one that was there has left. */
static void test_a_claim_ends_when_its_slot_bears_another_name(void)
{
    story_begin();
    story_join("red");
    story_join("blue");
    story_match("p2");
    (void)story_collect();
    muster_Registration r = registration("red", "p2");
    broker_registration(story.b, &r, story.now_ns);
    entry_of(&r)->name = words("blue");
    broker_registration(story.b, &r, story.now_ns);
    story_gone("p-red");
    EXPECT("");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    story_gone("p-blue");
    EXPECT("blue welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("blue"), "blue running p2");
}

/* It asked once more before it heard that it was refused, and says so when it has heard. */
static void test_a_claim_is_taken_back(void)
{
    story_begin();
    story_join("red");
    story_match("p2");
    (void)story_collect();
    story_register("red", "p2");
    story_tick(1500 * MS);
    story_register("red", "p2");
    EXPECT("red: held by another participant");
    story_leave("red", "p2");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
    story_gone("p-red");
    EXPECT("");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    story_register("red", "p2");
    EXPECT("red welcome 0");
    story_leave("red", "p2"); /* the same, but it had been granted meanwhile */
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p2");
}

/* A refusal that has not gone out is not to come after the welcome. */
static void test_a_refusal_that_is_void_is_not_told(void)
{
    story_begin();
    story_join("red");
    story_register("red", "p-late");
    story_tick(2000 * MS); /* refused; its process has not matched yet */
    story_gone("p-red");
    story_register("red", "p-late");
    story_match("p-late");
    EXPECT("red welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-late");
}

/* A newcomer waits for the name already when its holder sets out and lets go of it. */
static void test_who_moves_keeps_its_name(void)
{
    story_begin();
    story_join("red");
    story_match("p1");
    story_match("p2");
    (void)story_collect();
    register_epoch("p1", 0);
    register_epoch("p-red", 1);
    register_epoch("p2", 1); /* the platform that it goes to */
    EXPECT("");
    story_leave("red", "p-red");
    EXPECT("red welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p2");
    story_tick(1500 * MS);
    EXPECT("red: held by another participant");
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 0);
}

static void register_since(const char *process, uint64_t since_wall_ns, bool newcomer)
{
    muster_Registration r = registration("red", process);
    entry_of(&r)->since_wall_ns = since_wall_ns;
    entry_of(&r)->newcomer = newcomer;
    broker_registration(story.b, &r, story.now_ns);
}

/* The broker has died, and knows nobody: a newcomer is faster than who had the name all along. */
static void test_who_outlived_the_broker_has_its_name_back(void)
{
    for (int since_is_less = 0; since_is_less <= 1; since_is_less++) {
        story_begin();
        story_match("p1");
        story_match("p2");
        (void)story_collect();
        register_since("p2", 200, true);
        EXPECT("red welcome 0");
        story_tick(1000 * MS);
        register_since("p1", since_is_less ? 100 : 300, false);
        if (since_is_less) {
            EXPECT("red: held by another participant; red welcome 0");
            CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p1");
        } else {
            EXPECT("");
            CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p2");
        }
    }
}

/* It was stopped, and another one has taken its place. */
static void test_who_was_away_does_not_have_its_name_back(void)
{
    story_begin();
    story_match("p1");
    story_match("p2");
    story_tick(500 * MS);
    register_since("p1", 100, true);
    story_tick(1000 * MS);
    story_gone("p1");
    register_since("p2", 200, true);
    (void)story_collect();
    register_since("p1", 100, false);
    EXPECT("");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p2");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a held name is refused in the end", test_held_name_is_refused_in_the_end},
        {"a copy that is out of date inherits nothing",
         test_a_copy_that_is_out_of_date_inherits_nothing},
        {"a held name is inherited", test_held_name_is_inherited},
        {"a name goes to who asked first", test_a_name_goes_to_who_asked_first},
        {"who waits in the middle gives up", test_who_waits_in_the_middle_gives_up},
        {"an heir keeps the name", test_an_heir_keeps_the_name},
        {"an heir makes older copies void", test_an_heir_makes_older_copies_void},
        {"claims have a limit", test_claims_have_a_limit},
        {"a claim is given up", test_claim_is_given_up},
        {"a claim ends when its slot bears another name",
         test_a_claim_ends_when_its_slot_bears_another_name},
        {"a claim is taken back", test_a_claim_is_taken_back},
        {"a refusal that is void is not told", test_a_refusal_that_is_void_is_not_told},
        {"who moves keeps its name", test_who_moves_keeps_its_name},
        {"who outlived the broker has its name back",
         test_who_outlived_the_broker_has_its_name_back},
        {"who was away does not have its name back", test_who_was_away_does_not_have_its_name_back},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/claims", tests);
}
