/* SPDX-License-Identifier: Apache-2.0 */
/* Durable mail while the disk fails: nobody is told or handed what is not there. */
#include "disk_story.h"

#include <unistd.h>

static void lockstep_of(const char *process)
{
    char *processes[] = {words(process)};
    muster_Roster r = {
        .simulator = words("sim"), .broker = words(""), .lockstep = true, .step_ns = 100 * MS};
    r.processes._buffer = processes;
    r.processes._length = 1;
    story_match("sim");
    broker_roster(story.b, &r, story.now_ns);
    (void)story_collect();
}

/* Admitted while the disk works, routed when it does not. */
static void test_what_waits_for_an_address_meets_a_failing_disk(void)
{
    team_with_resolver();
    log_mail(1, "near:2", "one");
    log_mail(2, "red", "two");
    (void)story_collect();
    story_ack("rita", 1);
    story_join("pink");
    CU_ASSERT_TRUE(commit(false));
    (void)story_collect();
    resolve_as("green red");
    CU_ASSERT_FALSE(commit(true));
    EXPECT("red 1-2 no-store; rita 2-2 delivered");
    CU_ASSERT_EQUAL(story_status().no_store, 2);
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(false));
    EXPECT("");
}

static void test_what_is_under_way_is_not_undone(void)
{
    team();
    story_join("blue");
    (void)story_collect();
    log_mail(1, "blue,green", "one");
    EXPECT("blue #1 red/1 one"); /* before the commit */
    CU_ASSERT_TRUE(commit(false));
    CU_ASSERT_EQUAL(story_status().waiting, 2);
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 1);
}

static void test_what_waits_for_a_step_meets_a_failing_disk(void)
{
    team();
    lockstep_of("p-red");
    log_mail(1, "green", "one");
    story_join("pink");
    (void)story_collect();
    CU_ASSERT_TRUE(commit(false));
    muster_Mail m = letter("red", 2, "green", "two");
    story_up("red", 0, muster_STATE_RUNNING, &m, 1, 0);
    CU_ASSERT_EQUAL(story_status().no_store, 1);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
}

/* What becomes of it outside is not told; that it is not there is. */
static void test_mail_out_of_a_lock_step_is_stored_when_it_is(void)
{
    team();
    lockstep_of("p-red");
    muster_Mail m = letter("red", 1, "green", "one");
    m.level = muster_LEVEL_LOGGED;
    story_up("red", 0, muster_STATE_RUNNING, &m, 1, 0);
    CU_ASSERT_TRUE(commit(false));
    EXPECT("p-red@0; red 1-1 no-store; sim@0");
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 0);
    m.seq = 2;
    story_up("red", 1, muster_STATE_RUNNING, &m, 1, 0);
    CU_ASSERT_TRUE(commit(true));
    EXPECT("p-red@1; red 2-2 stored; sim@1");
    story_register("green", "p-green");
    story_match("p-green");
    (void)story_collect();
    story_ack("green", 1);
    story_up("red", 2, muster_STATE_RUNNING, NULL, 0, 0);
    EXPECT("p-red@2; sim@2"); /* no last word */
}

/* @return how many mails go out, all of which are acknowledged */
static uint32_t take_all(void)
{
    const char *process;
    muster_Delivery d;
    uint32_t count = 0;
    uint64_t last = 0;
    while (broker_next(story.b, &process, &d)) {
        for (uint32_t i = 0; i < d.parcels._length; i++) {
            last = d.parcels._buffer[i].number;
        }
        count += d.parcels._length;
        broker_delivered(story.b, story.now_ns);
    }
    if (last > 0) {
        story_ack("green", last);
    }
    return count;
}

/* What a receiver may get again is a window of mails, and it remembers no more. */
static void test_one_window_goes_out_until_it_is_known_on_disk(void)
{
    team();
    for (uint64_t seq = 1; seq <= 3 * MU_WINDOW_MAX; seq++) {
        log_mail(seq, "green", "x");
    }
    CU_ASSERT_TRUE(commit(true));
    (void)story_collect();
    story_register("green", "p-green");
    story_match("p-green");
    CU_ASSERT_EQUAL(take_all(), MU_WINDOW_MAX);
    CU_ASSERT_TRUE(commit(false));
    CU_ASSERT_EQUAL(take_all(), 0);
    muster_Mail m = letter("red", 3 * MU_WINDOW_MAX + 1, "green", "brief");
    m.priority = 1;
    story_mail(m);
    CU_ASSERT_EQUAL(take_all(), 1); /* memory is enough for that */
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(false));
    CU_ASSERT_EQUAL(take_all(), 0);
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 2 * MU_WINDOW_MAX);
    CU_ASSERT_EQUAL(take_all(), MU_WINDOW_MAX);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(take_all(), MU_WINDOW_MAX);
}

/* --- what another life says of it ------------------------------------------------------------- */

static void log_again(uint64_t seq, const char *dst)
{
    muster_Mail m = letter("red", seq, dst, "again");
    m.level = muster_LEVEL_LOGGED;
    m.again = true;
    story_mail(m);
}

