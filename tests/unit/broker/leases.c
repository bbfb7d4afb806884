/* SPDX-License-Identifier: Apache-2.0 */
/* Services and their subscribers across a lock step, a restart, other brokers, and a full table. */
#include "broker/control/parts.h"
#include "disk_story.h"
#include "pages_story.h"

/* --- leases that were said in a lock step ----------------------------------------------------- */

static bool is_offered(const char *service, const char *agent)
{
    uint32_t line = mu_pairs_find(&story.b->pages.services.pairs, service, agent);
    return line != MU_NONE && story.b->pages.services.at[line].holds;
}

static void lease_in_a_run(void)
{
    pages_seq = 0;
    team();
    story_join("green");
    story_match("sim");
    pages_roster(true, 0, "p-green", "p-red");
    (void)hear(false);
    muster_Mail m = to_broker("green", "advertise", "mapper \"\" 600");
    answer_step("green", 0, &m);
    answer_step("red", 0, NULL);
    (void)hear(false);
    CU_ASSERT_TRUE(is_offered("mapper", "green"));
    CU_ASSERT_TRUE(commit(true));
}

static void test_a_lease_of_a_run_outlives_the_broker(void)
{
    lease_in_a_run();
    die_and_come_back(SECOND);
    story_join("green");
    story_tick(SECOND);
    CU_ASSERT_TRUE(is_offered("mapper", "green"));
    story_tick(590 * SECOND);
    CU_ASSERT_TRUE(is_offered("mapper", "green"));
    story_tick(20 * SECOND);
    CU_ASSERT_FALSE(is_offered("mapper", "green"));
}

static void test_a_lease_of_a_run_holds_at_a_neighbour(void)
{
    const char *process;
    muster_Delivery d;
    static muster_Offer offer;
    static char service[64], agent[64];
    bool had = false;
    lease_in_a_run();
    broker_peers(story.b, 1, story.now_ns);
    muster_Registration r = {.wire = muster_WIRE,
                             .process = words("broker.beta"),
                             .broker = words(""),
                             .incarnation = 7,
                             .host = words("there"),
                             .pid = 1,
                             .is_broker = true};
    broker_registration(story.b, &r, story.now_ns);
    story_match("broker.beta");
    while (broker_next(story.b, &process, &d)) {
        for (uint32_t i = 0; i < d.offers._length && strcmp(process, "broker.beta") == 0; i++) {
            offer = d.offers._buffer[i];
            snprintf(service, sizeof service, "%s", offer.service);
            snprintf(agent, sizeof agent, "%s", offer.agent);
            had = true;
        }
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_TRUE_FATAL(had);
    offer.service = service;
    offer.agent = agent;
    offer.attributes = words("");
    offer.origin = words("alpha");
    struct broker_options options = {
        .name = "beta", .incarnation = 7, .pid = 9, .wall_ns = WALL + story.now_ns};
    struct broker *beta = broker_kept(&options);
    muster_Delivery to = {
        .process = words("broker.beta"), .broker = words("alpha"), .broker_incarnation = 5};
    to.offers._buffer = &offer;
    to.offers._length = to.offers._maximum = 1;
    broker_delivery(beta, &to, 0);
    broker_tick(beta, SECOND);
    uint32_t line = mu_pairs_find(&beta->pages.services.pairs, "mapper", "green");
    CU_ASSERT_TRUE_FATAL(line != MU_NONE);
    CU_ASSERT_TRUE(beta->pages.services.at[line].holds);
}

/* --- subscribers ------------------------------------------------------------------------------ */

static void test_what_went_during_a_run_is_told_behind_it(void)
{
    pages_seq = 0;
    story_begin();
    story_join("red");
    story_join("green");
    story_join("blue");
    story_join("sim");
    (void)say("blue", "advertise", "mapper");
    HEARD("red: inform subscribe mapper; red: inform came mapper blue \"\"",
          say("red", "subscribe", "mapper"));
    pages_roster(true, 0, "p-green", "p-red");
    (void)hear(false);
    HEARD("blue: inform withdraw mapper", say("blue", "withdraw", "mapper"));
    pages_roster(false, 1, "p-green", "p-red");
    HEARD("red: inform went mapper blue", hear(true));
}

static void test_limit_who_is_away_is_told_what_went(void)
{
    pages_seq = 0;
    story_begin();
    story_join("red");
    story_join("blue");
    (void)say("blue", "advertise", "mapper");
    HEARD("red: inform subscribe mapper; red: inform came mapper blue \"\"",
          say("red", "subscribe", "mapper"));
    story_gone("p-red");
    (void)say("blue", "withdraw", "mapper");
    (void)say("blue", "advertise", "other");
    (void)say("blue", "withdraw", "other");
    for (int i = 0; i < MU_SERVICES_MAX - 1; i++) {
        char content[64];
        snprintf(content, sizeof content, "s%d", i);
        (void)say("blue", "advertise", content);
    }
    CU_ASSERT_EQUAL(story.b->pages.services.pairs.count, MU_SERVICES_MAX);
    story_register("red", "p-red");
    story_match("p-red");
    const char *all = hear(true);
    CU_ASSERT_PTR_NOT_NULL(strstr(all, "red: inform went mapper blue"));
}

/* --- a neighbour whose clock went back -------------------------------------------------------- */

static void beta_says(uint64_t incarnation)
{
    muster_Entry e = {.reason = words(""),
                      .name = words("zoe"),
                      .kind = muster_KIND_AGENT,
                      .state = muster_STATE_RUNNING,
                      .home = words("beta"),
                      .via = words(""),
                      .host = words("there"),
                      .since_wall_ns = 50};
    muster_Registration r = {.wire = muster_WIRE,
                             .process = words("broker.beta"),
                             .broker = words(""),
                             .incarnation = incarnation,
                             .host = words("there"),
                             .pid = 1,
                             .is_broker = true};
    r.agents._buffer = &e;
    r.agents._length = r.agents._maximum = 1;
    broker_registration(story.b, &r, story.now_ns);
}

static void test_a_neighbour_whose_clock_went_back(void)
{
    story_begin();
    broker_peers(story.b, 1, 0);
    beta_says(1000);
    CU_ASSERT_STRING_EQUAL(story_member("zoe"), "zoe running broker.beta");
    story_gone("broker.beta");
    CU_ASSERT_STRING_EQUAL(story_member("zoe"), "zoe absent broker.beta");
    for (int i = 0; i < 20;
         i++) { /* started again, without a store, when the clock had been set back */
        story_tick(1000 * MS);
        beta_says(900);
    }
    CU_ASSERT_STRING_EQUAL(story_member("zoe"), "zoe running broker.beta");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a lease and a restart", test_a_lease_of_a_run_outlives_the_broker},
        {"a lease and a neighbour", test_a_lease_of_a_run_holds_at_a_neighbour},
        {"gone during a run", test_what_went_during_a_run_is_told_behind_it},
        {"away when a line makes room", test_limit_who_is_away_is_told_what_went},
        {"a neighbour's clock", test_a_neighbour_whose_clock_went_back},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/leases", tests);
}
