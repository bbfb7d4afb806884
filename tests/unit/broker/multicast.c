/* SPDX-License-Identifier: Apache-2.0 */
/* Mail to many processes: who has it in a multicast, who in a Delivery, and in which order. */
#include "circular_story.h"

/* --- what is in one --------------------------------------------------------------------------- */

static void test_one_for_many(void)
{
    crowd_of(5);
    say("all", "hi");
    EXPECT("all: a #2, b #2, c #2, d #2, e #2 | red/6 hi");
    CU_ASSERT_EQUAL(story.b->dispatch.count.multicasts, 1);
    CU_ASSERT_EQUAL(story.b->dispatch.count.most_items, 5);
    acknowledge(2);
    EXPECT("red 6-6 delivered");
    CU_ASSERT_EQUAL(story_status().delivered, 10);
    all_is_over();
}

static void test_its_fields(void)
{
    const char *process;
    muster_Delivery d;
    crowd_of(5);
    say("c", "one more");
    (void)story_collect(); /* it has had one more than the others, and one is not acknowledged */
    say("c,d,b,a", "hi");
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    CU_ASSERT_STRING_EQUAL(process, BUS_TO_ALL);
    CU_ASSERT_STRING_EQUAL(d.process, BUS_TO_ALL);
    CU_ASSERT_STRING_EQUAL(d.broker, "alpha");
    CU_ASSERT_EQUAL(d.broker_incarnation, 5);
    CU_ASSERT_EQUAL(d.step, muster_STEP_NOW);
    CU_ASSERT_EQUAL_FATAL(d.seats._length, 4);
    for (uint32_t i = 0; i < 4; i++) {
        const struct process *at = place_at(process_of(crew[i]));
        CU_ASSERT_EQUAL(d.seats._buffer[i], at->seat);
        CU_ASSERT_EQUAL(d.serials._buffer[i], at->serial + 1);
        CU_ASSERT_EQUAL(d.slots._buffer[i], story_slot(crew[i]));
        CU_ASSERT_EQUAL(d.numbers._buffer[i], i == 2 ? 3 : 2);
    }
    CU_ASSERT_EQUAL(d.letters._length, 1);
    CU_ASSERT_STRING_EQUAL(d.letters._buffer[0].content, "hi");
    broker_delivered(story.b, story.now_ns);
    EXPECT("");
}

static void test_several_letters_in_one(void)
{
    crowd_of(4);
    say("all", "one");
    say("all", "two");
    say("a,b,c,d", "three");
    say("a,b,c", "four");
    EXPECT("all: a #2, b #2, c #2, d #2 | red/5 one, red/6 two, red/7 three; "
           "a #5 red/8 four; b #5 red/8 four; c #5 red/8 four");
    acknowledge(5);
    CU_ASSERT_EQUAL(story_status().malformed, 1); /* d has had no fifth one */
    story_ack("d", 4);
    EXPECT("red 8-8 delivered; red 5-7 delivered");
    all_is_over();
}

/* Two who speak to all have each what the other said, and not what they said themselves. */
static void test_two_speakers(void)
{
    crowd_of(6);
    story_send("a", 1, "all", "of a");
    story_send("b", 1, "all", "of b");
    EXPECT("all: b #2, c #2, d #2, e #2, f #2 | a/1 of a; all: a #2, c #3, d #3, e #3, f #3 | "
           "b/1 of b; red #1 a/1 of a; red #2 b/1 of b");
    acknowledge(2);
    for (uint32_t i = 2; i < 6; i++) {
        story_ack(crew[i], 3);
    }
    story_ack("red", 2);
    EXPECT("a 1-1 delivered; b 1-1 delivered");
    all_is_over();
}

/* --- who has a Delivery of his own ------------------------------------------------------------ */

#define REST(number) "b #" #number ", c #" #number ", d #" #number ", e #" #number

