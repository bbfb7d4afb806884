/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "broker_story.h"
#include "bus/check.h"
#include "bus/check_fields.h"

#define X10 "xxxxxxxxxx"

static void team(void)
{
    story_begin();
    story_join("blue");
    story_join("green");
    story_join("red");
    (void)story_collect();
}

static void test_mail_by_name_and_its_receipt(void)
{
    team();
    story_send("red", 1, "green", "hello");
    story_send("red", 2, "green", "again");
    EXPECT("green #1 red/1 hello; green #2 red/2 again");
    CU_ASSERT_EQUAL(story_status().waiting, 2);
    story_ack("green", 2);
    EXPECT("red 1-2 delivered");
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL(s.sent, 2);
    CU_ASSERT_EQUAL(s.delivered, 2);
    CU_ASSERT_EQUAL(s.waiting, 0);
    story_send("red", 3, "nobody", "hello");
    EXPECT("red 3-3 unknown-name");
    story_send("red", 4, "red", "a note to myself");
    EXPECT("red #1 red/4 a note to myself");
}

static void test_lists_of_names(void)
{
    team();
    story_send("red", 1, "green,blue,green", "hello");
    EXPECT("green #1 red/1 hello; blue #1 red/1 hello");
    story_ack("green", 1);
    EXPECT("");
    story_ack("blue", 1);
    EXPECT("red 1-1 delivered");
    story_send("red", 2, "green,nobody", "hello"); /* the bad news at once, the mail all the same */
    EXPECT("green #2 red/2 hello; red 2-2 unknown-name");
    story_ack("green", 2);
    EXPECT("");
    CU_ASSERT_EQUAL(story_status().sent, 4);
    CU_ASSERT_EQUAL(story_status().unknown_name, 1);
}

static void test_broadcast_reaches_who_is_there(void)
{
    team();
    story_join("operator");
    story_join("grey");
    story_state("blue", muster_STATE_SUSPENDED);
    story_gone("p-grey");
    (void)story_collect();
    story_send("red", 1, "all", "hi");
    EXPECT("green #1 red/1 hi; operator #1 red/1 hi; red 1-1 stored");
    story_state("blue", muster_STATE_RUNNING);
    EXPECT("blue #1 red/1 hi");
    story_register("grey", "p-grey");
    EXPECT("grey welcome 0"); /* it was absent then */
    story_send("red", 2, "special", "hi");
    EXPECT("operator #2 red/2 hi");
    story_send("operator", 1, "robots", "go");
    EXPECT("blue #2 operator/1 go; green #2 operator/1 go; grey #1 operator/1 go; "
           "red #1 operator/1 go");
    story_send("operator", 2, "special", "nobody else is special");
    EXPECT("operator 2-2 delivered");
}

/* Mail to all passes it by; its name, its kind and directives find it. */
static void test_who_wants_no_broadcasts(void)
{
    team();
    story_join("operator");
    story_look_on("ada", "p-ada");
    (void)story_collect();
    story_send("red", 1, "all", "hi");
    EXPECT("blue #1 red/1 hi; green #1 red/1 hi; operator #1 red/1 hi");
    story_send("red", 2, "ada", "hi");
    EXPECT("ada #1 red/2 hi");
    story_send("operator", 1, "robots", "go");
    EXPECT("ada #2 operator/1 go; blue #2 operator/1 go; green #2 operator/1 go; "
           "red #1 operator/1 go");
    muster_Mail stop = letter("operator", 2, "all", "(stop)");
    stop.layer = 0;
    story_mail(stop);
    EXPECT("ada #3 operator/2 (stop); blue #3 operator/2 (stop); green #3 operator/2 (stop); "
           "red #2 operator/2 (stop)");
}

static void test_mail_waits_for_the_absent(void)
{
    team();
    story_gone("p-green");
    (void)story_collect();
    story_send("red", 1, "green", "one");
    story_send("red", 2, "green", "two");
    EXPECT("red 1-2 stored");
    story_register("green", "p-new");
    EXPECT("");
    story_match("p-new");
    EXPECT("green #1 red/1 one; green #2 red/2 two; green welcome 0");
    CU_ASSERT_EQUAL(story.again, 0);
    story_gone("p-new"); /* a crash before it has acknowledged */
    story_register("green", "p-green");
    EXPECT("green #1 red/1 one; green #2 red/2 two; green welcome 0");
    CU_ASSERT_EQUAL(story.again, 2); /* or it was with another broker, and knows them */
    CU_ASSERT_EQUAL(story_status().resent, 2);
    story_ack("green", 2);
    EXPECT("red 1-2 delivered");
}

