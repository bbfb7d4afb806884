/* SPDX-License-Identifier: Apache-2.0 */
/* A lock step, and who is outside: mail that waits for the end of a step, and mail that does not;
 * mail of a recording. */
#include "disk_story.h"
#include "lockstep_story.h"

/* green in lock step from step 0 on; red, blue and the operator outside */
static void run_begin(void)
{
    team();
    story_join("green");
    story_join("blue");
    story_join("operator");
    story_match("sim");
    roster_say(true, 0, "p-green");
    CU_ASSERT_TRUE(commit(true));
    (void)story_collect();
}

static void send_as(const char *src, uint64_t seq, const char *dst, muster_Level at, bool again)
{
    muster_Mail m = letter(src, seq, dst, "m");
    m.level = at;
    m.again = again;
    story_mail(m);
}

static void replay(uint64_t seq, int64_t due_ns)
{
    struct one_up u;
    muster_Mail m = letter("operator", seq, "green", "replayed");
    m.due_ns = due_ns;
    one_up(&u, "operator", "p-operator", &m, 1, 0);
    u.act.replays = true;
    story_hear(&u.up);
}

static void test_mail_to_one_does_not_overtake_mail_to_many(void)
{
    run_begin();
    story_send("operator", 1, "all", "one");
    story_send("operator", 2, "blue", "two");
    EXPECT("");
    answer("green", 0);
    EXPECT("blue #1 operator/1 one; blue #2 operator/2 two; p-green@0; green #1 operator/1 one; "
           "red #1 operator/1 one; sim@0; outside operator/1; outside operator/2");
}

static void test_others_do_not_wait_for_it(void)
{
    run_begin();
    story_send("operator", 1, "all", "one");
    story_send("blue", 1, "red", "two");
    EXPECT("red #1 blue/1 two");
    story_send("operator", 2, "green", "three");
    answer("green", 0);
    (void)story_collect();
    story_send("operator", 3, "blue", "four");
    EXPECT("blue #2 operator/3 four");
}

/* The store takes with durable mail what its sender has sent before. */
static void test_durable_mail_waits_for_what_was_sent_before(void)
{
    run_begin();
    send_as("operator", 1, "green", muster_LEVEL_RAM, false);
    send_as("operator", 2, "blue", muster_LEVEL_LOGGED, false);
    (void)commit(true);
    (void)story_collect();
    die_and_come_back(SECOND); /* before the step ends */
    story_join("operator");
    story_join("green");
    send_as("operator", 1, "green", muster_LEVEL_RAM, true);
    EXPECT("green #1 operator/1 m");
}

static void test_mail_does_not_overtake_durable_mail_that_waits(void)
{
    run_begin();
    send_as("operator", 1, "green", muster_LEVEL_RAM, false);
    send_as("operator", 2, "blue", muster_LEVEL_LOGGED, false);
    send_as("operator", 3, "blue", muster_LEVEL_RAM, false);
    answer("green", 0);
    (void)commit(true);
    const char *heard = story_collect();
    CU_ASSERT_PTR_NOT_NULL(strstr(heard, "blue #1 operator/2 m; blue #2 operator/3 m"));
}

/* red is to come back in another process, and does not: nobody waits for it any more. */
static void test_a_robot_outside_a_lock_step_that_was_held(void)
{
    run_begin();
    roster_say(true, 0, "p-green p-red");
    (void)story_collect();
    story_gone("p-red");
    is_held = true;
    roster_say(true, 0, "p-green");
    is_held = false;
    (void)story_collect();
    muster_Registration r = registration("robo", "p-robo");
    entry_of(&r)->kind = muster_KIND_ROBOT;
    broker_registration(story.b, &r, story.now_ns);
    story_match("p-robo");
    (void)story_collect();
    story_send("operator", 1, "robo", "hello");
    EXPECT("");
    roster_say(true, 0, "p-green");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "robo #1 operator/1 hello"));
}

static void test_a_recording_ends_with_its_run(void)
{
    run_begin();
    replay(1, 200 * MS);
    EXPECT("operator 1-1 stored");
    answer("green", 0);
    (void)story_collect();
    roster_say(false, 1, "");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "operator 1-1 dropped"));
    CU_ASSERT_EQUAL(story.b->pool.mails, 0);
    CU_ASSERT_EQUAL(story.b->replays.count, 0);
}