static void test_who_does_not_hear(void)
{
    crowd_of(4);
    story_join("e"); /* and hears none */
    say("e", "hello");
    (void)story_collect();
    story_ack("e", 1);
    (void)story_collect();
    say("all", "hi");
    EXPECT("all: a #2, b #2, c #2, d #2 | red/6 hi; e #2 red/6 hi");
    broker_hears(story.b, "p-nobody");
    broker_hears(story.b, "p-e");
    story_ack("e", 2);
    say("all", "ho");
    EXPECT("all: a #3, b #3, c #3, d #3, e #3 | red/7 ho");
    CU_ASSERT_EQUAL(story.b->processes.hearers, 5);
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_has_acknowledged_nothing(void)
{
    crowd_of(4);
    story_join("e");
    broker_hears(story.b, "p-e");
    say("all", "hi");
    EXPECT("all: a #2, b #2, c #2, d #2 | red/5 hi; e #1 red/5 hi");
    say("all", "ho");
    EXPECT("all: a #3, b #3, c #3, d #3 | red/6 ho; e #2 red/6 ho");
    story_ack("e", 1); /* with that, he knows his seat */
    say("all", "hu");
    EXPECT("all: a #4, b #4, c #4, d #4, e #3 | red/7 hu");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_matches_anew(void)
{
    crowd_of(5);
    story_match("p-a"); /* another reader, which may know nothing */
    CU_ASSERT_EQUAL(story.b->processes.hearers, 4);
    (void)story_collect();
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/6 hi; a #2 red/6 hi");
    broker_hears(story.b, "p-a");
    say("all", "ho");
    EXPECT("all: " REST(3) " | red/7 ho; a #3 red/7 ho");
    story_ack("a", 3);
    say("all", "hu");
    EXPECT("all: a #4, " REST(4) " | red/8 hu");
    broker_matched(story.b, "p-a", false, story.now_ns);
    broker_hears(story.b, "p-a"); /* nobody is there */
    CU_ASSERT_EQUAL(story.b->processes.hearers, 4);
    say("all", "he");
    EXPECT("all: " REST(5) " | red/9 he");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

/* Who acknowledges what he has had before, tells nothing of what he will take next. */
static void test_who_has_had_it_before(void)
{
    crowd_of(5);
    say("a", "one");
    (void)story_collect();
    story_match("p-a");
    EXPECT("a #2 red/6 one; a welcome 0");
    broker_hears(story.b, "p-a");
    story_ack("a", 2);
    (void)story_collect();
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/7 hi; a #3 red/7 hi");
    story_ack("a", 3);
    say("all", "ho");
    EXPECT("all: a #4, " REST(3) " | red/8 ho");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

/* Of two agents of a process, one has it in a multicast when the other has not been heard of. */
static void test_who_is_new_in_a_process(void)
{
    crowd_of(5);
    story_register("new", "p-a");
    (void)story_collect();
    say("all", "hi");
    EXPECT("all: a #2, " REST(2) " | red/6 hi; new #1 red/6 hi");
    struct one_up u;
    one_up(&u, "new", "p-a", NULL, 0, 1);
    story_hear(&u.up);
    say("all", "ho");
    EXPECT("all: a #3, new #2, " REST(3) " | red/7 ho");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

/* Where nobody was for a while, somebody else may be, or the same after he was elsewhere. */
static void test_who_comes_back(void)
{
    crowd_of(5);
    story_leave("a", "p-a");
    (void)story_collect();
    story_register("a", "p-a");
    (void)story_collect();
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/6 hi; a #2 red/6 hi");
    story_ack("a", 2);
    say("all", "ho");
    EXPECT("all: a #3, " REST(3) " | red/7 ho");
    muster_Registration r = registration("a", "p-a");
    r.incarnation = 2; /* another process of that name */
    broker_registration(story.b, &r, story.now_ns);
    (void)story_collect();
    say("all", "hu");
    EXPECT("all: " REST(4) " | red/8 hu; a #4 red/8 hu");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_is_blocked(void)
{
    const char *process;
    muster_Delivery d;
    crowd_of(5);
    say("a", "one");
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    broker_undelivered(story.b);
    say("b", "two");
    say("all", "hi"); /* behind another one in two boxes */
    EXPECT("b #2 red/7 two; b #3 red/8 hi; c #2 red/8 hi; d #2 red/8 hi; e #2 red/8 hi");
    story_ack("b", 3);
    say("b,c,d,e", "ho");
    EXPECT("all: b #4, c #3, d #3, e #3 | red/9 ho; red 7-7 delivered");
    story_tick(DISPATCH_RETRY_NS);
    EXPECT("a #2 red/6 one; a #3 red/8 hi");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_is_blocked_and_has_nothing_before(void)
{
    const char *process;
    muster_Delivery d;
    crowd_of(5);
    muster_Mail m = letter("red", 0, "a", "brief");
    m.ttl_ns = DISPATCH_RETRY_NS / 2;
    say_as(m);
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    broker_undelivered(story.b);
    story_tick(DISPATCH_RETRY_NS / 2);
    EXPECT("red 6-6 expired");
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/7 hi");
    story_tick(DISPATCH_RETRY_NS);
    EXPECT("a #2 red/7 hi");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_is_suspended(void)
{
    crowd_of(5);
    story_state("a", muster_STATE_SUSPENDED);
    (void)story_collect();
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/6 hi; red 6-6 stored");
    story_state("a", muster_STATE_RUNNING);
    EXPECT("a #2 red/6 hi");
    story_state("a", muster_STATE_MOVING);
    (void)story_collect();
    say("all", "ho");
    EXPECT("all: " REST(3) " | red/7 ho; red 7-7 stored");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_has_pages_to_come(void)
{
    crowd_of(5);
    story_register("new", "p-new");
    say("all", "hi");
    EXPECT("a #2 red/6 hi; b #2 red/6 hi; c #2 red/6 hi; d #2 red/6 hi; e #2 red/6 hi");
    muster_Mail ask = letter("a", 1, "broker", "g");
    ask.layer = 2;
    ask.performative = words("group-create");
    story_mail(ask);
    say("all", "ho");
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "all: "));
    ask = letter("a", 2, "broker", "s");
    ask.layer = 2;
    ask.performative = words("advertise");
    story_mail(ask);
    say("all", "hu");
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "all: "));
    say("all", "he"); /* now everybody has been told */
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "all: "));
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_is_refused_or_welcomed(void)
{
    crowd_of(5);
    story_register("no name", "p-a");
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/6 hi; a #2 red/6 hi; no name: not a valid name");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_is_in_lock_step(void)
{
    char *names[] = {words("p-a")};
    muster_Roster roster = {.simulator = words("sim"), .lockstep = true, .step_ns = 100 * MS};
    roster.processes = (dds_sequence_string){._length = 1, ._buffer = names};
    crowd_of(6);
    story_match("sim");
    broker_roster(story.b, &roster, story.now_ns);
    (void)story_collect();
    say("all", "hi");
    EXPECT("");
    story_up("a", 0, muster_STATE_RUNNING, NULL, 0, 0);
    const char *text = story_collect();
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "p-a@0; a #2 red/7 hi"));
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "all: b #2, c #2, d #2, e #2, f #2 | red/7 hi"));
    say("b,c,d,e,f", "ho"); /* nobody of the lock step has to do with that */
    EXPECT("all: b #3, c #3, d #3, e #3, f #3 | red/8 ho");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_has_other_mail_before(void)
{
    crowd_of(5);
    say("a", "one");
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/7 hi; a #2 red/6 one; a #3 red/7 hi");
    acknowledge(2);
    story_ack("a", 3);
    EXPECT("red 6-7 delivered");
    muster_Mail urgent = letter("red", 0, "a,b,c,d,e", "two");
    urgent.priority = 1;
    say("all", "one");
    say_as(urgent);
    EXPECT("all: a #4, " REST(3) " | red/9 two; a #5 red/8 one; b #4 red/8 one; c #4 red/8 one; "
                                 "d #4 red/8 one; e #4 red/8 one");
    acknowledge(4);
    story_ack("a", 5);
    EXPECT("red 9-9 delivered; red 8-8 delivered");
    all_is_over();
}

static void test_whose_window_is_full(void)
{
    crowd_of(5);
    for (uint32_t i = 0; i < MU_WINDOW_MAX; i++) {
        say("a", "x");
    }
    (void)story_collect();
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/206 hi");
    story_ack("a", 2);
    EXPECT("red 6-6 delivered; a #202 red/206 hi");
    say("all", "ho");
    EXPECT("all: " REST(3) " | red/207 ho");
    story_ack("a", 202);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "a #203 red/207 ho"));
    acknowledge(3);
    story_ack("a", 203);
    EXPECT("red 206-207 delivered");
    all_is_over();
}

