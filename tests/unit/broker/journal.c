/* SPDX-License-Identifier: Apache-2.0 */
/* The journal against a disk that is an array, and brokers that die and come back. */
#include "disk_story.h"

/* --- tests ------------------------------------------------------------------------------------ */

static void test_a_receipt_follows_the_commit(void)
{
    team();
    log_mail(1, "green", "one");
    EXPECT("");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(level, muster_LEVEL_LOGGED);
    CU_ASSERT_EQUAL(disk.rows_count, 1);
    CU_ASSERT_STRING_EQUAL(disk.rows[0].waiting, "green");
    EXPECT("red 1-1 stored");
    send_at(muster_LEVEL_SYNCED, 2, "green", "two");
    send_at(muster_LEVEL_LOGGED, 3, "green", "three");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(level, muster_LEVEL_SYNCED);
    EXPECT("red 2-3 stored");
    send_at(muster_LEVEL_RAM, 4, "green", "four");
    CU_ASSERT_FALSE(commit(true)); /* costs the disk nothing */
    EXPECT("red 4-4 stored");
    story_register("green", "p-green");
    story_match("p-green");
    (void)story_collect();
    CU_ASSERT_FALSE(commit(true)); /* nor does an agent that is known */
    story_ack("green", 3);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(writes, 1); /* three rows in one go */
    CU_ASSERT_EQUAL(disk.rows_count, 0);
    EXPECT("red 1-3 delivered");
}

static void test_what_comes_and_goes_in_one_round_costs_no_row(void)
{
    team();
    muster_Mail m = letter("red", 1, "green", "brief");
    m.level = muster_LEVEL_LOGGED;
    m.ttl_ns = 5;
    story_mail(m);
    story_tick(5);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 0);
    EXPECT("red 1-1 expired");
}

static void test_names_and_mail_come_back(void)
{
    team();
    log_mail(1, "green", "one");
    log_mail(2, "blue,green", "two");
    log_mail(4, "green", "four");
    send_at(muster_LEVEL_RAM, 5, "green", "lost");
    CU_ASSERT_TRUE(commit(true));
    die_and_come_back(SECOND);
    CU_ASSERT_EQUAL(refused, 0);
    CU_ASSERT_STRING_EQUAL(story_member("green"), "green absent ");
    CU_ASSERT_EQUAL(story_status().waiting, 4);
    story_register("green", "p-green");
    story_match("p-green");
    EXPECT("green #1 red/1 one; green #2 red/2 two; green #3 red/4 four; green welcome 1048576");
    CU_ASSERT_EQUAL(story.b->registry.agents[registry_find(&story.b->registry, "red")].seq.durable,
                    4);
    /* Receipts are kept for a sender that is still to come back. */
    story_ack("green", 3);
    story_register("red", "p-red");
    story_match("p-red");
    EXPECT("red 1-1 delivered; red 4-4 delivered; red welcome 1048576");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 1);
    CU_ASSERT_STRING_EQUAL(disk.rows[0].waiting, "blue");
    die_and_come_back(SECOND);
    story_register("blue", "p-blue");
    story_match("p-blue");
    EXPECT("blue #1 red/2 two; blue welcome 1048576");
}

/* Mail to an address is kept when it is known for whom, and not before. */
static void test_a_kind_that_changes_is_kept(void)
{
    team();
    (void)commit(true);
    CU_ASSERT_FALSE(commit(true));
    muster_Registration r = registration("red", "p-red");
    entry_of(&r)->kind = muster_KIND_HOST;
    broker_registration(story.b, &r, story.now_ns);
    CU_ASSERT_TRUE(commit(true));
    broker_registration(story.b, &r, story.now_ns);
    CU_ASSERT_FALSE(commit(true));
    die_and_come_back(SECOND);
    uint32_t red = registry_find(&story.b->registry, "red");
    CU_ASSERT_EQUAL(story.b->registry.agents[red].is.kind, muster_KIND_HOST);
}

