/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes: priorities, limits and what happens at them, fair shares, time to live. */
#include "broker/control/parts.h"
#include "broker_story.h"

static uint64_t seqs[26]; /* of each agent, by its first letter */

static void team(void)
{
    memset(seqs, 0, sizeof seqs);
    story_begin();
    story_join("blue");
    story_join("green");
    story_join("red");
    story_join("operator");
    story_state("green", muster_STATE_SUSPENDED);
    (void)story_collect();
}

static void limit(const char *name, muster_BoxPolicy policy, uint32_t mails, uint32_t bytes)
{
    mailbox_box(&story.b->mailbox, registry_find(&story.b->registry, name))->limits =
        (struct box_limits){.policy = policy, .mails = mails, .bytes = bytes};
}

static muster_Mail next_letter(const char *src, const char *dst, const char *content)
{
    return letter(src, ++seqs[src[0] - 'a'], dst, content);
}

static void say(const char *src, const char *content, int32_t priority)
{
    muster_Mail m = next_letter(src, "green", content);
    m.priority = priority;
    story_mail(m);
}

static void direct(const char *dst)
{
    muster_Mail m = next_letter("operator", dst, "(stop)");
    m.layer = 0;
    story_mail(m);
}

static void test_a_higher_priority_overtakes(void)
{
    team();
    say("red", "low", -1);
    say("red", "one", 0);
    say("red", "two", 0);
    say("red", "high", 1);
    say("blue", "lower", -1);
    say("blue", "higher", 1);
    direct("green");
    EXPECT("green #1 operator/1 (stop); red 1-4 stored; blue 1-2 stored");
    story_state("green", muster_STATE_RUNNING);
    EXPECT("green #2 red/4 high; green #3 blue/2 higher; green #4 red/2 one; green #5 red/3 two; "
           "green #6 red/1 low; green #7 blue/1 lower");
    say("red", "late but high", 1); /* nothing overtakes what is in flight */
    EXPECT("green #8 red/5 late but high");
}

static void test_what_the_network_refused_keeps_its_order(void)
{
    const char *process;
    muster_Delivery d;
    team();
    say("red", "low", -1);
    say("red", "one", 0);
    say("red", "two", 0);
    (void)story_collect();
    story_state("green", muster_STATE_RUNNING);
    do {
        CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
        if (strcmp(process, "p-green") != 0) {
            broker_delivered(story.b, 0);
        }
    } while (strcmp(process, "p-green") != 0);
    CU_ASSERT_EQUAL(d.parcels._length, 3);
    broker_undelivered(story.b);
    say("blue", "high", 1);
    story_tick(1 * MS);
    EXPECT("green #1 blue/1 high; green #2 red/2 one; green #3 red/3 two; green #4 red/1 low");
}

static void test_a_full_box_refuses(void)
{
    team();
    limit("green", muster_BOX_REFUSE_NEW, 4, 0);
    say("red", "one", 0);
    say("red", "two", 0);
    say("blue", "three", 0);
    say("operator", "four", 0);
    (void)story_collect();
    say("red", "five", 1);
    say("blue", "six", 0);
    story_send("green", ++seqs[6], "green", "a first mail, and no room");
    EXPECT("red 3-3 box-full; blue 2-2 box-full; green 1-1 box-full");
    CU_ASSERT_EQUAL(story_status().over_share, 0); /* all of so small a box is within a share */
    CU_ASSERT_EQUAL(story_status().box_full, 3);
    CU_ASSERT_EQUAL(story_status().waiting, 4);
    story_state("green", muster_STATE_RUNNING);
    EXPECT("green #1 red/1 one; green #2 red/2 two; green #3 blue/1 three; "
           "green #4 operator/1 four");
    story_ack("green", 2);
    EXPECT("red 1-2 delivered");
    say("red", "seven", 0);
    EXPECT("green #5 red/4 seven");
}