static void test_moving_and_suspended_wait(void)
{
    team();
    story_state("green", muster_STATE_MOVING);
    story_state("blue", muster_STATE_SUSPENDED);
    story_send("red", 1, "green,blue", "hello");
    EXPECT("red 1-1 stored");
    story_state("green", muster_STATE_STANDBY);
    EXPECT("green #1 red/1 hello");
    story_state("blue", muster_STATE_RUNNING);
    EXPECT("blue #1 red/1 hello");
}

static void test_directives(void)
{
    team();
    story_join("operator");
    (void)story_collect();
    story_mail(directive("red", 1, "green", "(wander)"));
    EXPECT("red 1-1 refused");
    story_mail(directive("red", 2, "all", "(wander)"));
    EXPECT("red 2-2 refused");
    CU_ASSERT_EQUAL(story_status().refused, 4);
    story_state("green", muster_STATE_SUSPENDED);
    story_send("red", 3, "green", "waits");
    EXPECT("red 3-3 stored");
    story_mail(directive("operator", 1, "green", "(wander)"));
    EXPECT("green #1 operator/1 (wander)");
    story_ack("green", 1);
    EXPECT("operator 1-1 delivered");
    story_state("green", muster_STATE_RUNNING);
    EXPECT("green #2 red/3 waits");
}

static void test_directives_pass_a_full_window(void)
{
    team();
    story_join("observer");
    (void)story_collect();
    for (uint64_t i = 1; i <= MU_WINDOW_MAX + 1; i++) {
        story_send("red", i, "green", "m");
    }
    (void)story_collect();
    story_mail(directive("observer", 1, "green", "(wander)"));
    EXPECT("green #201 observer/1 (wander)");
    story_ack("green", 201);
    EXPECT("red 1-200 delivered; observer 1-1 delivered; green #202 red/201 m");
}

static void test_duplicates_are_dropped(void)
{
    team();
    story_send("red", 5, "green", "hello");
    story_send("red", 5, "green", "hello");
    story_send("red", 4, "green", "older");
    EXPECT("green #1 red/5 hello; red 5-5 duplicate; red 4-4 duplicate");
    CU_ASSERT_EQUAL(story_status().duplicates_dropped, 2);
    story_send("red", 9, "green", "a gap is no harm");
    EXPECT("green #2 red/9 a gap is no harm");
}

/* Mails first to last of red for green, from an outbox whose first one is first_seq. */
static void send_from(uint64_t first_seq, uint64_t first, uint64_t last)
{
    muster_Mail mails[8];
    uint32_t count = 0;
    for (uint64_t seq = first; seq <= last; seq++) {
        mails[count++] = letter("red", seq, "green", "m");
    }
    muster_Act act = {.agent = words("red"),
                      .state = muster_STATE_RUNNING,
                      .rules = words(""),
                      .first_seq = first_seq};
    act.mails = (dds_sequence_muster_Mail){._length = count, ._buffer = mails};
    muster_Up up = {.process = words("p-red"), .step = muster_STEP_NOW};
    up.acts = (dds_sequence_muster_Act){._length = 1, ._buffer = &act};
    broker_up(story.b, &up, story.now_ns);
}

/* Mail was sent to an earlier life of the broker, or while it was not heard. */
static void test_mail_after_a_lost_one_waits_for_it(void)
{
    team();
    send_from(7, 9, 10);
    EXPECT("");
    CU_ASSERT_EQUAL(story.b->gaps, 2);
    send_from(7, 7, 8);
    EXPECT("green #1 red/7 m; green #2 red/8 m");
    send_from(7, 10, 10); /* it has the first ones, and their answers are on their way */
    EXPECT("");
    send_from(7, 7, 10);
    EXPECT("red 7-8 duplicate; green #3 red/9 m; green #4 red/10 m");
    send_from(20, 20, 20); /* those between were answered for by another broker */
    EXPECT("green #5 red/20 m");
    CU_ASSERT_EQUAL(story.b->gaps, 3);
}