static void test_limit_a_recording(void)
{
    run_begin();
    for (uint64_t i = 1; i <= QUOTA_MAILS_MAX; i++) {
        replay(i, (int64_t)i * 1000000000);
        (void)story_collect();
    }
    replay(QUOTA_MAILS_MAX + 1, 200 * MS);
    EXPECT("operator 98305-98305 box-full");
    roster_say(false, 1, "");
    CU_ASSERT_EQUAL(story.b->pool.mails, 0);
}

static void test_mail_follows_who_leaves_the_lock_step(void)
{
    run_begin();
    roster_say(true, 0, "p-green p-blue");
    (void)story_collect();
    story_send("operator", 1, "blue", "one");
    roster_say(true, 0, "p-green");
    story_send("operator", 2, "blue", "two");
    story_send("red", 1, "blue", "other");
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "operator/2"));
    answer("green", 0);
    const char *heard = story_collect();
    const char *one = strstr(heard, "operator/1 one"), *two = strstr(heard, "operator/2 two");
    CU_ASSERT_TRUE(one && two && one < two);
    story_send("operator", 3, "blue", "three");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "operator/3 three"));
}

/* @return how many mails from outside the simulator is told of now, in order of (sender, number) */
static uint32_t outside_in_order(void)
{
    char last[MU_NAME_MAX + 1] = "";
    uint64_t last_seq = 0;
    uint32_t told = 0;
    const char *process;
    muster_Delivery d;
    while (broker_next(story.b, &process, &d)) {
        for (uint32_t i = 0; i < d.outside._length; i++) {
            const muster_Mail *m = &d.outside._buffer[i];
            int order = strcmp(last, m->src);
            CU_ASSERT_TRUE(order < 0 || (order == 0 && last_seq < m->seq));
            (void)mu_text_copy(last, sizeof last, m->src);
            last_seq = m->seq;
        }
        told += d.outside._length;
        broker_delivered(story.b, story.now_ns);
    }
    return told;
}

/* As much as a step takes, and more. */
static void test_the_order_of_mail_from_outside(void)
{
    for (uint64_t many = 600; many <= 2400; many *= 2) {
        run_begin();
        for (uint64_t i = 1; i <= many; i++) {
            story_send("operator", i, "green", "m");
        }
        story_send("red", 1, "green", "m");
        (void)story_collect();
        answer("green", 0);
        uint64_t most = many + 1 < STEPS_OUTSIDE_MAX ? many + 1 : STEPS_OUTSIDE_MAX;
        CU_ASSERT_EQUAL(outside_in_order(), most);
    }
}

/* green was in the run before this one. */
static void test_who_has_left_an_earlier_run(void)
{
    run_begin();
    roster_say(false, 0, "");
    roster_say(true, 0, "p-blue");
    (void)story_collect();
    story_send("operator", 1, "blue", "one");
    story_send("operator", 2, "green", "two");
    EXPECT("green #1 operator/2 two");
}

/* So much of operator waits that each step is full of it; red has a mail now and then. */
static void test_limit_who_comes_first_by_name(void)
{
    uint64_t seq = 0;
    run_begin();
    for (int i = 0; i < 2 * STEPS_OUTSIDE_MAX; i++) {
        story_send("operator", ++seq, "green", "m");
    }
    story_send("red", 1, "green", "mine");
    (void)story_collect();
    answer("green", 0);
    uint32_t told = 0;
    bool has_red = false;
    const char *process;
    muster_Delivery d;
    while (broker_next(story.b, &process, &d)) {
        for (uint32_t i = 0; i < d.outside._length; i++) {
            has_red = has_red || strcmp(d.outside._buffer[i].src, "red") == 0;
        }
        told += d.outside._length;
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_TRUE(has_red);
    CU_ASSERT_EQUAL(told, STEPS_OUTSIDE_MAX);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"mail to many first", test_mail_to_one_does_not_overtake_mail_to_many},
        {"others do not wait", test_others_do_not_wait_for_it},
        {"durable mail waits", test_durable_mail_waits_for_what_was_sent_before},
        {"durable mail that waits", test_mail_does_not_overtake_durable_mail_that_waits},
        {"a lock step that was held", test_a_robot_outside_a_lock_step_that_was_held},
        {"a recording ends", test_a_recording_ends_with_its_run},
        {"limit: a recording", test_limit_a_recording},
        {"mail follows who leaves", test_mail_follows_who_leaves_the_lock_step},
        {"the order of mail from outside", test_the_order_of_mail_from_outside},
        {"who has left an earlier run", test_who_has_left_an_earlier_run},
        {"limit: who comes first by name", test_limit_who_comes_first_by_name},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/outside", tests);
}