static void test_a_small_box_holds_what_it_says(void)
{
    static const uint32_t mails[] = {1, 3, 64};
    for (size_t i = 0; i < sizeof mails / sizeof mails[0]; i++) {
        team();
        limit("green", muster_BOX_REFUSE_NEW, mails[i], 0);
        for (uint32_t k = 0; k <= mails[i]; k++) {
            say("red", "of one sender", 0);
        }
        CU_ASSERT_EQUAL(story_status().waiting, mails[i]);
        CU_ASSERT_EQUAL(story_status().over_share, 1);
    }
}

static void test_a_full_box_drops_the_oldest(void)
{
    team();
    limit("green", muster_BOX_DROP_OLDEST, 4, 0);
    say("red", "one", 1);
    say("red", "two", -1);
    say("blue", "three", 0);
    say("operator", "four", 0);
    (void)story_collect();
    story_send("green", ++seqs[6], "green", "five");
    EXPECT("red 1-1 dropped; green 1-1 stored"); /* whatever its priority */
    CU_ASSERT_EQUAL(story_status().dropped, 1);
    CU_ASSERT_EQUAL(story_status().waiting, 4);
    story_state("green", muster_STATE_RUNNING);
    EXPECT("green #1 blue/1 three; green #2 operator/1 four; green #3 green/1 five; "
           "green #4 red/2 two");
    story_send("green", ++seqs[6], "green", "what is in flight is not dropped");
    EXPECT("green 2-2 box-full");
}

static void test_a_full_box_drops_the_lowest(void)
{
    team();
    limit("green", muster_BOX_DROP_LOWEST, 3, 0);
    say("red", "normal", 0);
    say("blue", "high", 1);
    say("operator", "another", 0);
    (void)story_collect();
    muster_Mail low = next_letter("green", "green", "low");
    low.priority = -1;
    story_mail(low);
    EXPECT("green 1-1 box-full"); /* it is the lowest itself */
    story_send("green", ++seqs[6], "green", "as low as others");
    EXPECT("red 1-1 dropped; green 2-2 stored");
    CU_ASSERT_EQUAL(story_status().dropped, 1);
    CU_ASSERT_EQUAL(story_status().box_full, 1);
    story_state("green", muster_STATE_RUNNING);
    EXPECT("green #1 blue/1 high; green #2 operator/1 another; green #3 green/2 as low as others");
}

/* Where mail is dropped, who is over its share pays with its own. */
static void test_a_flood_drops_its_own(void)
{
    team();
    limit("green", muster_BOX_DROP_OLDEST, 200, 0);
    say("blue", "the oldest of all", 0);
    for (int i = 0; i < 110; i++) {
        say("red", "flood", 0);
    }
    (void)story_collect();
    CU_ASSERT_EQUAL(story_status().over_share, 0);
    CU_ASSERT_EQUAL(story_status().dropped, 11);
    CU_ASSERT_EQUAL(story_status().waiting, 100);
    story_state("green", muster_STATE_RUNNING);
    static const char want[] = "green #1 blue/1 the oldest of all; green #2 red/12 flood; ";
    CU_ASSERT_NSTRING_EQUAL(story_collect(), want, sizeof want - 1);
}

static void test_a_box_counts_bytes(void)
{
    static char big[1001];
    memset(big, 'x', sizeof big - 1);
    team();
    limit("green", muster_BOX_DROP_OLDEST, 0, 4096);
    say("red", big, 0);
    say("blue", "small", 0);
    say("operator", "small", 0);
    EXPECT("red 1-1 stored; blue 1-1 stored; operator 1-1 stored");
    muster_Mail m = next_letter("green", "green", big);
    story_mail(m);
    EXPECT("green 1-1 stored");
    m = next_letter("green", "green", big); /* over its share: its own goes */
    story_mail(m);
    EXPECT("green 1-1 dropped; green 2-2 stored");
    static char huge[5001];
    memset(huge, 'x', sizeof huge - 1);
    say("blue", huge, 0); /* nothing is dropped in vain */
    EXPECT("blue 2-2 box-full");
    CU_ASSERT_EQUAL(story_status().dropped, 1);
}

