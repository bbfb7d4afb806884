/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "pages_story.h"

static void team(void)
{
    story_begin();
    story_join("red");
    story_join("green");
    story_join("blue");
    (void)hear(true);
}

static void test_advertise_find_withdraw(void)
{
    team();
    HEARD("green: inform advertise mapper", say("green", "advertise", "mapper \"role=scout x=1\""));
    SHOWN("+mapper@green[role=scout x=1]");
    HEARD("blue: inform advertise mapper", say("blue", "advertise", "mapper"));
    HEARD("blue: inform advertise cook", say("blue", "advertise", "cook \"site=\\\"a\\\"\""));
    HEARD("red: inform services mapper blue \"\" mapper green \"role=scout x=1\"",
          say("red", "find-service", "mapper"));
    HEARD("red: inform services mapper green \"role=scout x=1\"",
          say("red", "find-service", "\"* x<3\""));
    HEARD("red: inform services cook blue \"site=\\\"a\\\"\"", say("red", "find-service", "cook"));
    HEARD("red: inform services", say("red", "find-service", " mapper near=5,5,1 "));
    HEARD("green: inform advertise mapper", say("green", "advertise", "mapper \"x=2\" 3.5"));
    SHOWN("+mapper@green[x=2]");
    HEARD("green: failure not-offered cook", say("green", "withdraw", "cook"));
    HEARD("green: inform withdraw mapper", say("green", "withdraw", "mapper"));
    SHOWN("-mapper@green");
    HEARD("green: failure not-offered mapper", say("green", "withdraw", "mapper"));
    HEARD("red: inform services mapper blue \"\"", say("red", "find-service", "mapper"));
}

static void test_malformed(void)
{
    static const char *const bad[][2] = {
        {"advertise", ""},           {"advertise", "a \"b\" c d"}, {"advertise", "a \"\" -1"},
        {"advertise", "a \"\" 0x1"}, {"advertise", "a \"\" nan"},  {"advertise", "a \"b"},
        {"find-service", ""},        {"find-service", "a b"},      {"find-service", "\"a\" b"},
        {"subscribe", "1"},          {"unsubscribe", "* x=>1"},    {"withdraw", "a b c"}};
    char want[64];
    team();
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(want, sizeof want, "red: not-understood %s", bad[i][0]);
        HEARD(want, say("red", bad[i][0], bad[i][1]));
    }
    HEARD("red: failure not-a-name \"a b\"", say("red", "advertise", "\"a b\""));
    HEARD("red: failure not-attributes a", say("red", "advertise", "a \"x\""));
    HEARD("red: failure not-subscribed \"a x=1\"", say("red", "unsubscribe", "a x=1"));
    CU_ASSERT_EQUAL(story_status().malformed, sizeof bad / sizeof bad[0] + 2);
    CU_ASSERT_EQUAL(story.b->pages.services.pairs.count, 0);
}

static void test_a_service_goes_and_comes_with_its_agent(void)
{
    team();
    (void)say("green", "advertise", "mapper \"a=1\"");
    story_gone("p-green");
    (void)hear(true);
    SHOWN("-mapper@green");
    HEARD("red: inform services", say("red", "find-service", "mapper"));
    story_register("green", "p-green");
    (void)hear(true);
    SHOWN("+mapper@green[a=1]");
}

static void test_leases(void)
{
    team();
    (void)say("green", "advertise", "mapper \"a=1\" 2.5");
    (void)say("blue", "advertise", "mapper \"\" 4");
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 2500 * MS);
    story_tick(2499 * MS);
    HEARD("green: inform advertise mapper", say("green", "advertise", "mapper \"a=2\" 2"));
    story_tick(1 * MS);
    HEARD("red: inform services mapper blue \"\" mapper green \"a=2\"",
          say("red", "find-service", "*"));
    CU_ASSERT_EQUAL(broker_deadline_ns(story.b), 4000 * MS);
    story_tick(1500 * MS);
    (void)hear(true);
    SHOWN("-mapper@blue");
    story_tick(498 * MS);
    HEARD("red: inform services mapper green \"a=2\"", say("red", "find-service", "*"));
    HEARD("blue: inform advertise mapper", say("blue", "advertise", "mapper \"b=1\" 0"));
    HEARD("blue: failure not-offered cook", say("blue", "withdraw", "cook"));
    story_tick(1000000 * MS);
    HEARD("red: inform services mapper blue \"b=1\"", say("red", "find-service", "*"));
}

