/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "lockstep_story.h"

static void answer_with(muster_Mail m, int64_t step)
{
    story_up(m.src, step, muster_STATE_RUNNING, &m, 1, 0);
}

/* green and red in lock step from step 0 on, the operator outside */
static void run_begin(void)
{
    story_begin();
    story_join("green");
    story_join("red");
    story_join("operator");
    story_match("sim");
    (void)story_collect();
    roster_say(true, 0, "p-green p-red");
    EXPECT("p-green@-1; p-red@-1; sim@-1");
}

static void test_the_barrier(void)
{
    run_begin();
    answer_with(letter("red", 1, "green", "hello"), 0);
    EXPECT("");
    answer("green", 0);
    EXPECT("p-green@0; green #1 red/1 hello; p-red@0; sim@0");
    story_up("green", 1, muster_STATE_RUNNING, NULL, 0, 1);
    answer("red", 0); /* an older step */
    answer("red", 2); /* a later one */
    EXPECT("");
    answer("red", 1);
    EXPECT("p-red@1; red 1-1 delivered; p-green@1; sim@1");
    CU_ASSERT_EQUAL(story_status().delivered, 1);
}

/* What comes by the clock, after the last step, differs from run to run. */
static void test_the_counters_of_the_last_step_are_kept(void)
{
    run_begin();
    CU_ASSERT_EQUAL(story_status().lockstep.ended, 0);
    answer_with(letter("red", 1, "green", "hello"), 0);
    answer("green", 0);
    (void)story_collect();
    story_ack("green", 1); /* it knows that no step follows before the broker does */
    roster_say(false, 1, "");
    story_send("operator", 1, "red", "after it");
    CU_ASSERT_EQUAL(story_status().sent, 2);
    CU_ASSERT_EQUAL(story_status().delivered, 1);
    CU_ASSERT_EQUAL(story_status().lockstep.ended, 1);
    CU_ASSERT_EQUAL(story_status().lockstep.sent, 1);
    CU_ASSERT_EQUAL(story_status().lockstep.waiting, 1);
}

/* It is an answer all the same. */
static void test_an_answer_that_acknowledges_to_another_life(void)
{
    struct one_up u;
    run_begin();
    answer_with(letter("red", 1, "green", "hello"), 0);
    answer("green", 0);
    EXPECT("p-green@0; green #1 red/1 hello; p-red@0; sim@0");
    one_up(&u, "green", "p-green", NULL, 0, 1);
    u.up.step = 1;
    u.up.broker_incarnation = story.b->incarnation - 1;
    broker_up(story.b, &u.up, story.now_ns);
    answer("red", 1);
    EXPECT("p-green@1; p-red@1; sim@1");
    story_up("green", 2, muster_STATE_RUNNING, NULL, 0, 1);
    answer("red", 2);
    EXPECT("p-red@2; red 1-1 delivered; p-green@2; sim@2");
}

static void test_a_repeated_answer_is_dropped(void)
{
    run_begin();
    answer_with(letter("red", 1, "green", "hello"), 0);
    answer_with(letter("red", 1, "green", "hello"), 0);
    answer_with(letter("red", 2, "green", "more"), 0);
    EXPECT("");
    answer("green", 0);
    EXPECT("p-green@0; green #1 red/1 hello; p-red@0; sim@0");
    CU_ASSERT_EQUAL(story_status().duplicates_dropped, 0);
}

static void test_outside_mail_waits_for_the_step(void)
{
    run_begin();
    story_send("operator", 1, "red", "stop");
    story_send("operator", 2, "operator", "a note");
    EXPECT("operator #1 operator/2 a note");
    answer("red", 0);
    EXPECT("");
    answer_with(letter("green", 1, "red,operator", "hi"), 0);
    EXPECT("p-red@0; red #1 green/1 hi; red #2 operator/1 stop; operator #2 green/1 hi; "
           "p-green@0; green 1-1 stored; sim@0; outside operator/1");
    story_send("operator", 3, "all", "hi");
    story_gone("p-operator"); /* it has left; what it said stands */
    story_up("red", 1, muster_STATE_RUNNING, NULL, 0, 2);
    answer("green", 1);
    EXPECT("p-green@1; green #1 operator/3 hi; p-red@1; red #3 operator/3 hi; sim@1; "
           "outside operator/3");
}