static void test_an_address_is_kept_when_it_is_resolved(void)
{
    team_with_resolver();
    log_mail(1, "near:2", "one");
    log_mail(2, "green", "two");
    CU_ASSERT_FALSE(commit(true));
    EXPECT("rita #1 broker/4611686018427387905 resolve \"near:2\" red");
    die_and_come_back(SECOND);
    story_join("red");
    story_join("rita");
    again(1, muster_LEVEL_LOGGED); /* what the earlier life has not kept is no duplicate */
    CU_ASSERT_TRUE(commit(true));
    EXPECT("red 1-1 stored");
    log_mail(2, "near:2", "two");
    CU_ASSERT_FALSE(commit(true));
    (void)story_collect();
    resolve_as("green blue");
    EXPECT("rita 2-2 delivered");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL_FATAL(disk.rows_count, 2);
    CU_ASSERT_STRING_EQUAL(disk.rows[1].dst, "near:2");
    CU_ASSERT_STRING_EQUAL(disk.rows[1].waiting, "blue,green");
    EXPECT("red 2-2 stored");
    die_and_come_back(SECOND); /* nobody is asked again */
    story_register("blue", "p-blue");
    story_match("p-blue");
    EXPECT("blue #1 red/2 two; blue welcome 1048576");
}

static void test_stored_mail_says_that_it_may_have_come_before(void)
{
    team();
    log_mail(1, "green", "one");
    CU_ASSERT_TRUE(commit(true));
    die_and_come_back(SECOND);
    story_register("green", "p-green");
    story_match("p-green");
    const char *process;
    muster_Delivery d;
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    CU_ASSERT_EQUAL_FATAL(d.parcels._length, 1);
    CU_ASSERT_TRUE(d.parcels._buffer[0].letter.again);
    broker_delivered(story.b, story.now_ns);
}

static void test_receipts_of_who_does_not_come_back_are_dropped(void)
{
    team();
    log_mail(1, "green", "one");
    CU_ASSERT_TRUE(commit(true));
    die_and_come_back(SECOND);
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 10 * SECOND);
    story_register("green", "p-green");
    story_match("p-green");
    (void)story_collect();
    story_ack("green", 1);
    story_tick(10 * SECOND);
    story_register("red", "p-red");
    story_match("p-red");
    EXPECT("red welcome 1048576");
}

static void test_duplicates_across_a_restart(void)
{
    team();
    log_mail(1, "green", "one");
    log_mail(2, "green", "two");
    send_at(muster_LEVEL_RAM, 3, "green", "three");
    log_mail(4, "blue", "four");
    CU_ASSERT_TRUE(commit(true));
    story_register("green", "p-green");
    story_match("p-green");
    (void)story_collect();
    story_ack("green", 1);
    CU_ASSERT_TRUE(commit(true));
    die_and_come_back(SECOND);
    story_register("red", "p-red");
    story_match("p-red");
    (void)story_collect();
    again(1, muster_LEVEL_LOGGED); /* acknowledged before */
    again(2, muster_LEVEL_LOGGED); /* waits */
    EXPECT("red 1-1 delivered; red 2-2 stored");
    again(1, muster_LEVEL_LOGGED); /* that was the last word */
    EXPECT("red 1-1 duplicate");
    again(3, muster_LEVEL_RAM); /* it went to the store with the one behind it */
    EXPECT("red 3-3 stored");
    again(5, muster_LEVEL_LOGGED); /* never reached the disk */
    CU_ASSERT_TRUE(commit(true));
    EXPECT("red 5-5 stored");
    again(5, muster_LEVEL_LOGGED);
    EXPECT("red 5-5 stored"); /* as it was told before, and perhaps not heard */
    CU_ASSERT_EQUAL(disk.rows_count, 4);
    /* A sender that begins anew has numbers of its own: nothing is taken for what was. */
    die_and_come_back(SECOND);
    story_register("red", "p-red");
    story_match("p-red");
    EXPECT("red welcome 1048576");
    log_mail(4, "green", "not marked: not looked up");
    CU_ASSERT_TRUE(commit(true));
    EXPECT("red 4-4 stored");
}