static void test_the_brokers_defaults(void)
{
    team();
    story.b->mailbox.limits.policy = muster_BOX_DROP_OLDEST;
    story.b->mailbox.limits.mails = 2;
    say("red", "one", 0);
    say("blue", "two", 0);
    say("operator", "three", 0);
    EXPECT("red 1-1 stored; red 1-1 dropped; blue 1-1 stored; operator 1-1 stored");
    limit("green", muster_BOX_DROP_LOWEST, 0, 0);
    struct box *box = mailbox_box(&story.b->mailbox, registry_find(&story.b->registry, "green"));
    struct box_limits limits = mailbox_limits(&story.b->mailbox, box);
    CU_ASSERT_EQUAL(limits.policy, muster_BOX_DROP_LOWEST);
    CU_ASSERT_EQUAL(limits.mails, 2);
    CU_ASSERT_EQUAL(limits.bytes, MU_BOX_BYTES_MAX);
    limit("green", muster_BOX_REFUSE_NEW, UINT32_MAX, UINT32_MAX);
    limits = mailbox_limits(&story.b->mailbox, box);
    CU_ASSERT_EQUAL(limits.policy, muster_BOX_DROP_OLDEST);
    CU_ASSERT_EQUAL(limits.mails, MU_BOX_MAX);
    CU_ASSERT_EQUAL(limits.bytes, MU_BOX_BYTES_MAX);
}

static void test_limit_directives_in_a_full_box(void)
{
    team();
    story_state("green", muster_STATE_MOVING); /* not even directives reach it */
    limit("green", muster_BOX_REFUSE_NEW, 2, 0);
    say("red", "one", 0);
    say("blue", "two", 0);
    (void)story_collect();
    for (int i = 0; i < MAILBOX_RESERVE; i++) {
        direct("green");
    }
    EXPECT("operator 1-8 stored");
    direct("green");
    EXPECT("operator 9-9 box-full");
    CU_ASSERT_EQUAL(story_status().waiting, 2 + MAILBOX_RESERVE);
}

static void test_a_flood_leaves_room_for_others(void)
{
    team();
    limit("green", muster_BOX_REFUSE_NEW, 1000, 0);
    for (int i = 0; i < 2000; i++) {
        say("red", "flood", 0);
    }
    for (int i = 0; i < 250; i++) {
        say("blue", "steady", 0);
    }
    EXPECT("red 1-500 stored; red 501-2000 box-full; blue 1-250 stored");
    say("blue", "over", 0);
    EXPECT("blue 251-251 box-full");
    say("blue", "and over", 0);
    EXPECT(""); /* it presses: it is told a little later */
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 100 * MS);
    story_tick(100 * MS);
    EXPECT("blue 252-252 box-full");
    for (int i = 0; i < 125; i++) { /* two thirds are taken: it gets what is left over */
        say("operator", "third", 0);
    }
    EXPECT("operator 1-125 stored");
    CU_ASSERT_EQUAL(story_status().over_share, 1502);
    CU_ASSERT_EQUAL(story_status().box_full, 0);
}

/* Bad news comes at once, then at a measured pace. */
static void test_who_presses_is_slowed_down(void)
{
    team();
    limit("green", muster_BOX_REFUSE_NEW, 1, 0);
    story_state("blue", muster_STATE_SUSPENDED);
    say("red", "one", 0);
    say("red", "over", 0);
    EXPECT("red 1-1 stored; red 2-2 box-full");
    story_tick(10 * MS);
    say("red", "again", 0);
    say("red", "and again", 0);
    EXPECT("");
    story_send("blue", ++seqs['b' - 'a'], "blue", "somebody else");
    EXPECT("blue 1-1 stored");
    story_tick(90 * MS);
    EXPECT("red 3-4 box-full");
    say("red", "still", 0);
    EXPECT("");
    story_send("red", ++seqs['r' - 'a'], "red", "hello"); /* what there is to tell goes with it */
    EXPECT("red #1 red/6 hello; red 5-5 box-full");
    story_tick(100 * MS);
    EXPECT("");
    say("red", "after a while", 0);
    EXPECT("");
    story_tick(100 * MS);
    EXPECT("red 7-7 box-full");
    story_tick(100 * MS);
    say("red", "quiet again", 0);
    EXPECT("red 8-8 box-full");
}

