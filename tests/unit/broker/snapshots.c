/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "broker_story.h"

#define S 1000000000ull

static void host_join(const char *name)
{
    char process[MU_PROCESS_MAX + 1];
    snprintf(process, sizeof process, "p-%s", name);
    muster_Registration r = registration(name, process);
    entry_of(&r)->kind = muster_KIND_HOST;
    entry_of(&r)->no_broadcasts = true;
    broker_registration(story.b, &r, story.now_ns);
    story_match(process);
    (void)story_collect();
}

static muster_Trip trip(muster_TripWord word, const char *agent, uint64_t epoch, const char *host)
{
    return (muster_Trip){.word = word,
                         .agent = words(agent),
                         .asker = words(""),
                         .epoch = epoch,
                         .host = words(host),
                         .process = words(""),
                         .slot = story_slot(agent),
                         .reason = words(""),
                         .text = words("")};
}

/* An Up of a process with a word in it; of its one agent, if it has a name. */
static void say(const char *process, const char *agent, int64_t step, muster_Trip t)
{
    struct one_up u;
    one_up(&u, agent, process, NULL, 0, 0);
    u.up.step = step;
    u.up.acts._length = agent[0] != '\0';
    u.up.trips = (dds_sequence_muster_Trip){._length = 1, ._buffer = &t};
    broker_up(story.b, &u.up, story.now_ns);
}

static void deposit(const char *process, const char *agent, uint64_t epoch, const char *host,
                    int64_t step)
{
    muster_Trip t = trip(muster_TRIP_DEPOSIT, agent, epoch, host);
    t.state = muster_STATE_RUNNING;
    t.text = words("capsule");
    say(process, agent, step, t);
}

/* An agent's process answers a step and wants a new agent on a host. */
static void want_new(const char *process, const char *asker, const char *name, const char *host,
                     int64_t step)
{
    muster_Trip t = trip(muster_TRIP_NEW, name, 0, host);
    t.asker = words(asker);
    t.state = muster_STATE_RUNNING;
    t.text = words("capsule");
    say(process, asker, step, t);
}

static void refuse(const char *process, const char *agent, uint64_t epoch, const char *why)
{
    muster_Trip t = trip(muster_TRIP_REFUSED, agent, epoch, "");
    t.reason = words(why);
    say(process, "", muster_STEP_NOW, t);
}

static void ready(const char *process, const char *agent, uint64_t epoch)
{
    say(process, "", muster_STEP_NOW, trip(muster_TRIP_READY, agent, epoch, ""));
}

static void answer(const char *name, int64_t step)
{
    story_up(name, step, muster_STATE_RUNNING, NULL, 0, 0);
}

static void roster_say(int64_t step, uint32_t count)
{
    char *processes[] = {words("p-green"), words("p-red"), words("p-north")};
    muster_Roster roster = {
        .simulator = words("sim"), .lockstep = count > 0, .step = step, .step_ns = 100 * MS};
    roster.processes._buffer = processes;
    roster.processes._length = count;
    broker_roster(story.b, &roster, story.now_ns);
}

/* green, red and the host north in lock step */
static void run_begin(void)
{
    story_begin();
    story_join("green");
    story_join("red");
    host_join("north");
    story_match("sim");
    (void)story_collect();
    roster_say(0, 3);
    EXPECT("p-green@-1; p-red@-1; p-north@-1; sim@-1");
}

/* red has set out in step 0 */
static void move_begin(void)
{
    run_begin();
    muster_Mail m = letter("green", 1, "red", "hello");
    story_up("green", 0, muster_STATE_RUNNING, &m, 1, 0);
    answer("north", 0);
    EXPECT("");
    deposit("p-red", "red", 1, "north", 0);
    EXPECT("p-north: red arrive 1 capsule");
}

/* What an agent's own process says of it, with the epoch that it has there. */
static void register_as(const char *process, const char *name, uint64_t epoch, muster_State state)
{
    muster_Registration r = registration(name, process);
    entry_of(&r)->epoch = epoch;
    entry_of(&r)->state = state;
    broker_registration(story.b, &r, story.now_ns);
}