/* Mail that outlives the broker does not overtake what its sender has to send again. */
static void test_ram_before_durable_mail_goes_to_the_store_with_it(void)
{
    team();
    send_at(muster_LEVEL_RAM, 1, "green", "one");
    send_at(muster_LEVEL_RAM, 2, "blue", "two");
    CU_ASSERT_FALSE(commit(true));
    log_mail(3, "green", "three");
    send_at(muster_LEVEL_RAM, 4, "green", "four");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 3);
    send_at(muster_LEVEL_RAM, 5, "green", "five");
    CU_ASSERT_FALSE(commit(true));
    EXPECT("red 1-2 stored; red 4-4 stored; red 3-3 stored; red 5-5 stored");
    die_and_come_back(SECOND);
    CU_ASSERT_EQUAL(refused, 0);
    story_register("red", "p-red");
    story_match("p-red");
    (void)story_collect();
    for (uint64_t seq = 1; seq <= 4; seq++) {
        again(seq, seq == 3 ? muster_LEVEL_LOGGED : muster_LEVEL_RAM);
    }
    EXPECT("red 1-4 stored");
    story_register("green", "p-green");
    story_match("p-green");
    EXPECT("green #1 red/1 one; green #2 red/3 three; green #3 red/4 again; "
           "green welcome 1048576");
    story_ack("green", 3);
    EXPECT("red 1-1 delivered; red 3-4 delivered");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 1);
}

/* A disk that fails takes none of it, and RAM needs none. */
static void test_ram_stays_when_the_disk_fails(void)
{
    team();
    send_at(muster_LEVEL_RAM, 1, "green", "one");
    log_mail(2, "green", "two");
    CU_ASSERT_TRUE(commit(false));
    EXPECT("red 1-1 stored; red 2-2 no-store");
    story_tick(story.now_ns + 2 * SECOND);
    (void)commit(true);
    CU_ASSERT_EQUAL(disk.rows_count, 0);
    log_mail(3, "green", "three");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 2);
    story_register("green", "p-green");
    story_match("p-green");
    EXPECT("red 3-3 stored; green #1 red/1 one; green #2 red/3 three; green welcome 0");
}

/* What it was told before the broker died stands. */
static void test_a_last_word_is_not_followed_by_another(void)
{
    team();
    log_mail(1, "green,nobody", "one");
    CU_ASSERT_TRUE(commit(true));
    EXPECT("red 1-1 unknown-name");
    CU_ASSERT_STRING_EQUAL(disk.rows[0].waiting, "green/unknown-name");
    die_and_come_back(SECOND);
    CU_ASSERT_EQUAL(refused, 0);
    story_register("red", "p-red");
    story_match("p-red");
    (void)story_collect();
    again(1, muster_LEVEL_LOGGED); /* it has not heard of it */
    EXPECT("red 1-1 unknown-name");
    story_register("green", "p-green");
    story_match("p-green");
    (void)story_collect();
    story_ack("green", 1);
    EXPECT("");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 0);
}

static void test_what_one_box_dropped_stays_dropped(void)
{
    team();
    muster_Registration r = registration("blue", "p-blue");
    entry_of(&r)->full = muster_BOX_DROP_OLDEST;
    entry_of(&r)->box_mails = 1;
    broker_registration(story.b, &r, story.now_ns);
    story_gone("p-blue");
    log_mail(1, "green,blue", "one");
    CU_ASSERT_TRUE(commit(true));
    log_mail(2, "blue", "two");
    CU_ASSERT_TRUE(commit(true));
    EXPECT("red 1-2 stored");
    CU_ASSERT_STRING_EQUAL(disk.rows[0].waiting, "green/dropped");
    die_and_come_back(SECOND);
    CU_ASSERT_EQUAL(refused, 0);
    story_register("red", "p-red");
    story_match("p-red");
    story_register("green", "p-green");
    story_match("p-green");
    (void)story_collect();
    story_ack("green", 1);
    EXPECT("red 1-1 dropped");
}