/* A mail of a recording, as its sender's process hands it over. */
static void replay(const char *src, uint64_t seq, int64_t due_ns, const char *content)
{
    struct one_up u;
    char process[MU_PROCESS_MAX + 1];
    muster_Mail m = letter(src, seq, "red", content);
    m.due_ns = due_ns;
    snprintf(process, sizeof process, "p-%s", src);
    one_up(&u, src, process, &m, 1, 0);
    u.act.replays = true;
    u.act.first_seq = seq;
    broker_up(story.b, &u.up, story.now_ns);
}

/* What came from outside in a step comes in there again, whenever it was handed over. */
static void test_replays_come_in_with_their_step(void)
{
    story_begin();
    story_join("green");
    story_join("red");
    story_join("operator");
    story_join("observer");
    story_match("sim");
    (void)story_collect();
    replay("operator", 1, (int64_t)(200 * MS), "stop");
    replay("operator", 5, (int64_t)(200 * MS), "later"); /* numbers between were no input */
    replay("observer", 3, (int64_t)(200 * MS), "first");
    replay("operator", 6, (int64_t)(100 * MS), "before"); /* a step goes by numbers alone */
    EXPECT("operator 1-1 stored; operator 5-6 stored; observer 3-3 stored");
    roster_say(true, 0, "p-green p-red");
    EXPECT("p-green@-1; p-red@-1; sim@-1");
    answer("red", 0);
    answer("green", 0);
    EXPECT("p-red@0; red #1 operator/6 before; p-green@0; sim@0; outside operator/6");
    answer_with(letter("green", 1, "red", "hi"), 1);
    answer("red", 1);
    EXPECT("p-red@1; red #2 green/1 hi; red #3 observer/3 first; red #4 operator/1 stop; "
           "red #5 operator/5 later; p-green@1; sim@1; outside observer/3; "
           "outside operator/1; outside operator/5");
    replay("operator", 7, (int64_t)(100 * MS), "too late: with the step at hand");
    answer("red", 2);
    answer("green", 2);
    EXPECT("p-red@2; red #6 operator/7 too late: with the step at hand; p-green@2; sim@2; "
           "outside operator/7");
}

static void test_an_untrusted_directive_from_outside(void)
{
    run_begin();
    story_join("mallory");
    muster_Mail m = letter("mallory", 1, "all", "(stop)");
    m.layer = 0;
    story_mail(m);
    answer("red", 0);
    answer("green", 0);
    EXPECT("mallory 1-1 refused; p-green@0; p-red@0; sim@0");
}

static void test_states_come_from_acts(void)
{
    run_begin();
    story_state("red", muster_STATE_SUSPENDED); /* a registration */
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
    EXPECT("");
    story_up("red", 0, muster_STATE_SUSPENDED, NULL, 0, 0);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
    answer_with(letter("green", 1, "red", "hi"), 0);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red suspended p-red");
    EXPECT("p-green@0; green 1-1 stored; p-red@0; sim@0");
    CU_ASSERT_EQUAL(story.members, 4); /* three in step and the operator */
    answer("green", 1);
    answer("red", 1);
    EXPECT("p-green@1; p-red@1; red #1 green/1 hi; sim@1");
    story_up("red", 2, muster_STATE_ABSENT, NULL, 0, 0); /* it is gone for good */
    answer("green", 2);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
}

/* The broker is told why red is suspended when the step has ended, and nobody knows of that. */
static void test_a_reason_hides_no_state(void)
{
    run_begin();
    story_up("red", 0, muster_STATE_SUSPENDED, NULL, 0, 0);
    answer("green", 0);
    muster_Registration r = registration("red", "p-red");
    entry_of(&r)->state = muster_STATE_SUSPENDED;
    entry_of(&r)->reason = words("as it wanted");
    broker_registration(story.b, &r, story.now_ns);
    EXPECT("p-green@0; p-red@0; sim@0");
    CU_ASSERT_EQUAL(story.members, 4); /* three in step and the operator */
    story_up("red", 1, muster_STATE_SUSPENDED, NULL, 0, 0);
    answer("green", 1);
    EXPECT("p-green@1; p-red@1; sim@1");
    CU_ASSERT_EQUAL(story.members, 3); /* the reason, which the operator has had */
    story_up("red", 2, muster_STATE_SUSPENDED, NULL, 0, 0);
    answer("green", 2);
    EXPECT("p-green@2; p-red@2; sim@2");
    CU_ASSERT_EQUAL(story.members, 0);
}