/* Who asks the broker much uses up its own share, not the broker's. */
static void test_answers_are_paid_for_by_who_asks(void)
{
    team();
    limit("red", muster_BOX_REFUSE_NEW, 20, 0);
    story_state("red", muster_STATE_SUSPENDED);
    for (int i = 0; i < 30; i++) {
        muster_Mail m = next_letter("red", "broker", "blue");
        m.layer = 2;
        m.performative = words("lookup");
        story_mail(m);
    }
    CU_ASSERT_EQUAL(story_status().waiting, 20);
    CU_ASSERT_EQUAL(story_status().over_share, 10);
    uint32_t red = registry_find(&story.b->registry, "red");
    CU_ASSERT_EQUAL(story.b->quotas.senders[QUOTA_OUTSIDE][red].mails, 20);
    CU_ASSERT_EQUAL(story.b->quotas.senders[QUOTA_OUTSIDE][REGISTRY_BROKER].mails, 0);
}

/* One record for all receivers, one answer: the worst that happened to any. */
static void test_receivers_that_differ(void)
{
    team();
    story_state("blue", muster_STATE_SUSPENDED);
    limit("green", muster_BOX_DROP_OLDEST, 1, 0);
    limit("blue", muster_BOX_REFUSE_NEW, 1, 0);
    (void)story_collect();
    muster_Mail m = next_letter("red", "blue,green,red", "one");
    m.ttl_ns = 50 * MS;
    story_mail(m);
    EXPECT("red #1 red/1 one; red 1-1 stored");
    CU_ASSERT_EQUAL(story.b->pool.mails, 1);
    story_ack("red", 1);
    EXPECT("");
    story_send("operator", ++seqs['o' - 'a'], "blue,green", "two"); /* room in green's box alone */
    EXPECT("operator 1-1 box-full");
    story_tick(50 * MS); /* dropped at green, expired at blue, delivered to red */
    EXPECT("red 1-1 dropped");
    CU_ASSERT_EQUAL(story_status().expired, 1);
    CU_ASSERT_EQUAL(story_status().dropped, 1);
    CU_ASSERT_EQUAL(story_status().delivered, 1);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
    CU_ASSERT_EQUAL(story.b->pool.mails, 1);
    story_state("green", muster_STATE_RUNNING);
    story_state("blue", muster_STATE_RUNNING);
    EXPECT("green #1 operator/1 two");
    story_ack("green", 1);
    EXPECT(""); /* it was told the worst already */
    CU_ASSERT_EQUAL(story.b->pool.mails, 0);
}

static void test_broadcasts_have_priorities(void)
{
    team();
    story_state("blue", muster_STATE_SUSPENDED);
    (void)story_collect();
    story_send("red", ++seqs['r' - 'a'], "all", "normal");
    muster_Mail m = next_letter("red", "all", "high");
    m.priority = 1;
    story_mail(m);
    (void)story_collect();
    story_state("blue", muster_STATE_RUNNING);
    story_state("green", muster_STATE_RUNNING);
    EXPECT("blue #1 red/2 high; blue #2 red/1 normal; green #1 red/2 high; green #2 red/1 normal");
}

/* Whatever it waits for, it does not wait longer than it lives. */
static void test_every_wait_ends(void)
{
    team();
    story_state("blue", muster_STATE_MOVING);
    story_join("grey");
    story_gone("p-grey");
    (void)story_collect();
    muster_Mail m = next_letter("red", "green,blue,grey", "suspended, moving, absent");
    m.ttl_ns = 50 * MS;
    story_mail(m);
    muster_Mail held = next_letter("red", "operator", "held");
    held.ttl_ns = 50 * MS;
    held.due_ns = (int64_t)(900 * MS);
    story_mail(held);
    EXPECT("red 1-2 stored");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 50 * MS);
    story_tick(50 * MS);
    EXPECT("red 1-2 expired");
    CU_ASSERT_EQUAL(story_status().expired, 4);
    CU_ASSERT_EQUAL(story.b->pool.mails, 0);
    CU_ASSERT_EQUAL(story.b->due.count, 0);
    CU_ASSERT_EQUAL(story.b->mailbox.quotas.pool.live, 0);
}