static void test_a_failed_commit_is_undone(void)
{
    team();
    log_mail(1, "green", "kept");
    CU_ASSERT_TRUE(commit(true));
    (void)story_collect();
    log_mail(2, "green,blue", "two");
    log_mail(3, "green", "three");
    send_at(muster_LEVEL_RAM, 4, "green", "four");
    CU_ASSERT_TRUE(commit(false));
    EXPECT("red 4-4 stored; red 2-3 no-store");
    CU_ASSERT_EQUAL(story_status().no_store, 3);
    CU_ASSERT_EQUAL(story_status().waiting, 2);
    log_mail(5, "green", "refused at once");
    CU_ASSERT_FALSE(commit(true));
    EXPECT("red 5-5 no-store");
    /* Acknowledgements are not lost: they are written when that is possible again. */
    story_register("green", "p-green");
    story_match("p-green");
    EXPECT("green #1 red/1 kept; green #2 red/4 four; green welcome 0");
    story_ack("green", 2);
    EXPECT("red 1-1 delivered; red 4-4 delivered");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), SECOND);
    CU_ASSERT_FALSE(commit(true));
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(false));
    story_tick(SECOND);
    CU_ASSERT_EQUAL(disk.rows_count, 1);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 0);
    log_mail(6, "blue", "six");
    CU_ASSERT_TRUE(commit(true));
    EXPECT("red 6-6 stored");
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL(s.sent, s.delivered + s.waiting + s.no_store);
}

static void test_without_a_store(void)
{
    story_begin();
    story_join("red");
    story_join("green");
    log_mail(1, "green", "one");
    EXPECT("red 1-1 no-store");
    CU_ASSERT_FALSE(journal_wanted(story.b, &level));
    CU_ASSERT_PTR_NULL(journal_find(&story.b->journal, 1, 1));
    CU_ASSERT_EQUAL(story_status().no_store, 1);
}

static void test_time_goes_on_by_the_wall(void)
{
    team();
    muster_Roster free_run = {.simulator = words("sim"), .step = 100, .step_ns = 100 * MS};
    broker_roster(story.b, &free_run, story.now_ns); /* the run's time is 10 s */
    muster_Mail m = letter("red", 1, "green", "due at 14 s");
    m.level = muster_LEVEL_LOGGED;
    m.due_ns = (int64_t)(14 * SECOND);
    story_mail(m);
    m = letter("red", 2, "green", "for 4 s");
    m.level = muster_LEVEL_LOGGED;
    m.ttl_ns = 4 * SECOND;
    story_mail(m);
    m = letter("red", 3, "green", "for 6 s");
    m.level = muster_LEVEL_LOGGED;
    m.ttl_ns = 6 * SECOND;
    story_mail(m);
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.run_wall_ns, WALL - 10 * SECOND);
    die_and_come_back(2 * SECOND); /* 13 s */
    CU_ASSERT_EQUAL(refused, 0);
    CU_ASSERT_FALSE(commit(true));
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), SECOND);
    story_register("green", "p-green");
    story_match("p-green");
    EXPECT("green #1 red/2 for 4 s; green #2 red/3 for 6 s; green welcome 1048576");
    die_and_come_back(2 * SECOND); /* 15 s; nothing was acknowledged */
    broker_tick(story.b, 0);
    story_register("green", "p-green");
    story_match("p-green");
    EXPECT("green #1 red/1 due at 14 s; green #2 red/3 for 6 s; green welcome 1048576");
    CU_ASSERT_EQUAL(story_status().expired, 1);
}