/* Who is not in the lock step comes and goes by the wall clock, unseen by those in it. */
static void test_white_pages_of_a_step_do_not_show_outsiders(void)
{
    run_begin();
    story_join("blue");
    EXPECT("");
    answer("red", 0);
    answer("green", 0);
    EXPECT("p-green@0; p-red@0; sim@0");
    CU_ASSERT_EQUAL(story.members, 0);
    roster_say(true, 1, "p-green p-red p-blue");
    (void)story_collect();
    story.members = 0;
    answer("blue", 1);
    answer("red", 1);
    answer("green", 1);
    (void)story_collect();
    CU_ASSERT_EQUAL(story.members, 4); /* blue, to each of the three and to the simulator */
}

/* Nor do those in it see who looked on before the first step. */
static void test_white_pages_of_a_step_do_not_show_onlookers(void)
{
    story_begin();
    story_join("green");
    story_join("red");
    story_join("blue");
    story_look_on("ada", "p-ada");
    story_match("sim");
    (void)story_collect();
    roster_say(true, 0, "p-green p-red");
    EXPECT("p-green@-1; p-red@-1; sim@-1");
    /* The broker, green, red and blue: to each of two, and to the simulator. */
    CU_ASSERT_EQUAL(story.members, 3 * 4);
}

/* The eye's process has its place in the roster, and waits for its part of each step. */
static void eye_begin(void)
{
    story_begin();
    story_join("green");
    story_join("red");
    muster_Registration r = registration("eye", "p-eye");
    r.watches = true;
    entry_of(&r)->kind = muster_KIND_SPECIAL;
    entry_of(&r)->no_broadcasts = true;
    broker_registration(story.b, &r, story.now_ns);
    story_match("p-eye");
    story_match("sim");
    (void)story_collect();
    roster_say(true, 0, "p-eye p-green p-red");
    EXPECT("p-eye@-1; p-green@-1; p-red@-1; sim@-1");
}

static void test_who_looks_on_speaks_from_outside_in_its_turn(void)
{
    eye_begin();
    answer("red", 0);
    answer_with(letter("green", 1, "red", "hello"), 0);
    EXPECT(""); /* it may have something to say */
    answer_with(letter("eye", 1, "red", "status"), 0);
    EXPECT("p-red@0; red #1 green/1 hello; red #2 eye/1 status; p-eye@0; p-green@0; sim@0; "
           "outside eye/1");
    /* What it is told is of a step, too; that it has it is told to nobody inside. */
    story_up("red", 1, muster_STATE_RUNNING, (muster_Mail[]){letter("red", 1, "eye", "well")}, 1,
             2);
    answer("green", 1);
    EXPECT("");
    answer("eye", 1);
    EXPECT("p-green@1; green 1-1 delivered; p-eye@1; eye #1 red/1 well; eye 1-1 delivered; "
           "p-red@1; red 1-1 stored; sim@1");
    story_up("eye", 2, muster_STATE_RUNNING, NULL, 0, 1);
    answer("green", 2);
    answer("red", 2);
    EXPECT("p-eye@2; p-green@2; p-red@2; sim@2");
}

/* Nobody else waits for what it says to its like, and the hash has none of it. */
static void test_who_looks_on_speaks_to_its_like_at_once(void)
{
    eye_begin();
    story_join("operator");
    (void)story_collect();
    answer_with(letter("eye", 1, "operator", "look"), 0);
    EXPECT("operator #1 eye/1 look");
    answer("green", 0);
    answer("red", 0);
    EXPECT("p-eye@0; p-green@0; p-red@0; sim@0");
}

