/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "garble.h"
#include "pages_story.h"

static void team(void)
{
    story_begin();
    story_join("red");
    story_join("green");
    story_join("blue");
    (void)hear(true);
}

static void test_create_join_leave(void)
{
    team();
    HEARD("red: inform group-create scouts", say("red", "group-create", "scouts"));
    SHOWN("+scouts");
    HEARD("green: failure group-exists scouts", say("green", "group-create", "\"scouts\""));
    HEARD("green: inform group-join scouts", say("green", "group-join", "scouts"));
    SHOWN("+scouts/green");
    HEARD("green: inform group-join scouts", say("green", "group-join", "scouts"));
    SHOWN("");
    HEARD("red: failure not-a-member scouts", say("red", "group-leave", "scouts"));
    CU_ASSERT_EQUAL(story.b->counters.malformed, 0); /* a true answer to a good question */
    HEARD("red: failure unknown-group cooks", say("red", "group-leave", "cooks"));
    CU_ASSERT_EQUAL(story_status().malformed, 0); /* these are answers, no broken rules */
    HEARD("red: inform group-join cooks", say("red", "group-join", "cooks"));
    SHOWN("+cooks +cooks/red");
    HEARD("blue: inform group-join scouts", say("blue", "group-join", "scouts"));
    HEARD("red: inform groups cooks scouts", say("red", "groups", ""));
    HEARD("red: inform members-of scouts blue green", say("red", "members", "scouts"));
    HEARD("red: failure unknown-group miners", say("red", "members", "miners"));
    HEARD("green: inform group-leave scouts", say("green", "group-leave", "scouts"));
    SHOWN("-scouts/green");
    HEARD("blue: inform group-leave scouts", say("blue", "group-leave", "scouts"));
    SHOWN("-scouts/blue -scouts");
    HEARD("red: inform groups cooks", say("red", "groups", ""));
    HEARD("red: inform group-create scouts", say("red", "group-create", "scouts"));
}

static void test_changes_are_answered_when_asked(void)
{
    team();
    muster_Mail m = to_broker("red", "group-join", "scouts");
    m.reply_with = words("");
    story_mail(m);
    HEARD("", hear(true));
    SHOWN("+scouts +scouts/red");
    m = to_broker("red", "group-create", "scouts");
    m.reply_with = words("");
    story_mail(m);
    HEARD("", hear(true));
}

static void test_bad_names(void)
{
    team();
    HEARD("red: failure not-a-name \"a b\"", say("red", "group-join", "\"a b\""));
    HEARD("red: failure not-a-name \"1\"", say("red", "group-create", "1"));
    HEARD("red: failure not-a-name robots", say("red", "group-create", "robots"));
    HEARD("red: failure not-a-name all", say("red", "group-join", "all"));
    HEARD("red: failure not-a-name \"\\\"*\"", say("red", "group-leave", "\"\\\"*\""));
    CU_ASSERT_EQUAL(story_status().malformed, 5);
    HEARD("red: not-understood group-join", say("red", "group-join", ""));
    HEARD("red: not-understood group-join", say("red", "group-join", "a b c"));
    HEARD("red: not-understood group-join", say("red", "group-join", "(a)"));
    HEARD("red: not-understood members", say("red", "members", "\"open"));
    CU_ASSERT_EQUAL(story_status().malformed, 9);
    HEARD("red: failure not-a-name an-agent-with-a-long-name-000001",
          say("red", "group-join", "an-agent-with-a-long-name-000001"));
    CU_ASSERT_EQUAL(story.b->pages.groups.pairs.count, 0);
}

static void test_mail_to_a_group(void)
{
    team();
    (void)say("red", "group-join", "scouts");
    (void)say("green", "group-join", "scouts");
    (void)say("blue", "group-join", "scouts");
    story_gone("p-blue");
    story_send("red", ++pages_seq, "group:scouts", "gold");
    HEARD("green: red gold", hear(true));
    HEARD("green: inform group-leave scouts", say("green", "group-leave", "scouts"));
    story_register("blue", "p-blue"); /* a member while absent; green was one when it was sent */
    HEARD("blue: red gold", hear(true));
    story_send("red", ++pages_seq, "group:cooks", "gold");
    CU_ASSERT_EQUAL(story_status().unknown_name, 1);
    story_send("red", ++pages_seq, "role:cook", "gold");
    CU_ASSERT_EQUAL(story_status().unknown_name, 2);
    static const char *const bad[] = {"group:", "group:a b", "group:a,b",        ":a",     "1:a",
                                      "a:",     "near:2 5",  "red,group:scouts", "group:1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        uint64_t before = story_status().malformed;
        story_send("red", ++pages_seq, bad[i], "gold");
        CU_ASSERT_EQUAL(story_status().malformed, before + 1);
    }
}