static void test_the_step_waits_for_the_move(void)
{
    move_begin();
    register_as("p-north", "red", 1, muster_STATE_MOVING); /* it has made it */
    register_as("p-red", "red", 0, muster_STATE_RUNNING);  /* a heartbeat */
    EXPECT("");
    ready("p-north", "red", 1);
    EXPECT("p-green@0; p-red: red taken 1; p-north@0; red #1 green/1 hello; red welcome 0; "
           "sim: red taken 1; p-red@0; sim@0");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    register_as("p-red", "red", 0, muster_STATE_RUNNING); /* it has not heard of it yet */
    register_as("p-north", "red", 1, muster_STATE_RUNNING);
    story_tick(5 * S);
    EXPECT("");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
}

static void test_the_capsule_goes_when_the_host_has_answered_a_step(void)
{
    move_begin();
    CU_ASSERT_EQUAL(story.b->snapshots.count, 1);
    ready("p-north", "red", 1);
    (void)story_collect();
    register_as("p-north", "red", 1,
                muster_STATE_MOVING); /* it may die yet, with the step at hand */
    CU_ASSERT_EQUAL(story.b->snapshots.count, 1);
    struct one_up u;
    one_up(&u, "red", "p-north", NULL, 0, 0);
    u.up.step = 1;
    broker_up(story.b, &u.up, story.now_ns);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

static void test_a_host_refuses(void)
{
    move_begin();
    refuse("p-north", "red", 1, "not-welcome");
    EXPECT("p-red: red refused 1 not-welcome; p-green@0; p-north@0; sim@0; p-red@0; red #1 green/1 "
           "hello");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
    ready("p-north", "red", 1); /* after all */
    EXPECT("p-north: red refused 1 too-late");
    register_as("p-red", "red", 2, muster_STATE_RUNNING);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

static void test_a_host_dies(void)
{
    move_begin();
    story_gone("p-north");
    EXPECT("");
    story_tick(S);
    EXPECT("p-north: red refused 1 too-late; p-red: red refused 1 host-silent; p-green@0; sim@0; "
           "p-north@0; p-red@0; red #1 green/1 hello");
}

static void test_a_host_is_slow(void)
{
    move_begin();
    story_gone("p-north");
    story_tick(S / 2);
    ready("p-north", "red", 1);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
}

static void test_a_host_is_silent(void)
{
    move_begin();
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b) - story.now_ns, 3 * S);
    story_tick(3 * S);
    EXPECT("p-north: red refused 1 too-late; p-red: red refused 1 host-silent; p-green@0; sim@0; "
           "p-north@0; p-red@0; red #1 green/1 hello");
}

static void test_the_source_dies(void)
{
    move_begin();
    story_gone("p-red"); /* its mark does not reach who has been taken from it */
    ready("p-north", "red", 1);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    (void)story_collect();
    roster_say(1, 0);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
}

/* The clock stands still until there is another process for those of one that has died. */
static void roster_hold(const char *other)
{
    char *processes[] = {words("p-green"), words(other)};
    muster_Roster roster = {
        .simulator = words("sim"), .lockstep = true, .held = true, .step = 1, .step_ns = 100 * MS};
    roster.processes._buffer = processes;
    roster.processes._length = 2;
    broker_roster(story.b, &roster, story.now_ns);
}

/* red's process has died behind its answer. */
static void source_let_go(void)
{
    move_begin();
    story_gone("p-red");
    roster_hold("p-north");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    (void)story_collect();
}

static void test_the_source_is_let_go(void)
{
    source_let_go();
    ready("p-north", "red", 1);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    EXPECT("p-green@0; p-north@0; red #1 green/1 hello; red welcome 0; sim: red taken 1; sim@0");
}

static void test_the_source_is_back_before_the_host_is_ready(void)
{
    source_let_go();
    register_as("p-red2", "red", 0, muster_STATE_RUNNING);
    ready("p-north", "red", 1);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red2");
    EXPECT("p-green@0; p-north: red refused 1 gone; sim@0; p-north@0");
}