static void test_a_step_goes_on_without_who_looked_on(void)
{
    eye_begin();
    answer("green", 0);
    answer("red", 0);
    story_gone("p-eye");
    EXPECT("");
    roster_say(true, 0, "p-green p-red");
    EXPECT("p-green@0; p-red@0; sim@0");
}

static void test_deaths_are_the_simulators_business(void)
{
    run_begin();
    answer_with(letter("red", 1, "green", "last words"), 0);
    story_gone("p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
    EXPECT("");
    roster_say(true, 0, "p-green"); /* none of what red did in this step takes effect */
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    answer("green", 0);
    EXPECT("p-green@0; sim@0");
    CU_ASSERT_EQUAL(story_status().sent, 1);
    CU_ASSERT_EQUAL(story_status().dropped, 1);
}

static void test_the_missing_one_is_dropped(void)
{
    run_begin();
    answer_with(letter("green", 1, "operator", "where is red"), 0);
    EXPECT("");
    roster_say(true, 1, "p-green"); /* step 0 ends without red */
    EXPECT("operator #1 green/1 where is red; p-green@0; green 1-1 stored; sim@0");
    answer("green", 1);
    EXPECT("p-green@1; sim@1");
}

/* red's process dies, and p-red2 is started in its place. */
static void red_dies(int64_t step)
{
    story_gone("p-red");
    is_held = true;
    roster_say(true, step, "p-green");
    is_held = false;
}

static void red_returns(int64_t step)
{
    story_register("red", "p-red2");
    story_match("p-red2");
    EXPECT("red welcome 0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red2");
    roster_say(true, step, "p-green p-red2");
}

static void test_a_step_is_held_until_who_died_is_back(void)
{
    run_begin();
    red_dies(0);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    answer_with(letter("green", 1, "red", "hello"), 0);
    EXPECT(""); /* all that are left have answered, and the step does not end */
    red_returns(0);
    EXPECT("p-red2@-1");
    story_up_from("p-red2", "red", 0);
    EXPECT("p-red2@0; red #1 green/1 hello; p-green@0; sim@0");
}

/* What red had said in the step that did not end was never said: its next life has those numbers.
 */
static void test_numbers_of_who_died(void)
{
    run_begin();
    answer_with(letter("red", 1, "green", "one"), 0);
    answer("green", 0);
    EXPECT("p-green@0; green #1 red/1 one; p-red@0; sim@0");
    answer_with(letter("red", 2, "green", "two"), 1);
    red_dies(1);
    story_register("red", "p-red2");
    story_match("p-red2");
    EXPECT("red welcome 1");
}

/* What the broker says to mail of the last step is said again until the step behind it is answered.
 */
static void test_receipts_of_who_died(void)
{
    run_begin();
    answer_with(letter("red", 1, "nosuch", "one"), 0);
    answer("green", 0);
    EXPECT("p-red@0; red 1-1 unknown-name; p-green@0; sim@0");
    red_dies(1);
    EXPECT("");
    story_register("red", "p-red2");
    story_match("p-red2");
    EXPECT("red welcome 1");
    roster_say(true, 1, "p-green p-red2");
    EXPECT("p-red2@0; red 1-1 unknown-name");
    story_up_from("p-red2", "red", 1);
    answer("green", 1);
    EXPECT("p-green@1; p-red2@1; sim@1");
}

/* The simulator has all answers to step 0, and the broker has not had red's: its next life says it
 * again. */
static void test_who_died_after_its_answer(void)
{
    run_begin();
    answer_with(letter("green", 1, "red", "hello"), 0);
    red_dies(1);
    EXPECT("");
    story_register("red", "p-red2");
    story_match("p-red2");
    EXPECT("red welcome 0"); /* what waits for it is its first step's */
    roster_say(true, 1, "p-green p-red2");
    EXPECT("p-red2@-1");
    story_up_from("p-red2", "red", 0);
    EXPECT("p-red2@0; red #1 green/1 hello; p-green@0; sim@0");
}

/* The broker has ended step 0, and the simulator does not know that yet. */
static void test_who_died_when_the_step_had_ended(void)
{
    run_begin();
    answer_with(letter("green", 1, "red", "hello"), 0);
    answer("red", 0);
    EXPECT("p-red@0; red #1 green/1 hello; p-green@0; sim@0");
    red_dies(0);
    answer("green", 1);
    EXPECT("");
    red_returns(1);
    EXPECT("p-red2@0; red #1 green/1 hello"); /* once more, to its next life */
    story_up_from("p-red2", "red", 1);
    EXPECT("p-green@1; p-red2@1; sim@1");
}

static void test_a_process_joins_a_run(void)
{
    run_begin();
    story_join("blue");
    (void)story_collect();
    answer("green", 0);
    roster_say(true, 0, "p-green p-red p-blue");
    EXPECT("p-blue@-1"); /* the others have had it */
    answer("blue", 0);
    EXPECT("");
    answer("red", 0);
    EXPECT("p-green@0; p-red@0; p-blue@0; sim@0");
}

static void test_the_end_of_lock_step(void)
{
    run_begin();
    story_gone("p-green");
    answer_with(letter("red", 1, "operator,green", "half a step"), 0);
    story_send("operator", 1, "red", "hi");
    roster_say(false, 1, "");
    EXPECT("operator #1 red/1 half a step; red #1 operator/1 hi; red 1-1 stored");
    CU_ASSERT_STRING_EQUAL(story_member("green"), "green absent p-green");
    answer_with(letter("red", 2, "operator", "free"), 7);
    EXPECT("operator #2 red/2 free");
    story_state("red", muster_STATE_SUSPENDED);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red suspended p-red");
}

static void test_another_run(void)
{
    run_begin();
    answer("green", 0);
    answer("red", 0);
    EXPECT("p-green@0; p-red@0; sim@0");
    roster_say(false, 1, "");
    roster_say(true, 0, "p-green p-red");
    EXPECT("p-green@-1; p-red@-1; sim@-1");
    roster_say(true, 5, "p-green p-red"); /* from the middle */
    EXPECT("p-green@4; p-red@4; sim@4");
}

static void test_due_and_expiry_count_steps(void)
{
    run_begin();
    muster_Mail due = letter("red", 1, "green", "at 0.2 s");
    due.due_ns = (int64_t)(200 * MS);
    muster_Mail first = letter("operator", 1, "green", "at 0.1 s");
    first.due_ns = (int64_t)(100 * MS);
    muster_Mail short_lived = letter("operator", 2, "red", "for 0.1 s");
    short_lived.ttl_ns = 100 * MS;
    story_mail(first);
    story_mail(short_lived);
    story_tick(5000 * MS); /* the wall's time does not matter */
    answer_with(due, 0);
    story_up("green", 0, muster_STATE_RUNNING, NULL, 0, 0);
    EXPECT("p-green@0; green #1 operator/1 at 0.1 s; p-red@0; red #1 operator/2 for 0.1 s; "
           "red 1-1 stored; sim@0; outside operator/1; outside operator/2");
    short_lived.seq = 3;
    story_mail(short_lived);
    story_up("red", 1, muster_STATE_SUSPENDED, NULL, 0, 1);
    answer("green", 1);
    EXPECT("operator 2-2 delivered; operator 3-3 stored; p-green@1; "
           "green #2 red/1 at 0.2 s; p-red@1; sim@1; outside operator/3");
    story_up("red", 2, muster_STATE_RUNNING, NULL, 0, 0); /* too late by one step */
    answer("green", 2);
    EXPECT("operator 3-3 expired; p-green@2; p-red@2; sim@2");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
}

static void test_no_resending_in_lock_step(void)
{
    run_begin();
    answer_with(letter("red", 1, "green", "hello"), 0);
    answer("green", 0);
    EXPECT("p-green@0; green #1 red/1 hello; p-red@0; sim@0");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
    story_tick(10000 * MS);
    EXPECT("");
    roster_say(false, 1, "");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 11000 * MS);
}