/* Its sender has heard of another broker what became of it. */
static void test_mail_that_is_over_is_not_taken(void)
{
    team();
    muster_Mail over = letter("red", 8, "", "");
    over.again = true;
    send_from(7, 7, 7);
    EXPECT("green #1 red/7 m");
    story_mail(over);
    send_from(7, 9, 9); /* nothing is missing before it */
    EXPECT("green #2 red/9 m");
    story_mail(over);
    send_from(7, 8, 8);
    EXPECT("red 8-8 duplicate");
    CU_ASSERT_EQUAL(story_status().malformed, 0);
    CU_ASSERT_EQUAL(story_status().sent, 2);
    over.seq = 10;
    over.again = false; /* then it is a mail to nobody */
    story_mail(over);
    EXPECT("red 10-10 refused");
    CU_ASSERT_EQUAL(story_status().malformed, 1);
}

static void test_time_to_live(void)
{
    team();
    story_state("green", muster_STATE_SUSPENDED);
    muster_Mail m = letter("red", 1, "green,blue", "fresh");
    m.ttl_ns = 50 * MS;
    story_mail(m);
    EXPECT("blue #1 red/1 fresh; red 1-1 stored");
    story_ack("blue", 1);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 50 * MS);
    story_tick(50 * MS - 1);
    EXPECT("");
    story_tick(1);
    EXPECT("red 1-1 expired");
    CU_ASSERT_EQUAL(story_status().expired, 1);
    CU_ASSERT_EQUAL(story_status().waiting, 0);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
    story_state("green", muster_STATE_RUNNING);
    EXPECT("");
    m.seq = 2;
    story_mail(m);
    EXPECT("green #1 red/2 fresh; blue #2 red/2 fresh");
    story_tick(60 * MS); /* what was handed out keeps its number, and does not expire */
    story_ack("green", 1);
    story_ack("blue", 2);
    EXPECT("red 2-2 delivered");
}

/* Time passes while a delivery is written, too. */
static void test_what_falls_due_while_a_delivery_is_written(void)
{
    const char *process;
    muster_Delivery d;
    team();
    muster_Roster roster = {.simulator = words("sim"), .step = 1, .step_ns = 100 * MS};
    broker_roster(story.b, &roster, story.now_ns);
    muster_Mail m = letter("red", 1, "green", "brief");
    m.ttl_ns = 10 * MS;
    story_mail(m);
    m = letter("red", 2, "green", "later");
    m.due_ns = (int64_t)(111 * MS);
    story_mail(m);
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    broker_delivered(story.b, story.now_ns + 10 * MS + 1);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), story.now_ns + 10 * MS + 1);
    (void)story_collect();
    story.now_ns += 10 * MS + 1;
    story_tick(0);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), story.now_ns + MS - 1);
    while (broker_next(story.b, &process, &d)) {
        broker_delivered(story.b, story.now_ns + MS);
    }
    broker_tick(story.b, story.now_ns);
    story_send("red", 3, "blue", "on");
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    broker_delivered(story.b, story.now_ns + MS);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), story.now_ns + MS);
}

static void test_due_in_a_free_run(void)
{
    team();
    muster_Mail m = letter("red", 1, "green", "later");
    m.due_ns = (int64_t)(300 * MS);
    story_mail(m);
    EXPECT("red 1-1 stored");
    story_tick(1000 * MS); /* no run has started */
    EXPECT("");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
    muster_Roster roster = {.simulator = words("sim"), .step = 1, .step_ns = 100 * MS};
    broker_roster(story.b, &roster, story.now_ns);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 1200 * MS);
    story_tick(200 * MS - 1);
    EXPECT("");
    story_send("red", 2, "green", "overtakes");
    EXPECT("green #1 red/2 overtakes");
    story_tick(1);
    EXPECT("green #2 red/1 later");
    m.seq = 3; /* due already */
    story_mail(m);
    EXPECT("green #3 red/3 later");
}

static void test_window_and_resending(void)
{
    team();
    for (uint64_t i = 1; i <= MU_WINDOW_MAX + 2; i++) {
        story_send("red", i, "green", "m");
    }
    (void)story_collect();
    CU_ASSERT_EQUAL(story_status().waiting, MU_WINDOW_MAX + 2);
    story_ack("green", 1);
    EXPECT("red 1-1 delivered; green #201 red/201 m");
    story_ack("green", 200);
    EXPECT("red 2-200 delivered; green #202 red/202 m");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 1000 * MS);
    story_tick(999 * MS);
    EXPECT("");
    story_tick(1 * MS);
    EXPECT("green #201 red/201 m; green #202 red/202 m");
    CU_ASSERT_EQUAL(story_status().resent, 2);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 2000 * MS);
    story_ack("green", 201);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 2000 * MS);
    story_ack("green", 202);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
    EXPECT("red 201-202 delivered");
}