static void event_line(struct mu_text *t)
{
    muster_BrokerEvent e;
    mu_text_clear(t);
    while (broker_event_next(story.b, &e)) {
        mu_text_format(t, "%s%s %s %s %llu @%llu", t->len ? "; " : "", e.kind, e.agent, e.sender,
                       (unsigned long long)e.count, (unsigned long long)e.wall_ns);
    }
}

static void test_events(void)
{
    char line[512];
    struct mu_text t;
    mu_text_init(&t, line, sizeof line);
    team();
    limit("green", muster_BOX_REFUSE_NEW, 1, 0);
    say("red", "one", 0);
    say("red", "two", 0);
    event_line(&t); /* at once */
    CU_ASSERT_STRING_EQUAL(line, "over-share green red 1 @1000");
    say("red", "four", 0);
    say("operator", "five", 0);
    limit("blue", muster_BOX_DROP_OLDEST, 1, 0);
    story_state("blue", muster_STATE_SUSPENDED);
    story_send("red", ++seqs['r' - 'a'], "blue", "six");
    story_send("operator", ++seqs['o' - 'a'], "blue", "seven");
    muster_Mail m = next_letter("red", "green", "(stop)");
    m.layer = 0;
    story_mail(m);
    event_line(&t); /* then a pause */
    CU_ASSERT_STRING_EQUAL(line, "");
    story_tick(100 * MS - 1);
    event_line(&t);
    CU_ASSERT_STRING_EQUAL(line, "");
    story_tick(1);
    event_line(&t);
    CU_ASSERT_STRING_EQUAL(line, "over-share green red 1 @1000; box-full green operator 1 @1000; "
                                 "dropped blue red 1 @1000; refused broker red 1 @1000");
    event_line(&t);
    CU_ASSERT_STRING_EQUAL(line, "");
}

/* alice asks the broker, and has room for one mail: the answer takes the place of the question,
 * which is for herself, too. */
static void test_an_answer_that_drops_its_question(void)
{
    story_begin();
    muster_Registration r = registration("alice", "p-alice");
    entry_of(&r)->full = muster_BOX_DROP_OLDEST;
    entry_of(&r)->box_mails = 1;
    broker_registration(story.b, &r, story.now_ns);
    story_match("p-alice");
    (void)story_collect();
    muster_Mail m = letter("alice", 1, "alice,broker", "x");
    m.layer = 2;
    m.performative = words("groups");
    story_mail(m);
    const char *heard = story_collect();
    CU_ASSERT_PTR_NOT_NULL(strstr(heard, "alice 1-1 dropped"));
    CU_ASSERT_PTR_NULL(strstr(heard, "alice/1"));
    story_ack("alice", 1);
    CU_ASSERT_EQUAL(story_status().waiting, 0);
    CU_ASSERT_EQUAL(story.b->pool.mails, 0);
}

/* Red presses, and whatever it is told comes later for that; blue waits no longer than it has to.
 */
static void test_bad_news_waits_for_its_own_sender_alone(void)
{
    story_begin();
    muster_Registration r = registration("green", "p-green");
    entry_of(&r)->box_mails = 1;
    broker_registration(story.b, &r, story.now_ns);
    story_match("p-green");
    story_join("red");
    story_join("blue");
    (void)story_collect();
    uint64_t red = 0;
    for (; red < 3; story_tick(red == 1 ? 1000 * MS : 0)) {
        story_send("red", ++red, "green", "x");
    }
    story_send("blue", 1, "green", "x");
    story_send("blue", 2, "green", "x");
    (void)story_collect();
    story_send("blue", 3, "green", "x");
    EXPECT("");
    bool told = false;
    for (int ms = 0; ms < 300 && !told; ms++) {
        story.now_ns += MS;
        story_send("red", ++red, "green", "x");
        broker_tick(story.b, story.now_ns);
        told = strstr(story_collect(), "blue 3-3 box-full");
    }
    CU_ASSERT_TRUE(told);
}