/* --- which mail ------------------------------------------------------------------------------- */

static void test_directives(void)
{
    crowd_of(5);
    story_join("operator");
    (void)story_collect();
    story_state("a", muster_STATE_SUSPENDED);
    (void)story_collect();
    say("all", "hi");
    story_mail(directive("operator", 1, "a,b,c,d,e", "(stop)"));
    /* It passes the other mail, and whom no multicast reaches has it, too. */
    EXPECT("all: " REST(
        2) " | operator/1 (stop); a #2 operator/1 (stop); b #3 red/6 hi; c #3 red/6 hi; "
           "d #3 red/6 hi; e #3 red/6 hi; operator #1 red/6 hi; red 6-6 stored");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_what_is_due_later(void)
{
    muster_Roster run = {.simulator = words("sim"), .step_ns = MS};
    crowd_of(4);
    broker_roster(story.b, &run, story.now_ns);
    (void)story_collect();
    muster_Mail m = letter("red", 0, "all", "later");
    m.due_ns = (int64_t)SOME_MS;
    say_as(m);
    say("all", "now");
    EXPECT("all: a #2, b #2, c #2, d #2 | red/6 now; red 5-5 stored");
    story_tick(SOME_MS);
    EXPECT("d #3 red/5 later; c #3 red/5 later; b #3 red/5 later; a #3 red/5 later");
    acknowledge(3);
    EXPECT("red 6-6 delivered; red 5-5 delivered");
    all_is_over();
}

static void test_what_goes_to_a_disk(void)
{
    memset(&disk, 0, sizeof disk);
    life_begin(WALL);
    story.gaps = 0;
    crowd_join(4);
    greet();
    crowd.seq = 100;
    (void)commit(true);
    send_at(muster_LEVEL_LOGGED, ++crowd.seq, "all", "logged");
    send_at(muster_LEVEL_SYNCED, ++crowd.seq, "all", "synced");
    CU_ASSERT_EQUAL(story.b->multicast.count, 0);
    CU_ASSERT_TRUE(commit(true));
    const char *text = story_collect();
    CU_ASSERT_PTR_NULL(strstr(text, "all: "));
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "a #2 red/101 logged; a #3 red/102 synced"));
    say("all", "hi");
    EXPECT("all: a #4, b #4, c #4, d #4 | red/103 hi");
    send_at(muster_LEVEL_LOGGED, ++crowd.seq, "a", "logged"); /* and what waits behind it */
    CU_ASSERT_TRUE(commit(true));
    say("all", "ho");
    EXPECT("a #5 red/104 logged; a #6 red/105 ho; b #5 red/105 ho; c #5 red/105 ho; "
           "d #5 red/105 ho");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_what_waits_for_the_interval(void)
{
    story_begin_with(50 * MS, false);
    crowd_join(4);
    story_tick(RESEND_MS);
    greet();
    story_tick(RESEND_MS);
    greet();
    story_tick(RESEND_MS);
    (void)story_collect();
    story_tick(RESEND_MS);
    acknowledge(2);
    (void)story_collect();
    story_tick(RESEND_MS);
    say("all", "hi");
    EXPECT("a #3 red/9 hi; b #3 red/9 hi; c #3 red/9 hi; d #3 red/9 hi");
    CU_ASSERT_EQUAL(story.gaps, 0);
}