/* The broker dies before red has heard of anything. */
static void test_what_had_no_row_was_not_delivered(void)
{
    team();
    log_mail(1, "nobody", "one");
    log_mail(2, "green,nobody", "two");
    log_mail(3, "green", "three");
    CU_ASSERT_TRUE(commit(true));
    story_join("green");
    story_ack("green", 2);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 0);
    die_and_come_back(SECOND);
    story_join("red");
    log_again(1, "nobody");
    log_again(2, "green,nobody");
    log_again(3, "green");
    EXPECT("red 1-2 duplicate; red 3-3 delivered");
}

static void test_what_expired_was_not_delivered(void)
{
    team();
    muster_Mail m = letter("red", 1, "green", "one");
    m.level = muster_LEVEL_LOGGED;
    m.ttl_ns = SECOND;
    story_mail(m);
    log_mail(2, "green", "two");
    CU_ASSERT_TRUE(commit(true));
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(true));
    die_and_come_back(SECOND);
    story_join("red");
    log_again(1, "green");
    log_again(2, "green");
    EXPECT("red 1-1 duplicate; red 2-2 stored");
}

static void test_what_waits_for_a_step_goes_to_the_store_in_order(void)
{
    team();
    story_join("robo");
    lockstep_of("p-robo");
    (void)commit(true);
    log_mail(1, "robo", "one");  /* waits for the end of the step, */
    log_mail(2, "green", "two"); /* and so does this */
    send_at(muster_LEVEL_RAM, 3, "blue", "three");
    EXPECT("red 3-3 stored");
    (void)commit(true);
    CU_ASSERT_EQUAL(disk.rows_count, 0);
    die_and_come_back(SECOND);
    story_join("red");
    story_join("robo");
    lockstep_of("p-robo");
    log_again(1, "robo");
    log_again(2, "green");
    story_up("robo", 0, muster_STATE_RUNNING, NULL, 0, 0);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 2);
    EXPECT("p-robo@0; robo #1 red/1 again; sim@0; outside red/1; outside red/2; "
           "red 2-2 stored");
    log_mail(4, "green", "four"); /* nothing waits any more */
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 3);
}

/* --- senders that are let go of --------------------------------------------------------------- */

static void test_a_sender_that_was_away_is_told(void)
{
    team();
    story_send("red", 1, "nobody", "x");
    story_gone("p-red");
    story_send("red", 2, "nobody", "nobody hears this");
    log_mail(2, "green", "nor this");
    CU_ASSERT_FALSE(commit(true));
    story_tick(SECOND);
    story_register("red", "p-red");
    story_match("p-red");
    EXPECT("red 1-1 unknown-name; red welcome 1");
}

static void test_what_an_expelled_process_has_sent_is_dropped(void)
{
    char *processes[] = {words("p-pink"), words("p-red")};
    muster_Roster r = {
        .simulator = words("sim"), .broker = words(""), .lockstep = true, .step_ns = 100 * MS};
    r.processes._buffer = processes;
    r.processes._length = 2;
    team();
    story_join("pink");
    story_match("sim");
    broker_roster(story.b, &r, story.now_ns);
    (void)story_collect();
    uint64_t sent = story_status().sent;
    muster_Mail mails[] = {letter("red", 1, "pink,green", "x"), letter("red", 2, "nobody", "y")};
    story_up("red", 0, muster_STATE_RUNNING, mails, 2, 0);
    CU_ASSERT_EQUAL(story_status().stored, 2);
    r.processes._length = 1;
    broker_roster(story.b, &r, story.now_ns);
    EXPECT("red 1-2 dropped");
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL(s.stored, 0);
    CU_ASSERT_EQUAL(s.sent, sent + 3);
    CU_ASSERT_EQUAL(s.dropped, 2);
    CU_ASSERT_EQUAL(s.unknown_name, 1);
}

/* --- more than there is room for -------------------------------------------------------------- */

static bool restore(uint64_t i, const char *waiting)
{
    muster_Mail m = letter("red", i, "green", "x");
    m.level = muster_LEVEL_LOGGED;
    m.ttl_ns = 3600 * SECOND;
    struct journal_entry e = {.kind = JOURNAL_MAIL,
                              .row = i,
                              .letter = m,
                              .waiting = waiting,
                              .expires_wall_ns = WALL + 3600 * SECOND};
    return durable_restore(story.b, &e);
}

/* An earlier life can have had both accounts full, and no file more than that. */
static void test_a_file_with_too_much_mail(void)
{
    team();
    uint64_t taken = 0;
    while (taken < 2 * MU_MAILS_MAX && restore(taken + 1, "green")) {
        taken++;
    }
    CU_ASSERT_EQUAL(taken, QUOTA_MAILS_MAX);
    CU_ASSERT_EQUAL(story.b->expiry.count, QUOTA_MAILS_MAX);
    CU_ASSERT_EQUAL(story.b->journal.rows, QUOTA_MAILS_MAX + 1); /* which stays there */
    CU_ASSERT_EQUAL(story_status().waiting, QUOTA_MAILS_MAX);
    story_tick(3600 * SECOND);
    CU_ASSERT_EQUAL(story_status().waiting, 0);
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_OUTSIDE].mails, 0);
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_INSIDE].mails, 0);
}