static void test_the_reader_comes_back(void)
{
    team();
    story_send("red", 1, "green", "one");
    EXPECT("green #1 red/1 one");
    broker_matched(story.b, "p-green", false, story.now_ns);
    story_send("red", 2, "green", "two");
    story_tick(5000 * MS);
    EXPECT("");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
    story_match("p-green");
    EXPECT("green #1 red/1 one; green #2 red/2 two; green welcome 0");
    CU_ASSERT_EQUAL(story_status().resent, 1);
    CU_ASSERT_EQUAL(story.members, MU_BROKER_LINES + 3); /* the whole white pages again */
}

static void test_the_network_refuses(void)
{
    const char *process;
    muster_Delivery d;
    team();
    story_send("red", 1, "green", "one");
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    CU_ASSERT_EQUAL(d.parcels._length, 1);
    broker_undelivered(story.b);
    CU_ASSERT_FALSE(broker_next(story.b, &process, &d));
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 1 * MS);
    story_tick(1 * MS - 1);
    EXPECT("");                                   /* not before */
    story_state("green", muster_STATE_SUSPENDED); /* it never went out: it waits again */
    story_tick(1);
    EXPECT("");
    story_state("green", muster_STATE_RUNNING);
    EXPECT("green #1 red/1 one");
    CU_ASSERT_EQUAL(story_status().resent, 0);
}

static void test_acknowledgements_that_cannot_be(void)
{
    team();
    story_send("red", 1, "green", "one");
    (void)story_collect();
    story_ack("green", 2); /* never handed out */
    CU_ASSERT_EQUAL(story_status().malformed, 1);
    muster_Ack ack = {.box = words("green"), .number = 1};
    muster_Up up = {.process = words("p-red"), .step = muster_STEP_NOW};
    up.acks = (dds_sequence_muster_Ack){._length = 1, ._buffer = &ack};
    story_hear(&up); /* another one's box */
    CU_ASSERT_EQUAL(story_status().malformed, 2);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
    story_ack("green", 1);
    story_ack("green", 1);
    CU_ASSERT_EQUAL(story_status().malformed, 2);
    CU_ASSERT_EQUAL(story_status().delivered, 1);
}

/* Boxes of an earlier life had mail of the same numbers, and nobody may have had this life's. */
static void test_acknowledgements_of_another_life(void)
{
    team();
    story_send("red", 1, "green", "one");
    EXPECT("green #1 red/1 one");
    muster_Mail m = letter("green", 1, "blue", "two");
    struct one_up u;
    one_up(&u, "green", "p-green", &m, 1, 1);
    u.up.broker_incarnation = story.b->incarnation - 1;
    broker_up(story.b, &u.up, story.now_ns);
    EXPECT("blue #1 green/1 two"); /* the mail is for whoever reads it */
    CU_ASSERT_EQUAL(story.b->astray, 1);
    CU_ASSERT_EQUAL(story_status().malformed, 0);
    CU_ASSERT_EQUAL(story_status().delivered, 0);
    CU_ASSERT_EQUAL(story_status().waiting, 2);
    story_ack("green", 1);
    EXPECT("red 1-1 delivered");
    CU_ASSERT_EQUAL(story.b->astray, 1);
}

static void test_malformed_mails(void)
{
    static char much[MU_CONTENT_MAX + 2];
    memset(much, 'x', sizeof much - 1);
    team();
    muster_Mail bad[11];
    for (uint64_t i = 0; i < 11; i++) {
        bad[i] = letter("red", i + 1, "green", "x");
    }
    bad[0].dst = words("");
    bad[1].dst = words("green,");
    bad[2].dst = words("green,all");
    bad[3].dst = words("two words");
    bad[4].dst = words(",green");
    bad[5].dst = words("a-name-of-more-than-31-characters");
    bad[6].dst = NULL;
    bad[7].content = much;
    bad[8].content = NULL;
    bad[9].performative = words(X10 X10 X10 X10 X10 X10 X10);
    bad[10].conversation = NULL;
    for (uint32_t i = 0; i < 6; i++) {
        story_mail(bad[i]);
        CU_ASSERT_EQUAL(story_status().malformed, i + 1);
    }
    EXPECT("red 1-6 refused");
    for (uint32_t i = 6; i < 11; i++) { /* at the border */
        CU_ASSERT_FALSE(check_mails(&bad[i], 1));
    }
    muster_Mail forged = letter("blue", 1, "green", "x"); /* red's process, in blue's name */
    story_up("red", muster_STEP_NOW, muster_STATE_RUNNING, &forged, 1, 0);
    CU_ASSERT_EQUAL(story_status().malformed, 7);
    story_send("nobody", 1, "green", "x");
    CU_ASSERT_EQUAL(story_status().malformed, 8);
    EXPECT("");
    much[MU_CONTENT_MAX] = '\0';
    story_send("red", 20, "green", much);
    CU_ASSERT_TRUE(strlen(story_collect()) > MU_CONTENT_MAX);
    CU_ASSERT_EQUAL(story_status().malformed, 8);
    CU_ASSERT_EQUAL(story_status().sent, 1);
}