/* It has the name, and has lived through no step there. */
static void test_the_target_is_let_go(void)
{
    move_begin();
    ready("p-north", "red", 1);
    (void)story_collect();
    story_gone("p-north");
    roster_hold("p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-north");
    host_join("east"); /* which is no part of the run */
    story_tick(2 * S);
    say("p-east", "", muster_STEP_NOW, trip(muster_TRIP_WANTED, "", 0, "east"));
    say("p-red", "", muster_STEP_NOW, trip(muster_TRIP_WANTED, "", 0, "east"));
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "arrive"));
    host_join("north");
    say("p-north", "", muster_STEP_NOW, trip(muster_TRIP_WANTED, "", 0, "north"));
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "p-north: red arrive 1 capsule"));
}

/* Who had moved, and died with its host, is given its name by registering: no step has ended it. */
static void test_who_died_has_its_name_again(void)
{
    move_begin();
    ready("p-north", "red", 1);
    (void)story_collect();
    story_gone("p-north");
    roster_hold("p-red");
    register_as("p-red", "red", 1, muster_STATE_RUNNING);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
}

static void test_no_host(void)
{
    run_begin();
    answer("green", 0);
    answer("north", 0);
    deposit("p-red", "red", 1, "nowhere", 0);
    EXPECT("p-red: red refused 1 unknown-host; p-green@0; p-north@0; sim@0; p-red@0");
    answer("north", 1);
    deposit("p-red", "red", 1, "green", 1);
    EXPECT("p-red: red refused 1 unknown-host");
    answer("green", 1);
    EXPECT("p-green@1; p-red@1; p-north@1; sim@1");
    host_join("south"); /* which is not in the run */
    answer("north", 2);
    answer("green", 2);
    deposit("p-red", "red", 1, "south", 2);
    EXPECT("p-red: red refused 1 lock-step; p-green@2; p-north@2; sim@2; p-red@2");
}

static void test_the_end_of_the_run_ends_a_move(void)
{
    move_begin();
    roster_say(1, 0);
    CU_ASSERT_NOT_EQUAL(strstr(story_collect(), "p-red: red refused 1 lock-step"), NULL);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
}

/* --- new agents ------------------------------------------------------------------------------- */

static void test_a_new_agent(void)
{
    run_begin();
    muster_Mail m = letter("green", 1, "ruby", "too early");
    story_up("green", 0, muster_STATE_RUNNING, &m, 1, 0);
    answer("north", 0);
    want_new("p-red", "red", "ruby", "north", 0);
    EXPECT("p-north: ruby arrive 0 capsule");
    register_as("p-north", "ruby", 0, muster_STATE_MOVING); /* it has made it */
    EXPECT("");
    ready("p-north", "ruby", 0);
    EXPECT(
        "p-green@0; green 1-1 unknown-name; p-red: ruby taken 0; p-north@0; ruby welcome 0; sim: "
        "ruby taken 0; p-red@0; sim@0");
    CU_ASSERT_STRING_EQUAL(story_member("ruby"), "ruby running p-north");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
    story_tick(5 * S);
    EXPECT("");
}

/* The first in order of name of those who ask gets it, whoever is heard first. */
static void test_two_want_one_name(void)
{
    run_begin();
    want_new("p-red", "red", "ruby", "north", 0);
    want_new("p-green", "green", "ruby", "north", 0);
    answer("north", 0);
    EXPECT("p-north: ruby arrive 0 capsule; p-red: ruby refused 0 name-taken");
    ready("p-north", "ruby", 0);
    EXPECT("p-green: ruby taken 0; p-red@0; p-north@0; ruby welcome 0; sim: ruby taken 0; "
           "p-green@0; sim@0");
    want_new("p-red", "red", "ruby", "north", 1);
    answer("green", 1);
    answer("north", 1);
    EXPECT("p-red: ruby refused 0 name-taken; p-green@1; p-north@1; sim@1; p-red@1");
}