static void test_subscriptions(void)
{
    team();
    (void)say("green", "advertise", "mapper \"x=1\"");
    HEARD("red: inform subscribe \"mapper x<3\"; red: inform came mapper green \"x=1\"",
          say("red", "subscribe", "mapper x<3"));
    HEARD("green: inform advertise mapper", say("green", "advertise", "mapper \"x=2\""));
    HEARD("red: inform went mapper green; green: inform advertise mapper",
          say("green", "advertise", "mapper \"x=4\""));
    HEARD("red: inform came mapper green \"x=2\"; green: inform advertise mapper",
          say("green", "advertise", "mapper \"x=2\" 1"));
    story_tick(1000 * MS);
    HEARD("red: inform went mapper green", hear(true));
    (void)say("blue", "advertise", "mapper \"x=0\"");
    story_gone("p-blue");
    HEARD("red: inform went mapper blue", hear(true));
    story_gone("p-red");
    story_register("blue", "p-blue");
    HEARD("", hear(true));
    story_register("red", "p-red"); /* what has changed meanwhile */
    HEARD("red: inform came mapper blue \"x=0\"", hear(true));
    HEARD("red: inform unsubscribe \"mapper x<3\"", say("red", "unsubscribe", "mapper x<3"));
    HEARD("blue: inform withdraw mapper", say("blue", "withdraw", "mapper"));
}

static void test_limit_subscriptions(void)
{
    char query[MU_QUERY_MAX + 1], want[MU_QUERY_MAX + 64];
    team();
    for (int i = 0; i < MU_SUBSCRIPTIONS_MAX; i++) {
        snprintf(query, sizeof query, "mapper x<%d", i);
        (void)say(i % 2 ? "red" : "blue", "subscribe", query);
    }
    HEARD("red: failure full cook", say("red", "subscribe", "cook"));
    story_gone("p-blue"); /* who is absent makes room */
    HEARD("red: inform subscribe cook", say("red", "subscribe", "cook"));
    CU_ASSERT_EQUAL(story.b->pages.subscriptions.count, MU_SUBSCRIPTIONS_MAX);
    snprintf(want, sizeof want, "red: inform came cook green \"\"; green: inform advertise cook");
    HEARD(want, say("green", "advertise", "cook"));
}

static void test_long_answers_come_in_several_mails(void)
{
    char content[MU_ATTRIBUTES_MAX + 64], attributes[MU_ATTRIBUTES_MAX + 1];
    team();
    memset(attributes, '"', sizeof attributes); /* each takes two bytes in an answer */
    memcpy(attributes, "a=", 2);
    attributes[MU_FIELD_MAX] = '\0';
    for (int i = 0; i < 150; i++) {
        struct mu_text t;
        mu_text_init(&t, content, sizeof content);
        mu_text_format(&t, "s%d \"", i);
        for (const char *c = attributes; *c; c++) {
            mu_text_format(&t, "%s%c", *c == '"' ? "\\" : "", *c);
        }
        mu_text_add(&t, "\"");
        (void)say("green", "advertise", content);
    }
    const char *answer = say("red", "find-service", "*");
    unsigned mails = 0, lines = 0;
    for (const char *at = answer; (at = strstr(at, "red: inform services")); at++) {
        mails++;
    }
    for (const char *at = answer; (at = strstr(at, " green ")); at++) {
        lines++;
    }
    CU_ASSERT_EQUAL(mails, 2);
    CU_ASSERT_EQUAL(lines, 150);
}

/* --- lines of other brokers, and room --------------------------------------------------------- */

static struct lines kept[2]; /* static: leak checkers see their memory */