static void test_malformed_samples(void)
{
    team();
    muster_Act act = {.agent = NULL, .rules = words("")};
    muster_Up up = {.process = words("p-red"), .step = muster_STEP_NOW};
    up.acts = (dds_sequence_muster_Act){._length = 1, ._buffer = &act};
    CU_ASSERT_FALSE(check_up(&up));
    act.agent = words("red");
    act.state = (muster_State)9;
    broker_up(story.b, &up, 0);
    up.acts = (dds_sequence_muster_Act){._length = 1000000, ._buffer = &act};
    CU_ASSERT_FALSE(check_up(&up));
    up = (muster_Up){.process = NULL};
    CU_ASSERT_FALSE(check_up(&up));
    up = (muster_Up){.process = words("p-nobody")};
    broker_up(story.b, &up, 0);
    muster_Roster roster = {.simulator = words("sim"), .lockstep = true, .step = -1, .step_ns = 1};
    broker_roster(story.b, &roster, 0);
    roster.step = INT64_MAX;
    broker_roster(story.b, &roster, 0);
    CU_ASSERT_EQUAL(story_status().malformed, 4);
    EXPECT("");
}

static void test_a_sender_that_has_left_is_told_nothing(void)
{
    team();
    story_send("red", 1, "green", "bye");
    story_leave("red", "p-red");
    EXPECT("green #1 red/1 bye");
    story_ack("green", 1);
    story_register("red", "p-red");
    EXPECT("red welcome 1");
}

/* Nothing is heard of the sender for so long, while its mail is acknowledged. */
static void sender_silent(uint64_t silent_ns)
{
    team();
    story_send("red", 1, "green", "one");
    story_gone("p-red");
    EXPECT("green #1 red/1 one");
    story_ack("green", 1);
    story.now_ns += silent_ns;
    broker_tick(story.b, story.now_ns);
    story_register("red", "p-red");
}

static void test_a_sender_that_was_silent_is_told_what_it_has_missed(void)
{
    sender_silent(9999999999u);
    EXPECT("red 1-1 delivered; red welcome 1");
    sender_silent(10000000000u);
    EXPECT("red welcome 1");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"mail by name, and its receipt", test_mail_by_name_and_its_receipt},
        {"lists of names", test_lists_of_names},
        {"a broadcast reaches who is there", test_broadcast_reaches_who_is_there},
        {"who wants no broadcasts", test_who_wants_no_broadcasts},
        {"mail waits for the absent", test_mail_waits_for_the_absent},
        {"moving and suspended agents wait", test_moving_and_suspended_wait},
        {"directives", test_directives},
        {"directives pass a full window", test_directives_pass_a_full_window},
        {"duplicates are dropped", test_duplicates_are_dropped},
        {"mail after a lost one waits for it", test_mail_after_a_lost_one_waits_for_it},
        {"mail that is over is not taken", test_mail_that_is_over_is_not_taken},
        {"time to live", test_time_to_live},
        {"what falls due while a delivery is written",
         test_what_falls_due_while_a_delivery_is_written},
        {"due in a free run", test_due_in_a_free_run},
        {"window and resending", test_window_and_resending},
        {"the reader comes back", test_the_reader_comes_back},
        {"the network refuses", test_the_network_refuses},
        {"acknowledgements that cannot be", test_acknowledgements_that_cannot_be},
        {"acknowledgements of another life", test_acknowledgements_of_another_life},
        {"malformed mails", test_malformed_mails},
        {"malformed samples", test_malformed_samples},
        {"a sender that has left is told nothing", test_a_sender_that_has_left_is_told_nothing},
        {"a sender that was silent is told what it has missed",
         test_a_sender_that_was_silent_is_told_what_it_has_missed},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/mail", tests);
}
