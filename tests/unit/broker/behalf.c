/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of groups and services in another agent's name. */
#include "broker/control/parts.h"
#include "pages_story.h"

static void team(void)
{
    story_begin_with(0, true);
    story_join("operator");
    story_join("red");
    story_join("green");
    (void)hear(true);
}

/* Takes the oldest record of the audit.  @return "SENDER PERFORMATIVE RECEIVER allowed" or so */
static const char *audited(void)
{
    static char text[1024];
    struct audit_record r;
    if (!audit_next(&story.b->audit, &r)) {
        return "none";
    }
    snprintf(text, sizeof text, "%s %s %s %s", r.sender, r.performative, r.receiver,
             r.allowed ? "allowed" : "refused");
    return text;
}

static void test_who_is_trusted_changes_for_others(void)
{
    team();
    HEARD("operator: inform group-join scouts", say("operator", "group-join", "scouts red"));
    SHOWN("+scouts +scouts/red");
    HEARD("operator: inform group-join scouts", say("operator", "group-join", "scouts \"green\""));
    HEARD("operator: inform group-leave scouts", say("operator", "group-leave", "scouts red"));
    SHOWN("-scouts/red");
    HEARD("operator: failure not-a-member scouts", say("operator", "group-leave", "scouts red"));
    HEARD("operator: inform advertise mapper",
          say("operator", "advertise", "mapper \"role=a\" 0 red"));
    SHOWN("+mapper@red[role=a]");
    HEARD("operator: inform withdraw mapper", say("operator", "withdraw", "mapper red"));
    SHOWN("-mapper@red");
    HEARD("operator: failure not-offered mapper", say("operator", "withdraw", "mapper red"));
    story_gone("p-red"); /* who is absent can be made a member, too */
    HEARD("operator: inform group-join cooks", say("operator", "group-join", "cooks red"));
    HEARD("operator: inform members-of cooks red", say("operator", "members", "cooks"));
}

static void test_who_is_not_trusted_does_not(void)
{
    team();
    HEARD("red: failure refused green", say("red", "group-join", "scouts green"));
    HEARD("red: failure refused green", say("red", "group-leave", "scouts green"));
    HEARD("red: failure refused green", say("red", "advertise", "mapper \"\" 0 green"));
    HEARD("red: failure refused green", say("red", "withdraw", "mapper green"));
    HEARD("red: failure refused nobody", say("red", "group-join", "scouts nobody"));
    CU_ASSERT_EQUAL(story.b->unspoken, 5);
    CU_ASSERT_EQUAL(story_status().refused, 0); /* no mail of theirs was */
    CU_ASSERT_EQUAL(story_status().malformed, 0);
    CU_ASSERT_EQUAL(story.b->pages.groups.pairs.count, 0);
    HEARD("red: inform group-join scouts", say("red", "group-join", "scouts red"));
    CU_ASSERT_EQUAL(story.b->unspoken, 5);
}

static void test_names_that_nobody_bears(void)
{
    team();
    HEARD("operator: failure unknown-name nobody", say("operator", "group-join", "scouts nobody"));
    HEARD("operator: failure unknown-name broker", say("operator", "group-join", "scouts broker"));
    HEARD("operator: failure not-a-name \"a b\"", say("operator", "group-join", "scouts \"a b\""));
    HEARD("operator: failure not-a-name \"1st\"", say("operator", "withdraw", "mapper \"1st\""));
    HEARD("operator: not-understood group-join", say("operator", "group-join", "scouts red red"));
    HEARD("operator: not-understood withdraw", say("operator", "withdraw", "mapper red red"));
    HEARD("operator: not-understood advertise",
          say("operator", "advertise", "mapper \"\" 0 red red"));
    HEARD("operator: not-understood group-create", say("operator", "group-create", "a red"));
    CU_ASSERT_EQUAL(story_status().malformed, 6);
    CU_ASSERT_EQUAL(story.b->pages.groups.pairs.count, 0);
}

static void test_who_lives_in_one_process_needs_no_trust(void)
{
    team();
    story_register("guest", "p-red");
    (void)hear(true);
    HEARD("red: inform group-join scouts", say("red", "group-join", "scouts guest"));
    CU_ASSERT_STRING_EQUAL(audited(), "none");
    story_gone("p-red");
    story_register("red", "p-red"); /* without its guest, who is absent */
    (void)hear(true);
    HEARD("red: failure refused guest", say("red", "group-leave", "scouts guest"));
}

static void test_the_policy_decides_and_the_audit_says_so(void)
{
    struct mu_fault fault;
    team();
    CU_ASSERT_EQUAL_FATAL(trust_read(&story.b->trust,
                                     "allow operator direct red\nallow green direct all\n", "p",
                                     &fault),
                          MU_OK);
    HEARD("operator: inform group-join scouts", say("operator", "group-join", "scouts red"));
    HEARD("operator: failure refused green", say("operator", "group-join", "scouts green"));
    HEARD("green: inform advertise mapper", say("green", "advertise", "mapper \"\" 0 operator"));
    CU_ASSERT_STRING_EQUAL(audited(), "operator group-join red allowed");
    CU_ASSERT_STRING_EQUAL(audited(), "operator group-join green refused");
    CU_ASSERT_STRING_EQUAL(audited(), "green advertise operator allowed");
    CU_ASSERT_STRING_EQUAL(audited(), "none");
}

/* A directive of the operator to red.  @return whether red got it */
static bool directs(void)
{
    muster_Mail m = letter("operator", ++pages_seq, "red", "go");
    m.layer = 0;
    m.performative = words("start");
    story_mail(m);
    return strstr(hear(true), "red: operator go") != NULL;
}

