/* SPDX-License-Identifier: Apache-2.0 */
/* Names and processes that come back: after a move, after a lock step, from another broker, and in
 * the same place. */
#include "broker/control/parts.h"
#include "lockstep_story.h"
#include "pages_story.h"

/* --- after a move ----------------------------------------------------------------------------- */

static void trip_say(const char *process, const char *agent, int64_t step, muster_TripWord word)
{
    muster_Trip t = {.word = word,
                     .agent = words("red"),
                     .asker = words(""),
                     .epoch = 1,
                     .host = words("north"),
                     .process = words(""),
                     .slot = story_slot("red"),
                     .reason = words(""),
                     .state = muster_STATE_RUNNING,
                     .text = words(word == muster_TRIP_DEPOSIT ? "capsule" : "")};
    struct one_up u;
    one_up(&u, agent, process, NULL, 0, 0);
    u.up.step = step;
    u.up.acts._length = agent[0] != '\0';
    u.act.state = muster_STATE_RUNNING;
    u.up.trips = (dds_sequence_muster_Trip){._length = 1, ._buffer = &t};
    broker_up(story.b, &u.up, story.now_ns);
}

/* What the process says of red where it sets out from. */
static void first_red_say(void)
{
    muster_Registration r = registration("red", "p-red");
    entry_of(&r)->since_wall_ns = 5;
    broker_registration(story.b, &r, story.now_ns);
}

/* red moves from p-red to p-north in lock step, and the run ends.
 * @param before  what happens before the host says that it has red, or NULL */
static void run_with_a_move(void (*before)(void))
{
    story_begin();
    first_red_say();
    story_match("p-red");
    muster_Registration r = registration("north", "p-north");
    entry_of(&r)->kind = muster_KIND_HOST;
    broker_registration(story.b, &r, story.now_ns);
    story_match("p-north");
    story_match("sim");
    (void)story_collect();
    roster_say(true, 0, "p-red p-north");
    (void)story_collect();
    answer("north", 0);
    trip_say("p-red", "red", 0, muster_TRIP_DEPOSIT);
    EXPECT("p-north: red arrive 1 capsule");
    if (before) {
        before();
    }
    trip_say("p-north", "", muster_STEP_NOW, muster_TRIP_READY);
    (void)story_collect();
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    story_up_from("p-red", "red", 1);
    story_up_from("p-north", "red", 1);
    (void)story_collect();
    roster_say(false, 2, "");
    (void)story_collect();
}

static void process_ends(const char *process)
{
    broker_matched(story.b, process, false, story.now_ns);
    story_gone(process);
}

/* Another process has the index among the places that the one had which red has left. */
static void test_a_name_that_had_moved_is_given_again(void)
{
    run_with_a_move(NULL);
    process_ends("p-red");
    process_ends("p-north");
    story_tick(60000 * MS);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-north");
    story_register_newcomer("red", "p-other", 0);
    story_match("p-other");
    story_tick(300 * MS);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-other");
}

/* --- names that a lock step has handed over --------------------------------------------------- */

/* What north's process says of the red that it has made. */
static void copy_say(void)
{
    muster_Registration r = registration("red", "p-north");
    entry_of(&r)->epoch = 1;
    entry_of(&r)->since_wall_ns = 7;
    broker_registration(story.b, &r, story.now_ns);
}

/* It is heard before the host says that red is ready, and not again before the run is over: of a
 * process with many parts, heartbeats repeat the first alone. */
static void test_who_was_handed_over_stays_who_it_is(void)
{
    run_with_a_move(copy_say);
    story_register_newcomer("red", "p-other", 0); /* it waits, for nothing */
    story_match("p-other");
    (void)story_collect();
    copy_say();
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    EXPECT("");
}

/* A registration has no step, and may be heard behind an answer, and a roster, that were written
 * later. */
static void test_late_word_of_who_was_left_behind(void)
{
    run_with_a_move(NULL);
    copy_say();
    first_red_say();
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    process_ends("p-north");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-north");
    story_register_newcomer("red", "p-red", 0); /* another one of that name */
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
}

/* --- after a lock step ------------------------------------------------------------------------ */

static void part_say(uint32_t part, const char *name)
{
    muster_Entry e = {.reason = words(""),
                      .name = words(name),
                      .kind = muster_KIND_ROBOT,
                      .state = muster_STATE_RUNNING,
                      .home = words(""),
                      .newcomer = true};
    muster_Registration r = {.wire = muster_WIRE,
                             .process = words("p-red"),
                             .part = part,
                             .broker = words(""),
                             .incarnation = 1,
                             .host = words("here"),
                             .pid = 1};
    r.agents._buffer = &e;
    r.agents._length = r.agents._maximum = 1;
    broker_registration(story.b, &r, story.now_ns);
}