static void test_a_lost_reader_is_given_its_step_again(void)
{
    run_begin();
    answer_with(letter("red", 1, "green", "hello"), 0);
    answer("green", 0);
    EXPECT("p-green@0; green #1 red/1 hello; p-red@0; sim@0");
    broker_matched(story.b, "p-green", false, 0);
    story_match("p-green");
    EXPECT("p-green@0; green #1 red/1 hello; green welcome 0");
}

static void test_a_question_in_a_step(void)
{
    run_begin();
    muster_Mail m = letter("red", 1, "broker", "green");
    m.layer = 2;
    m.performative = words("lookup");
    answer_with(m, 0);
    EXPECT("");
    m.src = words("operator"); /* from outside, at once, without shifting red's numbers */
    story_mail(m);
    EXPECT("operator #1 broker/4611686018427387905 member green robot running alpha here 1; "
           "operator 1-1 delivered");
    answer("green", 0);
    EXPECT("p-red@0; red #1 broker/1 member green robot running alpha here 0; red 1-1 delivered; "
           "p-green@0; sim@0");
}

static void test_limit_outside_mails_in_one_step(void)
{
    enum { EXTRA = 10, MAX = 1024 };
    run_begin();
    for (uint64_t i = 1; i <= MAX + EXTRA; i++) {
        story_send("operator", i, "sim-is-no-agent,red", "m");
    }
    for (int64_t step = 0; step < 2; step++) {
        const char *process;
        muster_Delivery d;
        answer("green", step);
        answer("red", step);
        uint32_t outside = 0;
        while (broker_next(story.b, &process, &d)) {
            outside += d.outside._length;
            broker_delivered(story.b, 0);
        }
        CU_ASSERT_EQUAL(outside, step == 0 ? MAX : EXTRA);
    }
}