static void test_a_policy_knows_groups_and_roles(void)
{
    struct mu_fault fault;
    team();
    CU_ASSERT_EQUAL_FATAL(trust_read(&story.b->trust,
                                     "allow operator direct all\n"
                                     "deny operator direct group:scouts\n"
                                     "allow role:boss direct group:scouts\n",
                                     "p", &fault),
                          MU_OK);
    CU_ASSERT_TRUE(directs());
    (void)say("red", "group-join", "scouts");
    CU_ASSERT_FALSE(directs());
    CU_ASSERT_EQUAL(story_status().refused, 1);
    (void)say("operator", "advertise", "chief \"x=1 role=boss\"");
    CU_ASSERT_TRUE(directs());
    (void)say("operator", "advertise", "chief \"role=bosses\"");
    CU_ASSERT_FALSE(directs());
    (void)say("red", "group-leave", "scouts");
    CU_ASSERT_TRUE(directs());
}

static void test_inside_the_lock_step_outsiders_have_no_name(void)
{
    struct mu_fault fault;
    team();
    CU_ASSERT_EQUAL_FATAL(trust_read(&story.b->trust, "allow all direct all\n", "p", &fault),
                          MU_OK);
    story_match("sim");
    pages_roster(true, 0, "p-red", NULL);
    (void)hear(false);
    muster_Mail m = to_broker("red", "group-join", "scouts green");
    answer_step("red", 0, &m);
    HEARD("red: failure unknown-name green", hear(false));
}

/* red and green in lock step, green in the group scouts. */
static void run_begin(void)
{
    team();
    pages_seq = 0;
    (void)say("green", "group-join", "scouts");
    story_match("sim");
    pages_roster(true, 0, "p-red", "p-green");
    (void)hear(false);
}

static void step(int64_t number, muster_Mail *red)
{
    answer_step("green", number, NULL);
    answer_step("red", number, red);
}

static void test_a_change_for_a_member_waits_for_the_step(void)
{
    run_begin();
    story_mail(to_broker("operator", "group-join", "scouts red"));
    story_mail(to_broker("operator", "group-leave", "scouts green"));
    story_mail(to_broker("operator", "advertise", "mapper \"\" 0 green"));
    HEARD("", hear(false));
    CU_ASSERT_TRUE(groups_has(&story.b->pages.groups, "scouts", "green", false));
    CU_ASSERT_EQUAL(story.b->pages.services.pairs.count, 0);
    muster_Mail m = to_broker("red", "find-service", "mapper");
    step(0, &m); /* what is from inside takes effect first */
    HEARD("red: inform services; operator: inform group-join scouts; operator: inform group-leave "
          "scouts; operator: inform advertise mapper",
          hear(false));
    SHOWN("+scouts/red -scouts/green +mapper@green[]");
    story_mail(to_broker("operator", "withdraw", "mapper green"));
    m = to_broker("red", "members", "scouts");
    step(1, &m);
    HEARD("red: inform members-of scouts red; operator: inform withdraw mapper", hear(false));
    SHOWN("-mapper@green");
}

/* When the step ends, neither is in a process: that does not make them live in one. */
static void test_who_has_left_speaks_for_nobody(void)
{
    run_begin();
    story_join("mallory");
    story_mail(to_broker("mallory", "group-join", "scouts red"));
    story_gone("p-mallory");
    story_up("red", 0, muster_STATE_ABSENT, NULL, 0, 0);
    answer_step("green", 0, NULL);
    (void)hear(false);
    CU_ASSERT_FALSE(groups_has(&story.b->pages.groups, "scouts", "red", false));
    CU_ASSERT_EQUAL(story.b->unspoken, 1);
    CU_ASSERT_STRING_EQUAL(audited(), "mallory group-join red refused");
}

/* What another broker says of a member meanwhile is not seen inside. */
static void test_mail_to_a_group_of_members(void)
{
    run_begin();
    struct line_word red = {"scouts", "red", true, "", "beta", 0, UINT64_MAX / 2};
    struct line_word green = {"scouts", "green", false, "", "beta", 0, UINT64_MAX / 2};
    struct said outside = {.origin = "beta"};
    CU_ASSERT_EQUAL(lines_merge(&story.b->pages.groups, &red, &outside), MU_OK);
    CU_ASSERT_EQUAL(lines_merge(&story.b->pages.groups, &green, &outside), MU_OK);
    muster_Mail gold = letter("red", ++pages_seq, "group:scouts", "gold");
    step(0, &gold);
    HEARD("green: red gold", hear(false));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"who is trusted changes for others", test_who_is_trusted_changes_for_others},
        {"who is not trusted does not", test_who_is_not_trusted_does_not},
        {"names that nobody bears", test_names_that_nobody_bears},
        {"who lives in one process needs no trust", test_who_lives_in_one_process_needs_no_trust},
        {"the policy decides, and the audit says so",
         test_the_policy_decides_and_the_audit_says_so},
        {"a policy knows groups and roles", test_a_policy_knows_groups_and_roles},
        {"inside the lock step outsiders have no name",
         test_inside_the_lock_step_outsiders_have_no_name},
        {"a change for a member waits for the step", test_a_change_for_a_member_waits_for_the_step},
        {"who has left speaks for nobody", test_who_has_left_speaks_for_nobody},
        {"mail to a group of members", test_mail_to_a_group_of_members},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/behalf", tests);
}