/* Nothing of one that is refused stays, not even its name. */
static void test_a_new_agent_is_refused(void)
{
    run_begin();
    answer("green", 0);
    answer("north", 0);
    want_new("p-red", "red", "ruby", "north", 0);
    (void)story_collect();
    refuse("p-north", "ruby", 0, "full");
    EXPECT("p-red: ruby refused 0 full; p-green@0; p-north@0; sim@0; p-red@0");
    CU_ASSERT_EQUAL(registry_find(&story.b->registry, "ruby"), MU_NONE);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
    ready("p-north", "ruby", 0); /* after all */
    EXPECT("p-north: ruby refused 0 too-late");
    answer("green", 1);
    answer("north", 1);
    want_new("p-red", "red", "ruby", "nowhere", 1);
    EXPECT("p-red: ruby refused 0 unknown-host; p-green@1; p-north@1; sim@1; p-red@1");
}

static void test_the_host_of_a_new_agent_dies(void)
{
    run_begin();
    answer("green", 0);
    answer("red", 0);
    want_new("p-north", "north", "ruby", "north", 0); /* it is launched */
    (void)story_collect();
    story_gone("p-north");
    story_tick(S);
    EXPECT("p-north: ruby refused 0 too-late; p-green@0; p-red@0; sim@0; p-north@0");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

static void test_the_end_of_the_run_ends_what_is_new(void)
{
    run_begin();
    want_new("p-red", "red", "ruby", "north", 0);
    roster_say(1, 0);
    CU_ASSERT_NOT_EQUAL(strstr(story_collect(), "p-red: ruby refused 0 lock-step"), NULL);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
    want_new("p-red", "red", "ruby", "north", muster_STEP_NOW);
    EXPECT("p-red: ruby refused 0 lock-step");
}

static void test_new_agents_of_strangers(void)
{
    run_begin();
    uint64_t malformed = story_status().malformed;
    want_new("p-red", "green", "ruby", "north", 0); /* in somebody else's name */
    CU_ASSERT_EQUAL(story_status().malformed, malformed + 1);
    want_new("p-green", "green", "observer", "north", 0);
    CU_ASSERT_EQUAL(story_status().malformed, malformed + 2);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

/* ruby comes to north in step 0, */
static void ruby_comes(void)
{
    run_begin();
    answer("green", 0);
    answer("north", 0);
    want_new("p-red", "red", "ruby", "north", 0);
    (void)story_collect();
    ready("p-north", "ruby", 0);
    (void)story_collect();
}

/* and ends in step 1; its process has said more of it by then. */
static void ruby_ends(void)
{
    answer("green", 1);
    answer("red", 1);
    struct one_up u;
    one_up(&u, "ruby", "p-north", NULL, 0, 0);
    u.act.state = muster_STATE_ABSENT;
    u.up.step = 1;
    broker_up(story.b, &u.up, story.now_ns);
}

/* The answer to a step may come before a registration that was written earlier. */
static void test_who_has_ended_does_not_come_back(void)
{
    ruby_comes();
    ruby_ends();
    CU_ASSERT_STRING_EQUAL(story_member("ruby"), "ruby absent p-north");
    register_as("p-north", "ruby", 0, muster_STATE_RUNNING);
    CU_ASSERT_STRING_EQUAL(story_member("ruby"), "ruby absent p-north");
    EXPECT("p-green@1; p-red@1; p-north@1; sim@1");
    CU_ASSERT_EQUAL(story.members, 4); /* ruby's end, to each of the three and to the simulator */
    answer("green", 2);
    answer("north", 2);
    want_new("p-red", "red", "ruby", "north", 2);
    EXPECT("p-north: ruby arrive 0 capsule");
    ready("p-north", "ruby", 0);
    CU_ASSERT_STRING_EQUAL(story_member("ruby"), "ruby running p-north");
}

/* Nor does it wait for the name of another one that has been called the same since. */
static void test_who_has_ended_is_nobodys_heir(void)
{
    ruby_comes();
    ruby_ends();
    (void)story_collect();
    register_as("p-green", "ruby", 0, muster_STATE_RUNNING);
    CU_ASSERT_STRING_EQUAL(story_member("ruby"), "ruby absent p-north");
    answer("green", 2);
    answer("north", 2);
    want_new("p-red", "red", "ruby", "north", 2);
    (void)story_collect();
    ready("p-north", "ruby", 0);
    (void)story_collect();
    register_as("p-green", "ruby", 0, muster_STATE_RUNNING);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX); /* nobody waits */
    roster_say(3, 0);
    (void)story_collect();
    register_as("p-green", "ruby", 0, muster_STATE_RUNNING); /* it is another one after all */
    CU_ASSERT_NOT_EQUAL(broker_deadline_ns(story.b), UINT64_MAX);
}

/* Whether the name was asked for before it was free or after, by the wall, changes nothing. */
static void test_who_waits_for_a_member_is_nobodys_heir(void)
{
    ruby_comes();
    story_match("stranger");
    register_as("p-green", "ruby", 0, muster_STATE_RUNNING);
    register_as("stranger", "ruby", 0, muster_STATE_RUNNING);
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 2);
    ruby_ends();
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 0);
    CU_ASSERT_STRING_EQUAL(story_member("ruby"), "ruby running stranger");
}