static void test_numbers_are_reserved_ahead(void)
{
    team();
    CU_ASSERT_EQUAL(disk.names[0].reserved_seq, JOURNAL_RESERVE);
    send_at(muster_LEVEL_RAM, JOURNAL_RESERVE / 2, "green", "x");
    CU_ASSERT_FALSE(commit(true));
    send_at(muster_LEVEL_RAM, JOURNAL_RESERVE / 2 + 1, "green", "x");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.names[0].reserved_seq, JOURNAL_RESERVE / 2 + 1 + JOURNAL_RESERVE);
    send_at(muster_LEVEL_RAM, UINT64_MAX, "green", "x");
    CU_ASSERT_FALSE(commit(true));
}

static void restore_bad(struct journal_entry e)
{
    CU_ASSERT_FALSE(durable_restore(story.b, &e));
}

static void test_a_file_is_no_better_than_the_network(void)
{
    memset(&disk, 0, sizeof disk);
    life_begin(WALL);
    restore_bad((struct journal_entry){.kind = JOURNAL_AGENT, .name = "no name"});
    restore_bad((struct journal_entry){.kind = JOURNAL_AGENT, .name = "broker"});
    restore_bad((struct journal_entry){.kind = JOURNAL_AGENT, .name = ""});
    restore_bad((struct journal_entry){
        .kind = JOURNAL_AGENT, .name = "red", .agent_kind = (muster_Kind)77});
    restore_bad((struct journal_entry){
        .kind = JOURNAL_AGENT, .name = "red", .durable_seq = (uint64_t)INT64_MAX + 1});
    restore_bad((struct journal_entry){
        .kind = JOURNAL_AGENT, .name = "red", .failed_seq = (uint64_t)INT64_MAX + 1});
    restore_bad((struct journal_entry){
        .kind = JOURNAL_AGENT, .name = "red", .reserved_seq = (uint64_t)INT64_MAX + 1});
    restore_bad((struct journal_entry){.kind = JOURNAL_GONE, .row = 1});
    restore_bad((struct journal_entry){
        .kind = JOURNAL_LINE, .lines = LINES_GROUPS, .line = {.key = "", .agent = ""}});
    restore_bad((struct journal_entry){.kind = JOURNAL_LINE, .lines = (enum lines_kind)9});
    restore_bad((struct journal_entry){.kind = JOURNAL_CLOCK, .run_wall_ns = WALL + 1});
    struct journal_entry good = {.kind = JOURNAL_MAIL,
                                 .row = 1,
                                 .letter = letter("red", 1, "green", "x"),
                                 .waiting = "green"};
    good.letter.level = muster_LEVEL_LOGGED;
    struct journal_entry e = good;
    e.letter.level = muster_LEVEL_SYNCED + 1;
    restore_bad(e);
    e = good;
    e.letter.priority = 5;
    restore_bad(e);
    e = good;
    e.letter.src = words("broker");
    restore_bad(e);
    e = good;
    e.waiting = "nobody,,";
    restore_bad(e);
    e = good;
    e.waiting = "green/delivered";
    restore_bad(e);
    e.waiting = "green/";
    restore_bad(e);
    e = good;
    e.letter.seq = 0;
    restore_bad(e);
    e.letter.seq = (uint64_t)INT64_MAX + 1; /* no receiver would take it */
    restore_bad(e);
    e = good;
    e.row = 0;
    restore_bad(e);
    e.row = JOURNAL_NUMBER_MAX + 1;
    restore_bad(e);
    e.row = UINT64_MAX; /* the next one would be 0 */
    restore_bad(e);
    CU_ASSERT_EQUAL(story_status().waiting, 0);
    struct journal_entry green = {.kind = JOURNAL_AGENT, .name = "green"};
    CU_ASSERT_TRUE(durable_restore(story.b, &green));
    CU_ASSERT_TRUE(durable_restore(story.b, &good));
    e = good;
    e.row = 2;
    restore_bad(e); /* the same mail */
    CU_ASSERT_EQUAL(story_status().waiting, 1);
    CU_ASSERT_EQUAL(story.b->journal.rows, 2);
}