static void test_merge(void)
{
    struct lines *s = &kept[0];
    struct said now = {.stamp_ns = 100, .origin = "here", .inside = true, .mail_ns = 7};
    struct line_word o = {.key = words("mapper"),
                          .agent = words("red"),
                          .present = true,
                          .attributes = words("x=1"),
                          .lease_ns = 60,
                          .stamp_ns = 80,
                          .origin = words("there")};
    lines_init(s, LINES_SERVICES);
    CU_ASSERT_EQUAL(lines_merge(s, &o, &now), MU_OK);
    CU_ASSERT_EQUAL(lines_merge(s, &o, &now), MU_EXISTS);
    uint32_t index = mu_pairs_find(&s->pairs, "mapper", "red");
    const struct line *line = &s->at[index];
    CU_ASSERT_EQUAL(s->offers[index].until_ns, 7 + 40); /* 20 of the lease are over */
    CU_ASSERT_EQUAL(line->stamp_ns, 80);
    CU_ASSERT_STRING_EQUAL(line->origin, "there");
    o.present = false;
    o.stamp_ns = 79;
    CU_ASSERT_EQUAL(lines_merge(s, &o, &now), MU_EXISTS);
    o.present = true;
    o.stamp_ns = 80; /* said at two brokers at once: the later name stands everywhere */
    o.origin = words("theme");
    CU_ASSERT_EQUAL(lines_merge(s, &o, &now), MU_EXISTS);
    o.origin = words("thorn");
    CU_ASSERT_EQUAL(lines_merge(s, &o, &now), MU_OK);
    CU_ASSERT_STRING_EQUAL(line->origin, "thorn");
    services_expire(s, 46);
    CU_ASSERT_TRUE(line->holds);
    services_expire(s, 47);
    CU_ASSERT_FALSE(line->holds);
    CU_ASSERT_EQUAL(s->soonest_ns, UINT64_MAX);
    o.present = true;
    o.stamp_ns = 90;
    o.attributes = words("x");
    CU_ASSERT_EQUAL(lines_merge(s, &o, &now), MU_MALFORMED);
    o.attributes = words("");
    CU_ASSERT_EQUAL(lines_merge(s, &o, &now), MU_OK);
}

static void test_limit_lines(void)
{
    struct lines *s = &kept[1];
    struct said said = {.stamp_ns = 1, .origin = "a", .inside = true};
    char name[MU_NAME_MAX + 1];
    struct line_word some = {.key = name, .agent = "red", .attributes = ""};
    struct line_word cook = {.key = "cook", .agent = "red", .attributes = ""};
    lines_init(s, LINES_SERVICES);
    for (int i = 0; i < MU_SERVICES_MAX; i++) {
        snprintf(name, sizeof name, "s%d", i);
        CU_ASSERT_PTR_NULL_FATAL(services_advertise(s, &some, &said));
    }
    CU_ASSERT_STRING_EQUAL(services_advertise(s, &cook, &said), "full");
    CU_ASSERT_PTR_NULL(services_withdraw(s, "s7", "red", &said));
    CU_ASSERT_STRING_EQUAL(services_advertise(s, &cook, &said), "full");
    s->told = s->changes.version;
    CU_ASSERT_PTR_NULL(services_advertise(s, &cook, &said));
    CU_ASSERT_EQUAL(mu_pairs_find(&s->pairs, "s7", "red"), MU_NONE);
    CU_ASSERT_EQUAL(mu_pairs_find(&s->by_agent, "red", "s7"), MU_NONE);
    CU_ASSERT_NOT_EQUAL(mu_pairs_find(&s->by_agent, "red", "cook"), MU_NONE);
}

/* While a subscriber is away a line that he was told of makes room for another one. */
static void test_a_line_that_makes_room_is_forgotten(void)
{
    struct lines *s;
    char name[MU_NAME_MAX + 1];
    struct line_word some = {.key = name, .agent = "away", .attributes = ""};
    team();
    (void)say("red", "subscribe", "*");
    (void)say("green", "advertise", "mapper");
    s = &story.b->pages.services;
    uint32_t line = mu_pairs_find(&s->pairs, "mapper", "green");
    story_gone("p-red");
    (void)say("green", "withdraw", "mapper");
    for (int i = 0; i < MU_SERVICES_MAX - 1; i++) {
        struct said said = view_said(story.b);
        snprintf(name, sizeof name, "s%d", i);
        CU_ASSERT_PTR_NULL_FATAL(services_advertise(s, &some, &said));
    }
    (void)hear(true);
    HEARD("green: inform advertise cook", say("green", "advertise", "cook"));
    CU_ASSERT_EQUAL(mu_pairs_find(&s->pairs, "cook", "green"), line);
    story_register("red", "p-red");
    HEARD("red: inform came cook green \"\"", hear(true));
}