static void test_a_new_process_is_told_all(void)
{
    team();
    (void)say("green", "group-join", "scouts");
    (void)say("blue", "group-join", "scouts");
    (void)say("blue", "group-leave", "scouts");
    story_match("p-red");
    (void)hear(true);
    SHOWN("+scouts +scouts/green -scouts/blue");
}

static void test_a_refused_delivery_is_told_again(void)
{
    const char *process;
    muster_Delivery d;
    team();
    story_mail(to_broker("red", "group-join", "scouts"));
    for (int i = 0; i < 3; i++) {
        CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
        broker_undelivered(story.b);
    }
    CU_ASSERT_FALSE(broker_next(story.b, &process, &d));
    story_tick(1 * MS);
    (void)hear(true);
    SHOWN("+scouts +scouts/red");
}

/* --- lines of other brokers ------------------------------------------------------------------- */

static struct lines kept[8]; /* static: leak checkers see their memory */

static mu_result merge(struct lines *g, const char *agent, bool joined, uint64_t stamp_ns,
                       const char *origin)
{
    struct line_word w = {"scouts", agent, joined, "", origin, 0, stamp_ns};
    return lines_merge(g, &w, &(struct said){.inside = true, .origin = "here"});
}

static bool has(const struct lines *g, const char *agent)
{
    uint32_t place = 0;
    const char *name;
    while ((name = groups_member(g, "scouts", false, &place)) && strcmp(name, agent) != 0) {
    }
    return name != NULL;
}

static void test_the_last_word_counts_in_any_order(void)
{
    static const struct {
        bool joined;
        uint64_t stamp_ns;
        const char *origin;
    } said[] = {{true, 5, "a"}, {false, 7, "a"}, {true, 7, "b"}, {false, 6, "c"}};
    static const int orders[][4] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {2, 0, 3, 1}, {1, 3, 0, 2}};
    for (int k = 0; k < 4; k++) {
        struct lines *g = &kept[k];
        lines_init(g, LINES_GROUPS);
        for (int i = 0; i < 4; i++) {
            const int s = orders[k][i];
            (void)merge(g, "red", said[s].joined, said[s].stamp_ns, said[s].origin);
        }
        CU_ASSERT_TRUE(has(g, "red"));
        CU_ASSERT_EQUAL(g->at[mu_pairs_find(&g->pairs, "scouts", "red")].stamp_ns, 7);
        CU_ASSERT_EQUAL(merge(g, "red", true, 7, "b"), MU_EXISTS);
        CU_ASSERT_EQUAL(merge(g, "red", false, 6, "z"), MU_EXISTS);
        CU_ASSERT_EQUAL(merge(g, "not a name", false, 6, "z"), MU_MALFORMED);
        /* What is said here is younger than all that was known here. */
        struct said now = {.stamp_ns = 1, .origin = "x", .inside = true};
        CU_ASSERT_PTR_NULL(groups_leave(g, "scouts", "red", &now));
        CU_ASSERT_FALSE(has(g, "red"));
        CU_ASSERT_EQUAL(merge(g, "red", true, 7, "z"), MU_EXISTS);
        CU_ASSERT_EQUAL(merge(g, "red", true, 9, "b"), MU_OK);
        CU_ASSERT_TRUE(groups_exists(g, "scouts", false));
    }
}

static void name_of(char name[MU_NAME_MAX + 1], const char *kind, unsigned number)
{
    snprintf(name, MU_NAME_MAX + 1, "%s%u", kind, number);
}

static void test_limit_lines(void)
{
    struct lines *g = &kept[4];
    struct said said = {.stamp_ns = 1, .origin = "a", .inside = true};
    char name[MU_NAME_MAX + 1];
    lines_init(g, LINES_GROUPS);
    for (unsigned i = 1; i < MU_MEMBERSHIPS_MAX; i++) {
        name_of(name, "m", i);
        CU_ASSERT_PTR_NULL_FATAL(groups_join(g, "scouts", name, &said));
    }
    CU_ASSERT_TRUE(lines_full(g));
    CU_ASSERT_STRING_EQUAL(groups_join(g, "scouts", "late", &said), "full");
    CU_ASSERT_STRING_EQUAL(groups_create(g, "cooks", &said), "full");
    CU_ASSERT_PTR_NULL(groups_leave(g, "scouts", "m7", &said));
    CU_ASSERT_STRING_EQUAL(groups_join(g, "scouts", "late", &said), "full");
    g->told = g->changes.version; /* everybody knows that m7 has left */
    CU_ASSERT_PTR_NULL(groups_join(g, "scouts", "late", &said));
    CU_ASSERT_TRUE(has(g, "late") && !has(g, "m7"));
    CU_ASSERT_EQUAL(mu_pairs_find(&g->pairs, "scouts", "m7"), MU_NONE);
}