/* --- good news -------------------------------------------------------------------------------- */

static void two_begin(void)
{
    story_begin();
    story.b->good_news.pause_ns = 25 * MS;
    story_join("red");
    story_join("green");
    (void)story_collect();
    story_send("red", 1, "green", "one");
    EXPECT("green #1 red/1 one");
    story_ack("green", 1);
    EXPECT("red 1-1 delivered"); /* at once: it has not been told of any for long */
}

static void test_a_receipt_goes_with_the_next_mail(void)
{
    two_begin();
    story_send("red", 2, "green", "two");
    story_tick(MS);
    EXPECT("green #2 red/2 two");
    story_ack("green", 2);
    EXPECT("");
    story_send("green", 1, "red", "an answer");
    EXPECT("red #1 green/1 an answer; red 2-2 delivered");
    CU_ASSERT_EQUAL(limiter_deadline_ns(&story.b->good_news), UINT64_MAX);
}

static void test_a_receipt_without_mail_to_go_with_comes_later(void)
{
    two_begin();
    story_send("red", 2, "green", "two");
    story_send("red", 3, "green", "three");
    EXPECT("green #2 red/2 two; green #3 red/3 three");
    story_ack("green", 2);
    story_tick(10 * MS);
    story_ack("green", 3);
    EXPECT("");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 25 * MS);
    story_tick(15 * MS);
    EXPECT("red 2-3 delivered");
    story_tick(100 * MS);
    EXPECT("");
}

/* A sender whose window fills up waits for them; a step goes by what has been told. */
static void test_receipts_of_many_mails_do_not_wait(void)
{
    two_begin();
    for (uint64_t seq = 2; seq <= 51; seq++) {
        story_send("red", seq, "green", "m");
    }
    (void)story_collect();
    story_ack("green", 25);
    EXPECT("");
    story_ack("green", 26);
    EXPECT("red 2-26 delivered");
}

/* The next bearer of a name does not hear of the mail of the last one. */
static void test_who_leaves_has_no_receipts(void)
{
    two_begin();
    story_send("red", 2, "green", "two");
    (void)story_collect();
    story_ack("green", 2);
    EXPECT("");
    story_leave("red", "p-red");
    story_tick(25 * MS);
    story_join("red");
    story_tick(25 * MS);
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "delivered"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a higher priority overtakes", test_a_higher_priority_overtakes},
        {"what the network refused keeps its order", test_what_the_network_refused_keeps_its_order},
        {"a full box refuses", test_a_full_box_refuses},
        {"a small box holds what it says", test_a_small_box_holds_what_it_says},
        {"a full box drops the oldest", test_a_full_box_drops_the_oldest},
        {"a full box drops the lowest", test_a_full_box_drops_the_lowest},
        {"a flood drops its own", test_a_flood_drops_its_own},
        {"a box counts bytes", test_a_box_counts_bytes},
        {"the broker's defaults", test_the_brokers_defaults},
        {"limit: directives in a full box", test_limit_directives_in_a_full_box},
        {"a flood leaves room for others", test_a_flood_leaves_room_for_others},
        {"who presses is slowed down", test_who_presses_is_slowed_down},
        {"answers are paid for by who asks", test_answers_are_paid_for_by_who_asks},
        {"receivers that differ", test_receivers_that_differ},
        {"broadcasts have priorities", test_broadcasts_have_priorities},
        {"every wait ends", test_every_wait_ends},
        {"events", test_events},
        {"an answer that drops its question", test_an_answer_that_drops_its_question},
        {"bad news", test_bad_news_waits_for_its_own_sender_alone},
        {"a receipt goes with the next mail", test_a_receipt_goes_with_the_next_mail},
        {"a receipt without mail to go with comes later",
         test_a_receipt_without_mail_to_go_with_comes_later},
        {"receipts of many mails do not wait", test_receipts_of_many_mails_do_not_wait},
        {"who leaves has no receipts", test_who_leaves_has_no_receipts},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/box", tests);
}