/* What mail has waited for the interval is counted once. */
static void test_the_interval_ends(void)
{
    crowd_of(4);
    story_join("operator");
    (void)story_collect();
    story_mail(directive("operator", 1, "broker", "(delivery-interval 20)"));
    (void)story_collect();
    say("all", "one");
    story_tick(SOME_MS);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "one"));
    uint64_t delay_ns = story.b->dispatch.count.delay_ns;
    CU_ASSERT_TRUE(delay_ns > 0);
    story_mail(directive("operator", 2, "broker", "(delivery-interval 0)"));
    say("a,b,c,d", "two");
    say("all", "three");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "all: a #3, b #3, c #3, d #3 | "));
    CU_ASSERT_EQUAL(story.b->dispatch.count.delay_ns, delay_ns);
}

/* --- the network, and the end ----------------------------------------------------------------- */

static void test_the_network_refuses(void)
{
    const char *process;
    muster_Delivery d;
    crowd_of(4);
    say("all", "one");
    say("all", "two");
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    CU_ASSERT_STRING_EQUAL(process, BUS_TO_ALL);
    broker_undelivered(story.b);
    muster_Mail urgent = letter("red", 0, "a", "urgent");
    urgent.priority = 1;
    say_as(urgent); /* what is not out yet makes way for it */
    EXPECT("a #2 red/7 urgent; a #3 red/5 one; a #4 red/6 two; b #2 red/5 one; b #3 red/6 two; "
           "c #2 red/5 one; c #3 red/6 two; d #2 red/5 one; d #3 red/6 two");
    CU_ASSERT_EQUAL(story.b->dispatch.count.blocked, 1);
    say("all", "three"); /* there is no hurry to try again */
    EXPECT("a #5 red/8 three; b #4 red/8 three; c #4 red/8 three; d #4 red/8 three");
    story_tick(MULTICAST_PAUSE_NS);
    say("all", "four");
    EXPECT("all: a #6, b #5, c #5, d #5 | red/9 four");
    CU_ASSERT_EQUAL(story.again, 0);
    acknowledge(5);
    story_ack("a", 6);
    EXPECT("red 7-7 delivered; red 5-6 delivered; red 8-9 delivered");
    all_is_over();
}

