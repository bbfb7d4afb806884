/* SPDX-License-Identifier: Apache-2.0 */
/* What a broker has from another one, and what it tells it: a neighbour that says what a test
 * makes it say, and a disk. */
#include "broker/names/names.h"
#include "disk_story.h"
#include "lockstep_story.h"

static uint64_t life = 3; /* of beta, that is heard */

/* A team, and beta, which says of one agent where it is. */
static void hear_of(const char *name, muster_State state)
{
    bool is_absent = state == muster_STATE_ABSENT;
    muster_Entry e = {.reason = words(""),
                      .name = words(name),
                      .kind = muster_KIND_AGENT,
                      .state = state,
                      .home = words(is_absent ? "" : "beta"),
                      .via = words(""),
                      .host = words("there"),
                      .since_wall_ns = 7};
    muster_Registration r = {.wire = muster_WIRE,
                             .process = words("broker.beta"),
                             .broker = words(""),
                             .incarnation = life,
                             .host = words("there"),
                             .is_broker = true};
    r.agents._buffer = &e;
    r.agents._length = r.agents._maximum = 1;
    broker_peers(story.b, 1, story.now_ns);
    broker_registration(story.b, &r, story.now_ns);
    story_match("broker.beta");
}

static void parcel_comes(uint64_t number, const char *src, uint64_t seq, muster_Level at)
{
    muster_Parcel p = {
        .box = words("green"), .number = number, .letter = letter(src, seq, "green", "m")};
    p.letter.level = at;
    muster_Delivery d = {
        .process = words("broker.alpha"), .broker = words("beta"), .broker_incarnation = 3};
    d.parcels._buffer = &p;
    d.parcels._length = d.parcels._maximum = 1;
    broker_delivery(story.b, &d, story.now_ns);
}

/* @return the last number that is acknowledged to beta now, or 0 */
static uint64_t acknowledged(void)
{
    const char *peer;
    muster_Up up;
    uint64_t number = 0;
    while (broker_up_next(story.b, &peer, &up)) {
        number = up.acks._buffer[0].number;
        broker_up_sent(story.b);
    }
    return number;
}

static void test_durable_mail_for_a_name_that_others_have_told_of(void)
{
    team();
    hear_of("far", muster_STATE_ABSENT);
    log_mail(1, "far", "one");
    CU_ASSERT_TRUE(commit(true));
    EXPECT("roll call; red 1-1 stored");
    die_and_come_back(SECOND);
    CU_ASSERT_EQUAL(refused, 0);
    CU_ASSERT_EQUAL(story_status().waiting, 1);
    hear_of("far", muster_STATE_RUNNING);
    EXPECT("far #1 red/1 one; far welcome 0; roll call");
}

/* What waits for the end of a step is on no disk but the neighbour's. */
static void test_durable_mail_for_a_member_of_a_lock_step(void)
{
    team();
    story_join("green");
    story_join("blue");
    hear_of("far", muster_STATE_RUNNING);
    story_match("sim");
    roster_say(true, 0, "p-green");
    CU_ASSERT_TRUE(commit(true));
    (void)story_collect();
    parcel_comes(1, "far", 1, muster_LEVEL_SYNCED);
    CU_ASSERT_EQUAL(acknowledged(), 0);
    answer("green", 0);
    CU_ASSERT_TRUE(commit(true));
    CU_ASSERT_EQUAL(disk.rows_count, 1);
    CU_ASSERT_EQUAL(acknowledged(), 1);
    parcel_comes(2, "far", 2, muster_LEVEL_RAM);
    CU_ASSERT_EQUAL(acknowledged(), 2);
}

static void test_limit_a_sender_for_whose_name_there_is_no_room(void)
{
    char name[32];
    team();
    story_join("green");
    hear_of("far", muster_STATE_RUNNING);
    (void)story_collect();
    for (uint32_t i = 0; broker_takes_names(story.b); i++) {
        snprintf(name, sizeof name, "n%u", i);
        uint32_t agent = registry_add(&story.b->registry, name);
        story.b->registry.agents[agent].since_wall_ns =
            clock_wall_ns(&story.b->clock); /* not expired */
    }
    uint64_t full = story_status().box_full;
    parcel_comes(1, "stranger", 1, muster_LEVEL_RAM);
    CU_ASSERT_EQUAL(acknowledged(), 1);
    CU_ASSERT_EQUAL(story_status().box_full, full + 1);
    parcel_comes(2, "far", 1, muster_LEVEL_RAM);
    CU_ASSERT_EQUAL(acknowledged(), 2);
    EXPECT("green #1 far/1 m");
}

/* It was in flight when its time came, and goes out once more. */
static void test_what_a_neighbour_did_not_hear_in_time(void)
{
    const char *process;
    muster_Delivery d;
    uint64_t ttl_ns = 0;
    team();
    hear_of("far", muster_STATE_RUNNING);
    (void)story_collect();
    muster_Mail m = letter("red", 1, "far", "brief");
    m.ttl_ns = 5 * MS;
    story_mail(m);
    (void)story_collect();
    story_tick(10 * SECOND);
    while (broker_next(story.b, &process, &d)) {
        ttl_ns = d.parcels._length ? d.parcels._buffer[0].letter.ttl_ns : ttl_ns;
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_EQUAL(ttl_ns, 1);
}

/* It comes late, when beta's next life is not heard for a while. */
static void test_word_of_a_life_that_is_over(void)
{
    team();
    story_join("green");
    hear_of("far", muster_STATE_RUNNING);
    parcel_comes(1, "far", 1, muster_LEVEL_RAM);
    CU_ASSERT_PTR_NOT_NULL(strstr(story_collect(), "green #1 far/1 m"));
    story_ack("green", 1);
    story_gone("broker.beta");
    life = 2;
    hear_of("far", muster_STATE_RUNNING);
    life = 3;
    hear_of("far", muster_STATE_RUNNING);
    parcel_comes(1, "far", 1, muster_LEVEL_RAM);
    CU_ASSERT_PTR_NULL(strstr(story_collect(), "far/1"));
    CU_ASSERT_EQUAL(acknowledged(), 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a name that others have told of", test_durable_mail_for_a_name_that_others_have_told_of},
        {"a member of a lock step", test_durable_mail_for_a_member_of_a_lock_step},
        {"limit: a sender's name", test_limit_a_sender_for_whose_name_there_is_no_room},
        {"a life that is over", test_word_of_a_life_that_is_over},
        {"not heard in time", test_what_a_neighbour_did_not_hear_in_time},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/relay", tests);
}