/* There is room for the group and none for its first member: then there is no group. */
static void test_limit_a_new_group_has_no_room(void)
{
    struct lines *g = &kept[6];
    struct said said = {.stamp_ns = 1, .origin = "a", .inside = true};
    char name[MU_NAME_MAX + 1];
    lines_init(g, LINES_GROUPS);
    for (unsigned i = 2; i < MU_MEMBERSHIPS_MAX; i++) {
        name_of(name, "m", i);
        CU_ASSERT_PTR_NULL_FATAL(groups_join(g, "scouts", name, &said));
    }
    CU_ASSERT_STRING_EQUAL(groups_join(g, "cooks", "red", &said), "full");
    CU_ASSERT_FALSE(groups_exists(g, "cooks", true) || groups_exists(g, "cooks", false));
    CU_ASSERT_EQUAL(g->keys_now, 1);
}

static void test_limit_groups(void)
{
    struct lines *g = &kept[5];
    struct said said = {.stamp_ns = 1, .origin = "a", .inside = true};
    char name[MU_NAME_MAX + 1];
    lines_init(g, LINES_GROUPS);
    for (unsigned i = 0; i < MU_GROUPS_MAX; i++) {
        name_of(name, "g", i);
        CU_ASSERT_PTR_NULL_FATAL(groups_join(g, name, "red", &said));
    }
    CU_ASSERT_STRING_EQUAL(groups_join(g, "one-more", "red", &said), "full");
    CU_ASSERT_PTR_NULL(groups_join(g, "g5", "green", &said)); /* a group that is there */
    CU_ASSERT_PTR_NULL(groups_leave(g, "g9", "red", &said));
    CU_ASSERT_STRING_EQUAL(groups_create(g, "one-more", &said), "full");
    g->told = g->changes.version;
    CU_ASSERT_PTR_NULL(groups_create(g, "one-more", &said));
    CU_ASSERT_EQUAL(g->keys, MU_GROUPS_MAX);
    CU_ASSERT_FALSE(groups_exists(g, "g9", false));
}

static void test_changes_come_in_their_order(void)
{
    static struct changelog c;
    changelog_init(&c, 5);
    CU_ASSERT_EQUAL(changelog_after(&c, 0), MU_NONE);
    static const uint32_t touched[] = {3, 1, 4, 1, 3};
    for (int i = 0; i < 5; i++) {
        changelog_touch(&c, touched[i]);
    }
    CU_ASSERT_EQUAL(changelog_after(&c, 0), 4);
    CU_ASSERT_EQUAL(changelog_next(&c, 4), 1);
    CU_ASSERT_EQUAL(changelog_next(&c, 1), 3);
    CU_ASSERT_EQUAL(changelog_next(&c, 3), MU_NONE);
    CU_ASSERT_EQUAL(changelog_after(&c, 3), 1);
    CU_ASSERT_EQUAL(changelog_after(&c, 5), MU_NONE);
    changelog_remove(&c, 1);
    changelog_remove(&c, 1);
    CU_ASSERT_EQUAL(changelog_next(&c, 4), 3);
    changelog_remove(&c, 4);
    changelog_remove(&c, 3);
    CU_ASSERT_EQUAL(changelog_after(&c, 0), MU_NONE);
}

/* --- lock step -------------------------------------------------------------------------------- */

/* red and green inside, blue outside, a member from the start */
static void run_begin(void)
{
    team();
    (void)say("blue", "group-join", "old");
    story_match("sim");
    pages_roster(true, 0, "p-green", "p-red");
    (void)hear(false);
    SHOWN("+old +old/blue");
}

static void test_changes_take_effect_at_the_end_of_a_step(void)
{
    run_begin();
    muster_Mail m = to_broker("red", "group-join", "scouts");
    answer_step("red", 0, &m);
    HEARD("", hear(false));
    SHOWN("");
    m = letter("green", ++pages_seq, "group:scouts", "hi");
    answer_step("green", 0, &m); /* red comes after green: there is no such group yet */
    CU_ASSERT_EQUAL(story_status().unknown_name, 1);
    HEARD("red: inform group-join scouts", hear(false));
    SHOWN("+scouts +scouts/red");
    CU_ASSERT_EQUAL(
        story.b->pages.groups.at[mu_pairs_find(&story.b->pages.groups.pairs, "scouts", "red")]
            .stamp_ns,
        100 * MS);
}