static void test_what_is_not_acknowledged_comes_again(void)
{
    crowd_of(4);
    say("all", "one");
    say("all", "two");
    (void)story_collect();
    story_ack("a", 3);
    story_ack("b", 2);
    story_tick(RESEND_MS);
    EXPECT("c #2 red/5 one; c #3 red/6 two; d #2 red/5 one; d #3 red/6 two; b #3 red/6 two");
    CU_ASSERT_EQUAL(story.again, 5);
    CU_ASSERT_EQUAL(story_status().resent, 5);
    say("a,b,c,d", "three");
    EXPECT("all: a #4, b #4, c #4, d #4 | red/7 three");
    acknowledge(4);
    EXPECT("red 5-7 delivered");
    story_tick(RESEND_MS);
    EXPECT("");
    all_is_over();
}

/* What is to go out again goes before what is new. */
static void test_what_is_new_waits_for_what_comes_again(void)
{
    crowd_of(5);
    say("a", "one");
    (void)story_collect();
    story_tick(RESEND_MS);
    say("all", "hi");
    EXPECT("all: " REST(2) " | red/7 hi; a #2 red/6 one; a #3 red/7 hi");
    CU_ASSERT_EQUAL(story.again, 1);
    CU_ASSERT_EQUAL(story.gaps, 0);
}

static void test_who_dies_has_it_in_his_next_life(void)
{
    crowd_of(5);
    say("all", "hi");
    (void)story_collect();
    story_gone("p-a");
    broker_matched(story.b, "p-a", false, story.now_ns);
    (void)story_collect();
    story_register("a", "p-a2");
    story_match("p-a2");
    EXPECT("a #2 red/6 hi; a welcome 0");
    CU_ASSERT_EQUAL(story.again, 1);
    struct one_up u;
    one_up(&u, "a", "p-a2", NULL, 0, 2);
    story_hear(&u.up);
    acknowledge(2);
    EXPECT("red 6-6 delivered");
    all_is_over();
}

static void test_what_is_out_does_not_expire(void)
{
    muster_Mail m = letter("red", 0, "all", "brief");
    m.ttl_ns = SOME_MS;
    crowd_of(4);
    say_as(m);
    EXPECT("all: a #2, b #2, c #2, d #2 | red/5 brief");
    story_tick(2 * SOME_MS);
    acknowledge(2);
    EXPECT("red 5-5 delivered");
    say_as(m);
    story_tick(SOME_MS); /* before it could go out */
    EXPECT("red 6-6 expired");
    CU_ASSERT_EQUAL(story_status().expired, 4);
    all_is_over();
}