/* --- out of lock step ------------------------------------------------------------------------- */

static void free_begin(void)
{
    story_begin();
    story_join("red");
    host_join("north");
    register_as("p-red", "red", 1, muster_STATE_MOVING);
    (void)story_collect();
    deposit("p-red", "red", 1, "north", muster_STEP_NOW);
    EXPECT("p-north: red arrive 1 capsule");
}

static void test_a_move(void)
{
    free_begin();
    register_as("p-north", "red", 1, muster_STATE_MOVING);
    ready("p-north", "red", 1);
    EXPECT("p-red: red ready 1");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red moving p-red");
    story_leave("red", "p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red moving p-north");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 1);
    (void)story_collect();
    register_as("p-north", "red", 1, muster_STATE_RUNNING);
    EXPECT("p-red: red taken 1");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

/* Its first word from there may come before its state does. */
static void test_who_acknowledges_mail_lives(void)
{
    free_begin();
    story_send("red", 1, "red", "a note");
    register_as("p-north", "red", 1, muster_STATE_MOVING);
    ready("p-north", "red", 1);
    story_leave("red", "p-red");
    (void)story_collect();
    CU_ASSERT_EQUAL(story.b->snapshots.count, 1);
    struct one_up u;
    one_up(&u, "red", "p-north", NULL, 0, 1);
    broker_up(story.b, &u.up, story.now_ns); /* to no life of this broker */
    CU_ASSERT_EQUAL(story.b->snapshots.count, 1);
    story_hear(&u.up);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
    EXPECT("p-red: red taken 1");
}