/* What is said outside by the wall clock changes nothing inside. */
static void test_outsiders_shift_nothing_inside(void)
{
    run_begin();
    HEARD("blue: inform group-create scouts", say("blue", "group-create", "scouts"));
    HEARD("blue: inform group-join scouts", say("blue", "group-join", "scouts"));
    HEARD("blue: inform group-leave old", say("blue", "group-leave", "old"));
    HEARD("blue: inform groups scouts", say("blue", "groups", ""));
    muster_Mail m = to_broker("red", "group-create", "scouts");
    answer_step("red", 0, &m);
    m = letter("green", ++pages_seq, "group:old", "hi");
    answer_step("green", 0, &m);
    HEARD("red: inform group-create scouts", hear(false));
    CU_ASSERT_EQUAL(story_status().unknown_name, 0);
    CU_ASSERT_PTR_NULL(strstr(shown, "blue/"));
    CU_ASSERT_PTR_NOT_NULL(strstr(shown, "+scouts"));
    CU_ASSERT_PTR_NULL(strstr(shown, "-old "));
    CU_ASSERT_PTR_NULL(strstr(shown, "+scouts/blue"));
    m = to_broker("red", "members", "old");
    answer_step("red", 1, &m);
    m = to_broker("green", "members", "scouts");
    answer_step("green", 1, &m);
    HEARD("green: inform members-of scouts; red: inform members-of old blue", hear(false));
    m = letter("red", ++pages_seq, "group:scouts", "gold");
    answer_step("red", 2, &m);
    answer_step("green", 2, NULL);
    HEARD("blue: red gold", hear(false)); /* who is outside gets it all the same */

    pages_roster(false, 3, "p-green", "p-red"); /* the run is over: all see what is there */
    (void)hear(true);
    CU_ASSERT_PTR_NOT_NULL(strstr(shown, "-old/blue"));
    CU_ASSERT_PTR_NOT_NULL(strstr(shown, "+scouts/blue"));
    HEARD("red: inform members-of scouts blue", say("red", "members", "scouts"));
}

static void test_who_enters_the_run_brings_its_groups(void)
{
    run_begin();
    story_join("grey");
    (void)say("grey", "group-join", "new");
    muster_Roster roster = {
        .simulator = words("sim"), .lockstep = true, .step = 0, .step_ns = 100 * MS};
    char *processes[] = {words("p-green"), words("p-red"), words("p-grey")};
    roster.processes._buffer = processes;
    roster.processes._length = 3;
    broker_roster(story.b, &roster, story.now_ns);
    answer_step("green", 0, NULL);
    answer_step("red", 0, NULL);
    answer_step("grey", 0, NULL);
    (void)hear(false);
    CU_ASSERT_PTR_NOT_NULL(strstr(shown, "+new/grey"));
}

static void test_garbage(void)
{
    static const char *const performatives[] = {
        "group-create", "group-join", "group-leave",  "members",   "groups",
        "advertise",    "withdraw",   "find-service", "subscribe", "unsubscribe"};
    static const char sample[] = "mapper \"role=scout battery>=0.5 near=1,2,3\" 1.5";
    char content[256];
    struct mu_random r;
    team();
    mu_random_seed(&r, 4, "pages");
    for (int i = 0; i < 5000; i++) {
        garble(&r, content, sizeof content, sample, sizeof sample - 1);
        (void)say("red", performatives[mu_random_between(&r, 0, 9)], content);
    }
    muster_BrokerStatus s = story_status();
    CU_ASSERT(s.malformed > 100);
    CU_ASSERT_EQUAL(s.sent, s.delivered + s.waiting);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"create, join, leave", test_create_join_leave},
        {"changes are answered when asked", test_changes_are_answered_when_asked},
        {"bad names", test_bad_names},
        {"mail to a group", test_mail_to_a_group},
        {"a new process is told all", test_a_new_process_is_told_all},
        {"a refused delivery is told again", test_a_refused_delivery_is_told_again},
        {"the last word counts in any order", test_the_last_word_counts_in_any_order},
        {"limit: lines", test_limit_lines},
        {"limit: a new group has no room", test_limit_a_new_group_has_no_room},
        {"limit: groups", test_limit_groups},
        {"changes come in their order", test_changes_come_in_their_order},
        {"changes take effect at the end of a step", test_changes_take_effect_at_the_end_of_a_step},
        {"outsiders shift nothing inside", test_outsiders_shift_nothing_inside},
        {"who enters the run brings its groups", test_who_enters_the_run_brings_its_groups},
        {"garbage", test_garbage},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/groups", tests);
}