/* --- groups and services ---------------------------------------------------------------------- */

static void tell_broker(uint64_t seq, const char *performative, const char *content)
{
    muster_Mail m = letter("red", seq, "broker", content);
    m.layer = 2;
    m.performative = words(performative);
    story_mail(m);
}

static bool is_member(const char *group, const char *agent)
{
    uint32_t place = 0;
    const char *member;
    while ((member = groups_member(&story.b->pages.groups, group, false, &place))) {
        if (strcmp(member, agent) == 0) {
            return true;
        }
    }
    return false;
}

static void test_groups_and_services_come_back(void)
{
    team();
    (void)commit(true);
    tell_broker(1, "group-join", "scouts");
    tell_broker(2, "group-join", "cooks");
    tell_broker(3, "advertise", "mapper \"role=scout\" 60");
    CU_ASSERT_TRUE(commit(false));
    CU_ASSERT_STRING_EQUAL(disk.lines[LINES_GROUPS][0].key, "");
    story_tick(SECOND);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(writes, 5); /* two groups with a member each, a service */
    tell_broker(4, "group-leave", "cooks");
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(writes, 2);

    lines_resets = 0;
    die_and_come_back(SECOND);
    CU_ASSERT_EQUAL(refused, 0);
    CU_ASSERT_TRUE(is_member("scouts", "red"));
    CU_ASSERT_FALSE(is_member("cooks", "red"));
    CU_ASSERT_FALSE(groups_exists(&story.b->pages.groups, "cooks", false));
    const struct lines *s = &story.b->pages.services;
    uint32_t line = mu_pairs_find(&s->pairs, "mapper", "red");
    CU_ASSERT_NOT_EQUAL_FATAL(line, MU_NONE);
    CU_ASSERT_TRUE(s->at[line].holds);
    CU_ASSERT_STRING_EQUAL(s->offers[line].attributes, "role=scout");
    CU_ASSERT_FALSE(view_shows(story.b, line, false)); /* its agent is not back yet */
    story_register("red", "p-red");
    CU_ASSERT_TRUE(view_shows(story.b, line, false));

    /* Its lines may have other slots by now: what stood in the file is replaced. */
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(lines_resets, 2);
    CU_ASSERT_FALSE(commit(true));
    story_tick(30 * SECOND);
    CU_ASSERT_TRUE(view_shows(story.b, line, false));
    story_tick(30 * SECOND); /* a lease goes on while the broker is dead */
    CU_ASSERT_FALSE(view_shows(story.b, line, false));
    die_and_come_back(SECOND);
    CU_ASSERT_TRUE(is_member("scouts", "red"));
}

static void test_bad_lines_stay_on_disk(void)
{
    team();
    struct journal_entry good = {
        .kind = JOURNAL_LINE,
        .lines = LINES_GROUPS,
        .line = {
            .key = "scouts", .agent = "red", .present = true, .attributes = "", .origin = "alpha"}};
    struct journal_entry e = good;
    e.line.key = "not a name";
    restore_bad(e);
    e = good;
    e.line.agent = "*";
    restore_bad(e);
    e = good;
    e.lines = LINES_KINDS;
    restore_bad(e);
    e = good;
    e.line.stamp_ns = JOURNAL_NUMBER_MAX + 1;
    restore_bad(e);
    CU_ASSERT_FALSE(story.b->journal.lines[LINES_GROUPS].reset);
    CU_ASSERT_TRUE(durable_restore(story.b, &good));
    CU_ASSERT_TRUE(is_member("scouts", "red"));
}

/* --- a whole box ------------------------------------------------------------------------------ */