static void test_a_file_with_mail_for_nobody(void)
{
    team();
    CU_ASSERT_FALSE(restore(1, "nobody"));
    CU_ASSERT_FALSE(restore(2, ""));
    CU_ASSERT_EQUAL(story_status().stored, 0);
    CU_ASSERT_EQUAL(story.b->quotas.all[QUOTA_OUTSIDE].mails, 0);
}

static void test_a_time_to_live_beyond_all_time(void)
{
    team();
    muster_Mail m = letter("red", 1, "green", "x");
    m.level = muster_LEVEL_LOGGED;
    m.ttl_ns = UINT64_MAX - WALL + 5;
    story_mail(m);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows[0].expires_wall_ns, INT64_MAX);
    die_and_come_back(SECOND);
    story_tick(1);
    CU_ASSERT_EQUAL(story_status().expired, 0);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
}

/* Others have filled the store when a lock step begins, and all mail has a time to live. */
static void test_a_lock_step_finds_the_store_full(void)
{
    enum { SENDERS = 70, BOXES = 8, EACH = 200 };
    char name[32];
    uint64_t seq = 0;
    story_begin();
    for (uint32_t i = 0; i < SENDERS + BOXES; i++) {
        snprintf(name, sizeof name, "s%u", i);
        story_join(name);
    }
    story_join("robo");
    muster_Mail m = letter(name, 1, "", "x");
    m.ttl_ns = 3600 * SECOND;
    for (uint32_t i = 0; i < MU_MAILS_MAX; i++) {
        char from[32], to[32];
        snprintf(from, sizeof from, "s%u", i % SENDERS);
        snprintf(to, sizeof to, "s%u", SENDERS + i % BOXES);
        m.src = from;
        m.dst = to;
        m.seq = i + 1;
        story_mail(m);
    }
    uint64_t before_ = story_status().waiting;
    CU_ASSERT_TRUE(before_ > MU_MAILS_MAX / 10 * 9);
    lockstep_of("p-robo");
    for (int64_t step = 0; step < 200; step++) {
        static muster_Mail mails[EACH];
        for (uint32_t i = 0; i < EACH; i++) {
            mails[i] = letter("robo", ++seq, "robo", "x");
            mails[i].ttl_ns = 3600 * SECOND;
        }
        story_up("robo", step, muster_STATE_RUNNING, mails, EACH, 0);
        mu_text_clear(&story.text);
        (void)story_collect();
    }
    CU_ASSERT_TRUE(story_status().waiting > before_);
    CU_ASSERT_TRUE(story_status().over_share > 0);
}

/* More directives are on disk than a window holds, the disk fails, and ordinary mail goes out in
 * intervals: the dispatcher has nothing that may go, and is done. */
static void test_directives_behind_the_window_with_an_interval(void)
{
    team();
    dispatch_set_interval(story.b, 100 * MS);
    story_join("operator");
    for (uint64_t i = 1; i <= MU_WINDOW_MAX + 20; i++) {
        muster_Mail m = directive("operator", i, "green", "x");
        m.level = muster_LEVEL_LOGGED;
        story_mail(m);
    }
    CU_ASSERT_TRUE(commit(true));
    (void)story_collect();
    log_mail(1, "green", "last");
    CU_ASSERT_TRUE(commit(false));
    story_register("green", "p-green");
    story_match("p-green");
    alarm(10);
    const char *heard = story_collect();
    alarm(0);
    CU_ASSERT_PTR_NOT_NULL(strstr(heard, "green #200 "));
    CU_ASSERT_PTR_NULL(strstr(heard, "green #201 "));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"what waits for an address", test_what_waits_for_an_address_meets_a_failing_disk},
        {"what waits for a step", test_what_waits_for_a_step_meets_a_failing_disk},
        {"what is under way is not undone", test_what_is_under_way_is_not_undone},
        {"mail out of a lock step", test_mail_out_of_a_lock_step_is_stored_when_it_is},
        {"what had no row", test_what_had_no_row_was_not_delivered},
        {"what expired", test_what_expired_was_not_delivered},
        {"to the store in order", test_what_waits_for_a_step_goes_to_the_store_in_order},
        {"a sender that was away", test_a_sender_that_was_away_is_told},
        {"an expelled process", test_what_an_expelled_process_has_sent_is_dropped},
        {"one window goes out", test_one_window_goes_out_until_it_is_known_on_disk},
        {"a file with too much mail", test_a_file_with_too_much_mail},
        {"a file with mail for nobody", test_a_file_with_mail_for_nobody},
        {"a time to live beyond all time", test_a_time_to_live_beyond_all_time},
        {"a lock step finds the store full", test_a_lock_step_finds_the_store_full},
        {"directives behind the window", test_directives_behind_the_window_with_an_interval},
        CU_TEST_INFO_NULL,
    };
    return suite_run("failing", tests);
}