/* Heartbeats repeat the first part of a process alone. */
static void test_a_name_that_a_lock_step_passed_over_is_asked_for(void)
{
    story_begin();
    story_match("sim");
    part_say(0, "red");
    part_say(1, "late");
    story_match("p-red");
    (void)story_collect();
    roster_say(true, 0, "p-red");
    (void)story_collect();
    struct one_up u;
    one_up(&u, "late", "p-red", NULL, 0, 0);
    u.act.state = muster_STATE_ABSENT;
    u.up.step = 0;
    broker_up(story.b, &u.up, story.now_ns);
    (void)story_collect();
    part_say(1, "late"); /* another one of that name */
    CU_ASSERT_STRING_EQUAL(story_member("late"), "late absent p-red");
    (void)story_collect();
    roster_say(false, 1, "");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "roll call"));
    part_say(1, "late");
    CU_ASSERT_STRING_EQUAL(story_member("late"), "late running p-red");
}

/* --- from another broker ---------------------------------------------------------------------- */

static void at_broker(const char *name, const char *broker, uint64_t incarnation)
{
    char process[64];
    snprintf(process, sizeof process, "p-%s", name);
    muster_Registration r = registration(name, process);
    r.broker = words(broker);
    r.incarnation = incarnation;
    broker_registration(story.b, &r, story.now_ns);
}

/* It has forgotten what this broker told it. */
static void test_who_was_at_another_broker_is_told_all_again(void)
{
    const char *process;
    muster_Delivery d;
    uint32_t members = 0, memberships = 0, offers = 0;
    pages_seq = 0;
    story_begin();
    story_join("red");
    story_join("green");
    (void)say("green", "advertise", "mapper");
    (void)say("green", "group-join", "scouts");
    at_broker("red", "beta", 2);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    (void)story_collect();
    at_broker("red", "alpha", 3);
    while (broker_next(story.b, &process, &d)) {
        bool is_red = strcmp(process, "p-red") == 0;
        members += is_red ? d.members._length : 0;
        memberships += is_red ? d.memberships._length : 0;
        offers += is_red ? d.offers._length : 0;
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_TRUE(members > 2);
    CU_ASSERT_EQUAL(memberships, 2);
    CU_ASSERT_EQUAL(offers, 1);
}

static void test_who_goes_to_another_broker_is_looked_at_no_more(void)
{
    story_begin();
    story_join("operator");
    story_join("green");
    muster_Glance g = {.word = muster_GLANCE_ASK,
                       .number = 1,
                       .asker = words("operator"),
                       .agent = words("green"),
                       .text = words("(facts)")};
    struct one_up u;
    one_up(&u, "", "p-operator", NULL, 0, 0);
    u.up.acts._length = 0;
    u.up.glances = (dds_sequence_muster_Glance){._length = 1, ._buffer = &g};
    broker_up(story.b, &u.up, story.now_ns);
    EXPECT("p-green: operator/1 green asks (facts)");
    at_broker("green", "beta", 2);
    (void)story_collect();
    CU_ASSERT_EQUAL(story.b->probes.count, 0);
}

/* --- in the same place ------------------------------------------------------------------------ */

/* An agent leaves, and the next of that name has its slot before anybody has said so. */
static void test_the_next_agent_of_a_slot_is_welcomed(void)
{
    story_begin();
    muster_Registration r = registration("red", "p-red");
    entry_of(&r)->since_wall_ns = 5;
    broker_registration(story.b, &r, story.now_ns);
    story_match("p-red");
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "red welcome"));
    broker_registration(story.b, &r, story.now_ns);
    EXPECT("");
    entry_of(&r)->since_wall_ns = 6;
    broker_registration(story.b, &r, story.now_ns);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "red welcome"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a name that had moved", test_a_name_that_had_moved_is_given_again},
        {"who was handed over", test_who_was_handed_over_stays_who_it_is},
        {"who was left behind", test_late_word_of_who_was_left_behind},
        {"a name passed over", test_a_name_that_a_lock_step_passed_over_is_asked_for},
        {"told all again", test_who_was_at_another_broker_is_told_all_again},
        {"looked at no more", test_who_goes_to_another_broker_is_looked_at_no_more},
        {"the next agent of a slot", test_the_next_agent_of_a_slot_is_welcomed},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/return", tests);
}