/* --- what is refused ------------------------------------------------------------------------ */

static void answer_with_two(const char *name, int64_t step)
{
    static uint64_t seq;
    muster_Mail mails[2];
    for (int i = 0; i < 2; i++) {
        mails[i] = letter(name, ++seq, "green", "m");
    }
    story_up(name, step, muster_STATE_RUNNING, mails, 2, 0);
    seq = 0;
}

/* The store has room for three mails more.  @return what the two senders are told */
static const char *share_what_is_left(bool red_first)
{
    run_begin();
    struct quota_use *all = &story.b->quotas.all[QUOTA_INSIDE];
    all->mails = MU_MAILS_MAX / 2 - MU_MAILS_MAX / 2 / 64 - 3;
    answer_with_two(red_first ? "red" : "green", 0);
    EXPECT("");
    answer_with_two(red_first ? "green" : "red", 0);
    CU_ASSERT_EQUAL(story_status().box_full, 1);
    return story_collect();
}

static void test_a_full_store_refuses_in_the_order_of_names(void)
{
    for (int red_first = 0; red_first < 2; red_first++) {
        const char *told = share_what_is_left(red_first);
        CU_ASSERT_PTR_NOT_NULL(
            strstr(told, "green #1 green/1 m; green #2 green/2 m; green #3 red/1 m; p-red@0; "
                         "red 2-2 box-full; sim@0"));
    }
}

static void test_what_waits_outside_takes_nothing_of_those_inside(void)
{
    run_begin();
    story_join("blue");
    story_state("blue", muster_STATE_SUSPENDED);
    for (uint64_t i = 1; i <= MU_MAILS_MAX; i++) {
        story_send("operator", i, i % 2 ? "blue" : "operator", "flood");
    }
    CU_ASSERT_TRUE(story_status().over_share > MU_MAILS_MAX / 2);
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_INSIDE].mails, 0);
    (void)story_collect();
    answer_with(letter("red", 1, "green", "hello"), 0);
    answer("green", 0);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "green #1 red/1 hello; p-red@0; sim@0"));
}