/* More lines than one Delivery holds. */
static void test_many_lines_come_in_several_deliveries(void)
{
    char content[64];
    team();
    for (int i = 0; i < PAGES_OFFERS + 10; i++) {
        snprintf(content, sizeof content, "s%d", i);
        (void)say("green", "advertise", content);
    }
    story_match("p-red");
    uint32_t lines = 0, deliveries = 0;
    const char *process;
    muster_Delivery d;
    while (broker_next(story.b, &process, &d)) {
        lines += strcmp(process, "p-red") == 0 ? d.offers._length : 0;
        deliveries += d.offers._length > 0;
        broker_delivered(story.b, story.now_ns);
    }
    CU_ASSERT_EQUAL(lines, PAGES_OFFERS + 10);
    CU_ASSERT_EQUAL(deliveries, 2);
}

/* --- lock step -------------------------------------------------------------------------------- */

static void run_begin(void)
{
    team();
    (void)say("blue", "advertise", "mapper \"from=outside\"");
    (void)say("red", "subscribe", "mapper");
    story_match("sim");
    pages_roster(true, 0, "p-green", "p-red");
    (void)hear(false);
    SHOWN("-mapper@blue");
}

static void test_leases_count_simulated_time(void)
{
    run_begin();
    muster_Mail m = to_broker("green", "advertise", "mapper \"\" 0.2");
    answer_step("green", 0, &m);
    answer_step("red", 0, NULL);
    HEARD("red: inform came mapper green \"\"; green: inform advertise mapper", hear(false));
    SHOWN("+mapper@green[]");
    story_tick(5000 * MS); /* by the wall */
    HEARD("", hear(false));
    for (int64_t step = 1; step <= 2; step++) {
        CU_ASSERT_TRUE(story.b->pages.services
                           .at[mu_pairs_find(&story.b->pages.services.pairs, "mapper", "green")]
                           .holds);
        answer_step("green", step, NULL);
        answer_step("red", step, NULL);
    }
    HEARD("red: inform went mapper green", hear(false));
    SHOWN("-mapper@green");
}

static void test_outsiders_are_not_seen_inside(void)
{
    run_begin();
    HEARD("blue: inform advertise cook", say("blue", "advertise", "cook"));
    story_gone("p-blue");
    story_register("blue", "p-blue");
    (void)hear(false);
    muster_Mail m = to_broker("red", "find-service", "*");
    answer_step("red", 0, &m);
    m = to_broker("green", "advertise", "mapper");
    answer_step("green", 0, &m);
    HEARD("red: inform came mapper green \"\"; red: inform services mapper green \"\"; "
          "green: inform advertise mapper",
          hear(false));
    CU_ASSERT_PTR_NULL(strstr(shown, "+cook"));
    HEARD("blue: inform services cook blue \"\" mapper blue \"from=outside\" mapper green \"\"",
          say("blue", "find-service", "*"));
    pages_roster(false, 1, "p-green", "p-red");
    (void)hear(true);
    CU_ASSERT_PTR_NOT_NULL(strstr(heard, "red: inform came mapper blue"));
    CU_ASSERT_PTR_NOT_NULL(strstr(shown, "+cook@blue[]"));
}

static void test_an_agent_that_leaves_the_run_takes_its_services(void)
{
    run_begin();
    muster_Mail m = to_broker("green", "advertise", "mapper");
    answer_step("green", 0, &m);
    answer_step("red", 0, NULL);
    (void)hear(false);
    story_up("green", 1, muster_STATE_ABSENT, NULL, 0, 0);
    answer_step("red", 1, NULL);
    HEARD("red: inform went mapper green", hear(false));
    SHOWN("-mapper@green");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"advertise, find, withdraw", test_advertise_find_withdraw},
        {"malformed", test_malformed},
        {"a service goes and comes with its agent", test_a_service_goes_and_comes_with_its_agent},
        {"leases", test_leases},
        {"subscriptions", test_subscriptions},
        {"limit: subscriptions", test_limit_subscriptions},
        {"long answers come in several mails", test_long_answers_come_in_several_mails},
        {"merge", test_merge},
        {"limit: lines", test_limit_lines},
        {"a line that makes room is forgotten", test_a_line_that_makes_room_is_forgotten},
        {"many lines come in several deliveries", test_many_lines_come_in_several_deliveries},
        {"leases count simulated time", test_leases_count_simulated_time},
        {"outsiders are not seen inside", test_outsiders_are_not_seen_inside},
        {"an agent that leaves the run takes its services",
         test_an_agent_that_leaves_the_run_takes_its_services},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/services", tests);
}