/* A box that drops what is old drops nothing that is out, and what it has dropped goes out to the
 * others alone. */
static void test_what_a_box_drops(void)
{
    crowd_of(5);
    muster_Registration r = registration("a", "p-a");
    entry_of(&r)->full = muster_BOX_DROP_OLDEST;
    entry_of(&r)->box_mails = 2;
    broker_registration(story.b, &r, story.now_ns);
    (void)story_collect();
    say("all", "one");
    EXPECT("all: a #2, " REST(2) " | red/6 one");
    say("all", "two");
    say("all", "three"); /* instead of the second one */
    EXPECT("all: " REST(3) " | red/7 two, red/8 three; a #3 red/8 three");
    acknowledge(4);
    CU_ASSERT_EQUAL(story_status().malformed, 1);
    story_ack("a", 3);
    EXPECT("red 7-7 dropped; red 6-6 delivered; red 8-8 delivered");
    CU_ASSERT_EQUAL(story_status().dropped, 1);
    all_is_over();
}

/* What ends before it goes out goes out to nobody. */
static void test_what_all_boxes_drop(void)
{
    crowd_of(4);
    for (uint32_t i = 0; i < 4; i++) {
        muster_Registration r = registration(crew[i], process_of(crew[i]));
        entry_of(&r)->full = muster_BOX_DROP_OLDEST;
        entry_of(&r)->box_mails = 1;
        broker_registration(story.b, &r, story.now_ns);
    }
    (void)story_collect();
    say("all", "one");
    say("all", "two");
    EXPECT("all: a #2, b #2, c #2, d #2 | red/6 two; red 5-5 dropped");
    acknowledge(2);
    EXPECT("red 6-6 delivered");
    all_is_over();
}

/* Nobody is there any more when it could go out. */
static void test_all_leave_meanwhile(void)
{
    crowd_of(4);
    say("all", "hi");
    for (uint32_t i = 0; i < 4; i++) {
        story_gone(process_of(crew[i]));
        broker_matched(story.b, process_of(crew[i]), false, story.now_ns);
    }
    EXPECT("");
    CU_ASSERT_EQUAL(story.b->multicast.count, 0);
    CU_ASSERT_EQUAL(story.b->processes.hearers, 0);
    crowd_join(4);
    EXPECT("");
    acknowledge(2);
    all_is_over();
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"one for many", test_one_for_many},
        {"its fields", test_its_fields},
        {"several letters in one", test_several_letters_in_one},
        {"two speakers", test_two_speakers},
        {"who does not hear", test_who_does_not_hear},
        {"who has acknowledged nothing", test_who_has_acknowledged_nothing},
        {"who matches anew", test_who_matches_anew},
        {"who has had it before", test_who_has_had_it_before},
        {"who is new in a process", test_who_is_new_in_a_process},
        {"who comes back", test_who_comes_back},
        {"who is blocked", test_who_is_blocked},
        {"who is blocked and has nothing before", test_who_is_blocked_and_has_nothing_before},
        {"who is suspended", test_who_is_suspended},
        {"who has pages to come", test_who_has_pages_to_come},
        {"who is refused", test_who_is_refused_or_welcomed},
        {"who is in lock step", test_who_is_in_lock_step},
        {"who has other mail before", test_who_has_other_mail_before},
        {"whose window is full", test_whose_window_is_full},
        {"directives", test_directives},
        {"what is due later", test_what_is_due_later},
        {"what goes to a disk", test_what_goes_to_a_disk},
        {"what waits for the interval", test_what_waits_for_the_interval},
        {"the interval ends", test_the_interval_ends},
        {"the network refuses", test_the_network_refuses},
        {"what is not acknowledged comes again", test_what_is_not_acknowledged_comes_again},
        {"what is new waits for what comes again", test_what_is_new_waits_for_what_comes_again},
        {"who dies has it in his next life", test_who_dies_has_it_in_his_next_life},
        {"what is out does not expire", test_what_is_out_does_not_expire},
        {"what a box drops", test_what_a_box_drops},
        {"what all boxes drop", test_what_all_boxes_drop},
        {"all leave meanwhile", test_all_leave_meanwhile},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/circular", tests);
}