/* Red writes to one outside who acknowledges nothing, or everything.  @return what red is told */
static const char *write_outside(bool acknowledged)
{
    static char told[4096];
    enum { STEPS = MU_MAILS_MAX / 200 + 8 };
    static muster_Mail mails[100];
    uint64_t seq = 0;
    struct mu_text t;
    mu_text_init(&t, told, sizeof told);
    run_begin();
    uint32_t operator= registry_find(&story.b->registry, "operator");
    for (int64_t step = 0; step < STEPS; step++) {
        for (int i = 0; i < 100; i++) {
            mails[i] = letter("red", ++seq, i == 99 ? "green,operator" : "operator", "m");
        }
        story_up("red", step, muster_STATE_RUNNING, mails, 100, 0);
        story_up("green", step, muster_STATE_RUNNING, NULL, 0, (uint64_t)step);
        for (const char *c = story_collect(); (c = strstr(c, "; red ")); c++) {
            mu_text_format(&t, "%.*s", (int)strcspn(c + 2, ";") + 2, c);
        }
        CU_ASSERT_TRUE(story.b->quotas.all[QUOTA_INSIDE].mails <= 2);
        if (acknowledged) {
            story_ack("operator", mailbox_box(&story.b->mailbox, operator)->acked + 100);
        }
    }
    return told;
}

static void test_whoever_acknowledges_outside_makes_no_room_inside(void)
{
    static char told[4096];
    (void)mu_text_copy(told, sizeof told, write_outside(true));
    CU_ASSERT_STRING_EQUAL(write_outside(false), told);
    CU_ASSERT_TRUE(story_status().over_share + story_status().box_full > 0);
    CU_ASSERT_PTR_NULL(strstr(told, "box-full"));
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL(s.sent, s.delivered + s.waiting + s.box_full + s.over_share);
}

/* The store has no room for mail to those outside. */
static void test_mail_that_is_refused_outside_arrives_inside(void)
{
    run_begin();
    story.b->quotas.all[QUOTA_OUTSIDE].mails = MU_MAILS_MAX;
    answer_with(letter("red", 1, "green,operator", "one"), 0);
    answer_with(letter("green", 1, "operator", "two"), 0);
    EXPECT("p-green@0; green #1 red/1 one; green 1-1 stored; p-red@0; red 1-1 stored; sim@0");
    CU_ASSERT_EQUAL(story_status().box_full, 2);
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_INSIDE].mails, 1);
    story_up("green", 1, muster_STATE_RUNNING, NULL, 0, 1);
    answer("red", 1);
    (void)story_collect();
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_INSIDE].mails, 0);
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_OUTSIDE].mails, MU_MAILS_MAX);
    CU_ASSERT_EQUAL(story_status().stored, 0);
}

/* Outside, boxes are emptied by the wall clock: inside, nobody is told how that went. */
static void test_boxes_outside_tell_nothing_inside(void)
{
    run_begin();
    uint32_t operator= registry_find(&story.b->registry, "operator");
    mailbox_box(&story.b->mailbox, operator)->limits = (struct box_limits){.mails = 1};
    answer_with(letter("red", 1, "operator", "one"), 0);
    answer_with(letter("green", 1, "operator", "two"), 0);
    EXPECT("operator #1 green/1 two; p-green@0; green 1-1 stored; p-red@0; red 1-1 stored; sim@0");
    CU_ASSERT_EQUAL(story_status().box_full, 1);
    story_ack("operator", 1);
    answer("green", 1);
    answer("red", 1);
    EXPECT("p-green@1; p-red@1; sim@1");
}

static char large[MU_CONTENT_MAX + 1];

/* A process may bring so much in a step, whoever came before it. */
static void test_limit_bytes_of_a_step(void)
{
    enum { ROOM = MU_STEP_BYTES_MAX / 4 * 3 / 2 / POOL_RECORD_MAX, SENT = ROOM + 3 };
    static muster_Mail mails[MU_OUTBOX_MAX];
    memset(large, 'x', MU_CONTENT_MAX);
    run_begin();
    uint32_t sent = SENT < MU_OUTBOX_MAX ? SENT : MU_OUTBOX_MAX;
    for (uint32_t i = 0; i < sent; i++) {
        mails[i] = letter("red", i + 1, "green", large);
    }
    CU_ASSERT_EQUAL_FATAL(sent, MU_OUTBOX_MAX); /* two processes have room for all they can say */
    roster_say(true, 0, "p-green p-red p-a p-b");
    (void)story_collect();
    story_up("red", 0, muster_STATE_RUNNING, mails, sent, 0);
    CU_ASSERT_EQUAL(story_status().over_share,
                    MU_OUTBOX_MAX - MU_STEP_BYTES_MAX / 4 * 3 / 4 / POOL_RECORD_MAX);
    CU_ASSERT_EQUAL(story.b->steps.turns[registry_find(&story.b->registry, "red")].mails.count,
                    MU_STEP_BYTES_MAX / 4 * 3 / 4 / POOL_RECORD_MAX);
}