static void test_a_host_dies_with_the_name(void)
{
    free_begin();
    register_as("p-north", "red", 1, muster_STATE_MOVING);
    ready("p-north", "red", 1);
    story_leave("red", "p-red");
    (void)story_collect();
    story_gone("p-north");
    EXPECT("p-red: red refused 1 host-absent");
    register_as("p-red", "red", 2, muster_STATE_MOVING);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red moving p-red");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

static void test_both_die(void)
{
    free_begin();
    story_gone("p-red");
    story_gone("p-north");
    (void)story_collect();
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 1);
    host_join("south");
    register_as("p-south", "red", 0, muster_STATE_ABSENT);
    CU_ASSERT_EQUAL(story.b->snapshots.count, 1);
    muster_Trip wanted = trip(muster_TRIP_WANTED, "", 0, "south");
    say("p-south", "", muster_STEP_NOW, wanted);
    EXPECT(""); /* somebody may take it back yet */
    story_tick(2 * S);
    say("p-north", "", muster_STEP_NOW, wanted); /* not who it says it is, and was missed */
    EXPECT("roll call");
    say("p-south", "", muster_STEP_NOW, wanted);
    EXPECT("p-south: red arrive 1 capsule");
    say("p-south", "", muster_STEP_NOW, wanted);
    EXPECT("");
    refuse("p-south", "red", 1, "full");
    say("p-south", "", muster_STEP_NOW, wanted);
    EXPECT("p-south: red arrive 1 capsule");
    ready("p-south", "red", 1);
    register_as("p-south", "red", 1, muster_STATE_MOVING);
    register_as("p-south", "red", 1, muster_STATE_RUNNING);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-south");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

/* Else an agent that nobody has would be nobody's for ever. */
static void test_a_silent_host_does_not_keep_it(void)
{
    free_begin();
    story_gone("p-red");
    story_gone("p-north");
    host_join("south");
    host_join("east");
    story_tick(2 * S);
    (void)story_collect();
    say("p-south", "", muster_STEP_NOW, trip(muster_TRIP_WANTED, "", 0, "south"));
    EXPECT("p-south: red arrive 1 capsule");
    story_tick(2 * S);
    say("p-east", "", muster_STEP_NOW, trip(muster_TRIP_WANTED, "", 0, "east"));
    EXPECT("");
    story_tick(2 * S);
    say("p-east", "", muster_STEP_NOW, trip(muster_TRIP_WANTED, "", 0, "east"));
    EXPECT("p-east: red arrive 1 capsule");
    ready("p-south", "red", 1);
    EXPECT("p-south: red refused 1 too-late");
    ready("p-east", "red", 1);
    register_as("p-east", "red", 1, muster_STATE_RUNNING);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-east");
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
}

static void test_an_older_copy_does_not_get_the_name(void)
{
    free_begin();
    story_gone("p-red");
    story_gone("p-north");
    host_join("south");
    register_as("p-red", "red", 5, muster_STATE_MOVING); /* who has set out since does */
    CU_ASSERT_EQUAL(story.b->snapshots.count, 0);
    deposit("p-red", "red", 6, "south", muster_STEP_NOW);
    story_gone("p-red");
    (void)story_collect();
    register_as("p-south", "red", 5, muster_STATE_MOVING);
    EXPECT("red: out of date");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    register_as("p-south", "red", 6, muster_STATE_MOVING);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red moving p-south");
}

static void test_limit_capsules(void)
{
    char name[16];
    story_begin();
    host_join("north");
    for (int i = 0; i <= MU_CAPSULES_MAX; i++) {
        char process[24];
        snprintf(name, sizeof name, "r%d", i);
        snprintf(process, sizeof process, "p-r%d", i);
        story_join(name);
        deposit(process, name, 1, "north", muster_STEP_NOW);
    }
    const char *said = story_collect();
    CU_ASSERT_NOT_EQUAL(strstr(said, "p-r64: r64 refused 1 depot-full"), NULL);
    CU_ASSERT_EQUAL(story.b->snapshots.count, MU_CAPSULES_MAX);
    refuse("p-north", "r0", 1, "full");
    register_as("p-r0", "r0", 2, muster_STATE_RUNNING); /* it goes on */
    CU_ASSERT_EQUAL(story.b->snapshots.count, MU_CAPSULES_MAX - 1);
}

static void test_words_of_strangers(void)
{
    free_begin();
    story_join("mallory");
    ready("p-mallory", "red", 1);
    EXPECT("p-mallory: red refused 1 too-late");
    refuse("p-mallory", "red", 1, "mine");
    ready("p-north", "red", 7);
    EXPECT("p-north: red refused 7 too-late");
    uint64_t malformed = story_status().malformed;
    deposit("p-mallory", "red", 9, "north", muster_STEP_NOW);
    CU_ASSERT_EQUAL(story_status().malformed, malformed + 1);
    EXPECT("");
    ready("p-north", "red", 1);
    EXPECT("p-red: red ready 1");
}

static void test_words_to_the_dead_make_room(void)
{
    free_begin();
    for (int i = 0; i < SNAPSHOT_WORDS; i++) {
        char name[16], process[24];
        snprintf(name, sizeof name, "m%d", i);
        snprintf(process, sizeof process, "p-m%d", i);
        story_join(name);
        ready(process, "nobody", 1);
        story_gone(process);
    }
    story_join("mallory");
    ready("p-mallory", "nobody", 1);
    CU_ASSERT_NOT_EQUAL(strstr(story_collect(), "p-mallory: nobody refused 1 too-late"), NULL);
    CU_ASSERT_EQUAL(story.b->snapshots.lost, 0);
}

/* The host has said that it is ready, and its claim comes behind that. */
static void test_a_name_is_kept_for_who_is_on_its_way(void)
{
    story_begin();
    story_join("red");
    host_join("north");
    story_match("p-thief");
    (void)story_collect();
    story_register_newcomer("red", "p-thief", 0);
    register_as("p-red", "red", 1, muster_STATE_MOVING);
    deposit("p-red", "red", 1, "north", muster_STEP_NOW);
    (void)story_collect();
    story_leave("red", "p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    story_register_newcomer("red", "p-north", 1);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    story_tick(1500 * MS);
    (void)story_collect();
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 0);
}

/* The registration in which it is on its way is replaced before the broker reads it. */
static void move_unseen(void)
{
    story_begin();
    story_join("red");
    host_join("north");
    (void)story_collect();
    deposit("p-red", "red", 1, "north", muster_STEP_NOW);
    EXPECT("p-north: red arrive 1 capsule");
}

static void test_who_was_not_seen_on_its_way_does_not_wait(void)
{
    move_unseen();
    story_register_newcomer("red", "p-north", 1);
    ready("p-north", "red", 1);
    story_leave("red", "p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
    move_unseen();
    story_leave("red", "p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red absent p-red");
    story_register_newcomer("red", "p-north", 1);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-north");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the step waits for the move", test_the_step_waits_for_the_move},
        {"the capsule goes when the host has answered a step",
         test_the_capsule_goes_when_the_host_has_answered_a_step},
        {"a host refuses", test_a_host_refuses},
        {"a host dies", test_a_host_dies},
        {"a host is slow", test_a_host_is_slow},
        {"a host is silent", test_a_host_is_silent},
        {"the source dies", test_the_source_dies},
        {"the source is let go", test_the_source_is_let_go},
        {"the source is back before the host is ready",
         test_the_source_is_back_before_the_host_is_ready},
        {"the target is let go", test_the_target_is_let_go},
        {"who died has its name again", test_who_died_has_its_name_again},
        {"no host", test_no_host},
        {"the end of the run ends a move", test_the_end_of_the_run_ends_a_move},
        {"a new agent", test_a_new_agent},
        {"two want one name", test_two_want_one_name},
        {"a new agent is refused", test_a_new_agent_is_refused},
        {"the host of a new agent dies", test_the_host_of_a_new_agent_dies},
        {"the end of the run ends what is new", test_the_end_of_the_run_ends_what_is_new},
        {"new agents of strangers", test_new_agents_of_strangers},
        {"who has ended does not come back", test_who_has_ended_does_not_come_back},
        {"who has ended is nobody's heir", test_who_has_ended_is_nobodys_heir},
        {"who waits for a member is nobody's heir", test_who_waits_for_a_member_is_nobodys_heir},
        {"a move", test_a_move},
        {"who was not seen on its way does not wait",
         test_who_was_not_seen_on_its_way_does_not_wait},
        {"who acknowledges mail lives", test_who_acknowledges_mail_lives},
        {"a host dies with the name", test_a_host_dies_with_the_name},
        {"both die", test_both_die},
        {"a silent host does not keep it", test_a_silent_host_does_not_keep_it},
        {"an older copy does not get the name", test_an_older_copy_does_not_get_the_name},
        {"limit: capsules", test_limit_capsules},
        {"words of strangers", test_words_of_strangers},
        {"words to the dead make room", test_words_to_the_dead_make_room},
        {"a name is kept for who is on its way", test_a_name_is_kept_for_who_is_on_its_way},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/depot", tests);
}