static void test_a_full_box_comes_back_in_order(void)
{
    enum { MAILS = 1000 };
    team();
    char content[32];
    for (uint64_t i = 1; i <= MAILS; i++) {
        snprintf(content, sizeof content, "%llu", (unsigned long long)i);
        log_mail(i, "green", content);
        if (i % 7 == 0) {
            CU_ASSERT_TRUE(commit(true));
        }
    }
    CU_ASSERT_TRUE(commit(true));
    die_and_come_back(SECOND);
    story_register("green", "p-green");
    story_match("p-green");
    uint64_t had = 0;
    const char *process;
    muster_Delivery d;
    while (had < MAILS) {
        CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
        for (uint32_t i = 0; i < d.parcels._length; i++) {
            CU_ASSERT_EQUAL(d.parcels._buffer[i].letter.seq, ++had);
        }
        broker_delivered(story.b, story.now_ns);
        story_ack("green", had);
        CU_ASSERT_TRUE(commit(true));
        CU_ASSERT_EQUAL(disk.rows_count, MAILS - had);
    }
}

/* For as long as a name that is held is waited for. */
static void test_names_are_kept_for_who_had_them(void)
{
    team();
    (void)commit(true);
    die_and_come_back(SECOND);
    story_match("p-new");
    story_register_newcomer("red", "p-new", 0);
    story_register_newcomer("white", "p-new", 0); /* nobody had that one */
    EXPECT("white welcome 0");
    story_tick(1000 * MS);
    story_register("red", "p-red");
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
    story_tick(500 * MS);
    EXPECT("red: held by another participant");
    die_and_come_back(SECOND);
    story_match("p-new");
    story_register_newcomer("red", "p-new", 0);
    story_tick(1500 * MS - 1);
    EXPECT("");
    story_tick(1);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-new");
    CU_ASSERT_EQUAL(story.b->claims.pool.live, 0);
}

static void red_say(uint64_t since_wall_ns, bool newcomer)
{
    muster_Registration r = registration("red", "p-red");
    entry_of(&r)->since_wall_ns = since_wall_ns;
    entry_of(&r)->newcomer = newcomer;
    broker_registration(story.b, &r, story.now_ns);
}

/* Red has come for whom the name was kept, and the next red of its process takes its slot. */
static void test_nobody_is_waited_for_who_has_come(void)
{
    team();
    die_and_come_back(SECOND);
    red_say(5, false);
    red_say(6, true);
    CU_ASSERT_STRING_EQUAL(story_member("red"), "red running p-red");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a receipt follows the commit", test_a_receipt_follows_the_commit},
        {"what comes and goes in one round", test_what_comes_and_goes_in_one_round_costs_no_row},
        {"names and mail come back", test_names_and_mail_come_back},
        {"a kind that changes is kept", test_a_kind_that_changes_is_kept},
        {"an address is kept when it is resolved", test_an_address_is_kept_when_it_is_resolved},
        {"stored mail may have come before", test_stored_mail_says_that_it_may_have_come_before},
        {"who does not come back", test_receipts_of_who_does_not_come_back_are_dropped},
        {"duplicates across a restart", test_duplicates_across_a_restart},
        {"ram before durable mail goes to the store with it",
         test_ram_before_durable_mail_goes_to_the_store_with_it},
        {"ram stays when the disk fails", test_ram_stays_when_the_disk_fails},
        {"a last word is not followed by another", test_a_last_word_is_not_followed_by_another},
        {"what one box dropped stays dropped", test_what_one_box_dropped_stays_dropped},
        {"a failed commit is undone", test_a_failed_commit_is_undone},
        {"without a store", test_without_a_store},
        {"time goes on by the wall", test_time_goes_on_by_the_wall},
        {"numbers are reserved ahead", test_numbers_are_reserved_ahead},
        {"a file is no better than the network", test_a_file_is_no_better_than_the_network},
        {"groups and services come back", test_groups_and_services_come_back},
        {"bad lines stay on disk", test_bad_lines_stay_on_disk},
        {"a full box comes back in order", test_a_full_box_comes_back_in_order},
        {"names are kept for who had them", test_names_are_kept_for_who_had_them},
        {"who has come", test_nobody_is_waited_for_who_has_come},
        CU_TEST_INFO_NULL,
    };
    return suite_run("journal", tests);
}