/* From outside, each sender has its share of what waits for the step. */
static void test_limit_bytes_from_outside(void)
{
    enum { LONE = MU_STEP_BYTES_MAX / 4 / 2 / POOL_RECORD_MAX };
    memset(large, 'x', MU_CONTENT_MAX);
    run_begin();
    story_join("blue");
    (void)story_collect();
    for (uint64_t i = 1; i <= LONE + 1; i++) {
        story_send("operator", i, "red", large);
    }
    CU_ASSERT_EQUAL(story_status().over_share, 1);
    story_send("blue", 1, "red", large);
    CU_ASSERT_EQUAL(story_status().over_share, 1);
    CU_ASSERT_EQUAL(story.b->steps.outside_use.mails, LONE + 1);
    answer("red", 0);
    answer("green", 0);
    CU_ASSERT_EQUAL(story.b->steps.outside_use.bytes, 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the barrier", test_the_barrier},
        {"the counters of the last step are kept", test_the_counters_of_the_last_step_are_kept},
        {"an answer that acknowledges to another life",
         test_an_answer_that_acknowledges_to_another_life},
        {"a repeated answer is dropped", test_a_repeated_answer_is_dropped},
        {"outside mail waits for the step", test_outside_mail_waits_for_the_step},
        {"replays come in with their step", test_replays_come_in_with_their_step},
        {"an untrusted directive from outside", test_an_untrusted_directive_from_outside},
        {"states come from acts", test_states_come_from_acts},
        {"a reason hides no state", test_a_reason_hides_no_state},
        {"white pages change between steps", test_white_pages_of_a_step_do_not_show_outsiders},
        {"onlookers are not shown", test_white_pages_of_a_step_do_not_show_onlookers},
        {"who looks on speaks from outside, in its turn",
         test_who_looks_on_speaks_from_outside_in_its_turn},
        {"who looks on speaks to its like at once", test_who_looks_on_speaks_to_its_like_at_once},
        {"a step goes on without who looked on", test_a_step_goes_on_without_who_looked_on},
        {"deaths are the simulator's business", test_deaths_are_the_simulators_business},
        {"the missing one is dropped", test_the_missing_one_is_dropped},
        {"a step is held until who died is back", test_a_step_is_held_until_who_died_is_back},
        {"numbers of who died", test_numbers_of_who_died},
        {"receipts of who died", test_receipts_of_who_died},
        {"who died after its answer", test_who_died_after_its_answer},
        {"who died when the step had ended", test_who_died_when_the_step_had_ended},
        {"a process joins a run", test_a_process_joins_a_run},
        {"the end of lock step", test_the_end_of_lock_step},
        {"another run", test_another_run},
        {"due and expiry count steps", test_due_and_expiry_count_steps},
        {"no resending in lock step", test_no_resending_in_lock_step},
        {"a lost reader is given its step again", test_a_lost_reader_is_given_its_step_again},
        {"a question in a step", test_a_question_in_a_step},
        {"limit: outside mails in one step", test_limit_outside_mails_in_one_step},
        {"a full store refuses in the order of names",
         test_a_full_store_refuses_in_the_order_of_names},
        {"what waits outside takes nothing of those inside",
         test_what_waits_outside_takes_nothing_of_those_inside},
        {"whoever acknowledges outside makes no room inside",
         test_whoever_acknowledges_outside_makes_no_room_inside},
        {"mail that is refused outside arrives inside",
         test_mail_that_is_refused_outside_arrives_inside},
        {"boxes outside tell nothing inside", test_boxes_outside_tell_nothing_inside},
        {"limit: bytes of a step", test_limit_bytes_of_a_step},
        {"limit: bytes from outside", test_limit_bytes_from_outside},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/lockstep", tests);
}
