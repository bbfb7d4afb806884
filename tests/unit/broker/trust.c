/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "broker_story.h"

static struct trust trust;
static struct mu_fault fault;

static mu_result policy(const char *text)
{
    fault = (struct mu_fault){0};
    if (!trust.lines) {
        trust_init(&trust);
    }
    return trust_read(&trust, text, "team.policy", &fault);
}

static bool allows(const char *who, muster_Kind kind, const char *whom, muster_Kind whom_kind)
{
    struct trust_agent from = {who, kind}, to = {whom, whom_kind};
    return trust_allows(&trust, &from, &to);
}

static bool robot_allows(const char *who, const char *whom)
{
    return allows(who, muster_KIND_ROBOT, whom, muster_KIND_ROBOT);
}

static bool party_has(void *self, const struct trust_party *party, const char *agent)
{
    (void)self;
    return party->kind == TRUST_GROUP
               ? strcmp(party->name, "scouts") == 0 && strcmp(agent, "blue") == 0
               : strcmp(party->name, "leader") == 0 && strcmp(agent, "red") == 0;
}

/* --- the file --------------------------------------------------------------------------------- */

static void test_without_a_file(void)
{
    static struct trust t;
    trust_init(&t);
    struct trust_agent observer = {"observer", muster_KIND_SPECIAL};
    struct trust_agent operator= {"operator", muster_KIND_SPECIAL};
    struct trust_agent red = {"red", muster_KIND_ROBOT};
    CU_ASSERT_TRUE(trust_allows(&t, &observer, &red));
    CU_ASSERT_TRUE(trust_allows(&t, &operator, & observer));
    CU_ASSERT_FALSE(trust_allows(&t, &red, &red));
    CU_ASSERT_FALSE(trust_allows(&t, &red, &operator));
    CU_ASSERT_TRUE(trust_allows_some(&t, &observer));
    CU_ASSERT_FALSE(trust_allows_some(&t, &red));
}

static void test_consoles_are_the_operator(void)
{
    CU_ASSERT_EQUAL(policy("allow operator direct all\n"
                           "deny operator direct green\n"
                           "deny operator-7 direct blue"),
                    MU_OK);
    CU_ASSERT_TRUE(allows("operator-12", muster_KIND_SPECIAL, "blue", muster_KIND_ROBOT));
    CU_ASSERT_FALSE(allows("operator-7", muster_KIND_SPECIAL, "blue", muster_KIND_ROBOT));
    CU_ASSERT_FALSE(allows("operator-12", muster_KIND_SPECIAL, "green", muster_KIND_ROBOT));
    CU_ASSERT_FALSE(allows("operator-12", muster_KIND_AGENT, "blue", muster_KIND_ROBOT));
    CU_ASSERT_FALSE(allows("operator-x", muster_KIND_SPECIAL, "blue", muster_KIND_ROBOT));
    CU_ASSERT_FALSE(allows("operator-", muster_KIND_SPECIAL, "blue", muster_KIND_ROBOT));
}

static void test_the_last_line_that_fits_decides(void)
{
    CU_ASSERT_EQUAL(policy("allow red direct all\n"
                           "deny red direct robots\n"
                           "\tallow  red\tdirect blue # its mate\r\n"
                           "\n# nothing\n"
                           "allow special direct special"),
                    MU_OK);
    CU_ASSERT_EQUAL(trust.lines_count, 4);
    CU_ASSERT_TRUE(robot_allows("red", "blue"));
    CU_ASSERT_FALSE(robot_allows("red", "green"));
    CU_ASSERT_TRUE(allows("red", muster_KIND_ROBOT, "host1", muster_KIND_HOST));
    CU_ASSERT_TRUE(allows("observer", muster_KIND_SPECIAL, "broker", muster_KIND_SPECIAL));
    CU_ASSERT_FALSE(allows("observer", muster_KIND_SPECIAL, "red", muster_KIND_ROBOT));
    CU_ASSERT_FALSE(robot_allows("green", "red")); /* no line fits */
}

static void test_groups_and_roles_are_asked_for(void)
{
    CU_ASSERT_EQUAL(policy("allow role:leader direct group:scouts\n"), MU_OK);
    trust.pages = (struct trust_pages){0};
    CU_ASSERT_FALSE(robot_allows("red", "blue")); /* nobody knows */
    trust.pages = (struct trust_pages){.has = party_has};
    CU_ASSERT_TRUE(robot_allows("red", "blue"));
    CU_ASSERT_FALSE(robot_allows("red", "green"));
    CU_ASSERT_FALSE(robot_allows("green", "blue"));
    CU_ASSERT_EQUAL(policy("allow all direct all\ndeny group:scouts direct role:leader"), MU_OK);
    CU_ASSERT_FALSE(robot_allows("blue", "red"));
    CU_ASSERT_TRUE(robot_allows("blue", "green"));
}

static void test_mistakes_are_named(void)
{
    static const struct {
        const char *text, *expected;
        int line, column;
    } cases[] = {
        {"permit red direct blue", "expected allow or deny, not 'permit'", 1, 1},
        {"\n  allow red command blue", "expected direct, not 'command'", 2, 13},
        {"allow red", "expected direct, found the line's end", 1, 10},
        {"allow",
         "expected a name, all, robots, special, group:NAME or role:NAME, found the "
         "line's end",
         1, 6},
        {"allow # red",
         "expected a name, all, robots, special, group:NAME or role:NAME, found "
         "the line's end",
         1, 7},
        {"allow 7up direct all",
         "expected a name, all, robots, special, group:NAME or role:NAME, "
         "not '7up'",
         1, 7},
        {"allow red direct group:",
         "expected a name, all, robots, special, group:NAME or "
         "role:NAME, not 'group:'",
         1, 18},
        {"allow red direct task:x",
         "expected a name, all, robots, special, group:NAME or "
         "role:NAME, not 'task:x'",
         1, 18},
        {"allow red direct a-name-of-more-than-31-characters",
         "expected a name, all, robots, "
         "special, group:NAME or role:NAME, not 'a-name-of-more-than-31-characters'",
         1, 18},
        {"allow red direct group:robots",
         "expected a name, all, robots, special, group:NAME or "
         "role:NAME, not 'group:robots'",
         1, 18},
        {"deny red \x1b[2J", "expected direct, not '?[2J'", 1, 10},
        {"allow red direct blue green", "expected the line's end or a comment, not 'green'", 1, 23},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_EQUAL(policy(cases[i].text), MU_FAULT_FILE);
        CU_ASSERT_STRING_EQUAL(fault.text, cases[i].expected);
        CU_ASSERT_STRING_EQUAL(fault.file, "team.policy");
        CU_ASSERT_EQUAL(fault.line, cases[i].line);
        CU_ASSERT_EQUAL(fault.column, cases[i].column);
    }
}

static void test_limit_lines(void)
{
    static char text[32 * (MU_TRUST_LINES_MAX + 2)];
    struct mu_text t;
    mu_text_init(&t, text, sizeof text);
    for (unsigned i = 0; i < MU_TRUST_LINES_MAX; i++) {
        mu_text_add(&t, "allow red direct blue\n");
    }
    mu_text_add(&t, "# no line of policy\n");
    CU_ASSERT_EQUAL(policy(text), MU_OK);
    mu_text_add(&t, "deny red direct blue\n");
    CU_ASSERT_EQUAL(policy(text), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(fault.line, MU_TRUST_LINES_MAX + 2);
}

/* Whatever stands in the file, it is read or refused. */
static void test_garbage(void)
{
    static const char *const words[] = {"allow", "deny", "direct", "red", "group:", "#",  "\n",
                                        " ",     "\t",   "\xff",   ":",   "role:x", "all"};
    char text[256];
    uint32_t seed = 1;
    for (unsigned round = 0; round < 20000; round++) {
        struct mu_text t;
        mu_text_init(&t, text, sizeof text);
        for (unsigned i = 0; i < round % 24; i++) {
            seed = seed * 1664525u + 1013904223u;
            mu_text_add(&t, words[(seed >> 16) % (sizeof words / sizeof words[0])]);
            mu_text_add(&t, seed >> 31 ? " " : "");
        }
        mu_result read = policy(text);
        CU_ASSERT_TRUE(read == MU_OK || (read == MU_FAULT_FILE && fault.line > 0));
    }
}

/* --- directives ------------------------------------------------------------------------------- */

static void team(const char *text)
{
    story_begin_with(0, true);
    CU_ASSERT_EQUAL_FATAL(trust_read(&story.b->trust, text, "team.policy", &fault), MU_OK);
    story_join("red");
    story_join("green");
    story_join("blue");
    (void)story_collect();
}

static void test_those_that_the_policy_allows_get_it(void)
{
    team("allow red direct blue");
    story_mail(directive("red", 1, "blue", "(wander)"));
    EXPECT("blue #1 red/1 (wander)");
    story_mail(directive("red", 2, "green,blue", "(wander)"));
    EXPECT("blue #2 red/2 (wander); red 2-2 refused");
    story_mail(directive("red", 3, "robots", "(wander)"));
    EXPECT("blue #3 red/3 (wander); red 3-3 refused");
    story_mail(directive("green", 1, "blue", "(wander)"));
    EXPECT("green 1-1 refused");
    story_mail(directive("red", 4, "blue,nobody", "(wander)"));
    EXPECT("blue #4 red/4 (wander); red 4-4 unknown-name");
    story_mail(directive("red", 5, "green,nobody", "(wander)"));
    EXPECT("red 5-5 refused"); /* before all other outcomes */
    story_ack("blue", 4);
    EXPECT("red 1-1 delivered");
    CU_ASSERT_EQUAL(story_status().refused, 4);
    muster_BrokerStatus s = story_status();
    CU_ASSERT_EQUAL(s.sent, s.delivered + s.refused + s.unknown_name);
    CU_ASSERT_EQUAL(story.b->directed, 4);
    CU_ASSERT_EQUAL(s.stored, 0);
}

static void test_requests_are_no_business_of_the_policy(void)
{
    team("deny all direct all");
    story_send("red", 1, "green", "please");
    EXPECT("green #1 red/1 please");
    CU_ASSERT_EQUAL(story.b->audit.recorded, 0);
}

static void test_for_nobody(void)
{
    team("allow red direct blue");
    story_mail(directive("red", 1, "nobody", "(wander)"));
    EXPECT("red 1-1 unknown-name");
    story_mail(directive("green", 1, "nobody",
                         "(wander)")); /* who may direct nobody is not told who is there */
    EXPECT("green 1-1 refused");
    story_mail(directive("green", 2, "special", "(wander)"));
    EXPECT("green 2-2 refused");
    CU_ASSERT_EQUAL(story_status().refused, 2);
}

static void test_the_broker_is_directed_by_whom_the_policy_allows(void)
{
    team("allow red direct broker");
    muster_Mail m = directive("red", 1, "broker", "(wander)");
    m.content = words("(delivery-interval 2.5)");
    story_mail(m);
    EXPECT("red #1 broker/4611686018427387905 delivery-interval 2.5; red 1-1 delivered");
    CU_ASSERT_EQUAL(story.b->dispatch.interval_ns, 2500000);
    m = directive("blue", 1, "broker", "(wander)");
    m.content = words("(delivery-interval 7)");
    story_mail(m);
    CU_ASSERT_EQUAL(story.b->dispatch.interval_ns, 2500000);
    CU_ASSERT_EQUAL(story_status().refused, 1);
}

/* --- the audit -------------------------------------------------------------------------------- */

static const char *audit_text(void)
{
    static char line[AUDIT_LINE_MAX];
    struct audit_record r;
    if (!audit_next(&story.b->audit, &r)) {
        return "none";
    }
    CU_ASSERT_EQUAL(audit_line(&r, line), strlen(line));
    return line;
}

static void test_the_audit_has_every_directive(void)
{
    team("allow red direct blue\nallow red direct broker");
    story.now_ns = 5000;
    story_mail(directive("red", 1, "robots", "(wander)"));
    story_mail(directive("blue", 1, "nobody", "(wander)"));
    muster_Mail m = directive("red", 2, "blue", "(wander)");
    char much[302];
    memset(much, 'x', 301);
    much[301] = '\0';
    much[0] = '"';
    m.content = much;
    story_mail(m);
    CU_ASSERT_STRING_EQUAL(
        audit_text(),
        "{\"clock\": \"wall\", \"time_ns\": 6000, \"sender\": \"red\", \"process\": \"p-red\", "
        "\"receiver\": \"blue\", \"receivers\": 1, \"performative\": \"do\", "
        "\"line\": \"(wander)\", \"allowed\": true}\n");
    CU_ASSERT_STRING_EQUAL(
        audit_text(),
        "{\"clock\": \"wall\", \"time_ns\": 6000, \"sender\": \"red\", \"process\": \"p-red\", "
        "\"receiver\": \"green\", \"receivers\": 1, \"performative\": \"do\", "
        "\"line\": \"(wander)\", \"allowed\": false}\n");
    CU_ASSERT_STRING_EQUAL(
        audit_text(),
        "{\"clock\": \"wall\", \"time_ns\": 6000, \"sender\": \"blue\", \"process\": \"p-blue\", "
        "\"receiver\": \"nobody\", \"receivers\": 0, \"performative\": \"do\", "
        "\"line\": \"(wander)\", \"allowed\": false}\n");
    struct audit_record r;
    CU_ASSERT_TRUE_FATAL(audit_next(&story.b->audit, &r));
    CU_ASSERT_EQUAL(strlen(r.line), 200);
    CU_ASSERT_STRING_EQUAL(audit_text(), "none");
}

static void test_every_byte_fits_a_line(void)
{
    static struct audit_record r;
    char line[AUDIT_LINE_MAX];
    memset(r.sender, 1, sizeof r.sender - 1);
    memset(r.process, 0xff, sizeof r.process - 1);
    memset(r.receiver, 1, sizeof r.receiver - 1);
    memset(r.performative, 1, sizeof r.performative - 1);
    memset(r.line, 1, sizeof r.line - 1);
    r.time_ns = UINT64_MAX;
    r.receivers = UINT32_MAX;
    size_t len = audit_line(&r, line);
    CU_ASSERT_TRUE(len < AUDIT_LINE_MAX && line[len - 1] == '\n');
    CU_ASSERT_EQUAL(strchr(line, '\n') - line, (long)len - 1);
}

static void test_limit_audit(void)
{
    team("deny all direct all");
    for (uint64_t i = 1; i <= MU_AUDIT_MAX + 3; i++) {
        story_mail(directive("red", i, "blue", "(wander)"));
    }
    CU_ASSERT_EQUAL(story.b->audit.recorded, MU_AUDIT_MAX);
    CU_ASSERT_EQUAL(story.b->audit.lost, 3);
    CU_ASSERT_EQUAL(story_status().refused, MU_AUDIT_MAX + 3); /* and refused all the same */
    unsigned taken = 0;
    for (struct audit_record r; audit_next(&story.b->audit, &r); taken++) {
        CU_ASSERT_FALSE(r.allowed);
    }
    CU_ASSERT_EQUAL(taken, MU_AUDIT_MAX);
    story_mail(directive("red", MU_AUDIT_MAX + 4, "blue", "(wander)"));
    CU_ASSERT_STRING_NOT_EQUAL(audit_text(), "none");
}

static void test_in_lock_step_the_audit_has_the_run_s_time(void)
{
    team("allow red direct blue");
    char *names[] = {words("p-red"), words("p-blue")};
    muster_Roster roster = {.simulator = words("sim"), .lockstep = true, .step_ns = 100 * MS};
    roster.processes = (dds_sequence_string){._length = 2, ._buffer = names};
    broker_roster(story.b, &roster, story.now_ns);
    story_match("sim");
    (void)story_collect();
    muster_Mail m = directive("red", 1, "blue", "(wander)");
    story_up("red", 0, muster_STATE_RUNNING, &m, 1, 0);
    story_up("blue", 0, muster_STATE_RUNNING, NULL, 0, 0);
    struct audit_record r;
    CU_ASSERT_TRUE_FATAL(audit_next(&story.b->audit, &r));
    CU_ASSERT_TRUE(r.simulated && r.allowed);
    CU_ASSERT_EQUAL(r.time_ns, 100 * MS);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"without a file", test_without_a_file},
        {"consoles are the operator", test_consoles_are_the_operator},
        {"the last line that fits decides", test_the_last_line_that_fits_decides},
        {"groups and roles are asked for", test_groups_and_roles_are_asked_for},
        {"mistakes are named", test_mistakes_are_named},
        {"limit: lines", test_limit_lines},
        {"garbage", test_garbage},
        {"those that the policy allows get it", test_those_that_the_policy_allows_get_it},
        {"requests are no business of the policy", test_requests_are_no_business_of_the_policy},
        {"for nobody", test_for_nobody},
        {"the broker is directed", test_the_broker_is_directed_by_whom_the_policy_allows},
        {"the audit has every directive", test_the_audit_has_every_directive},
        {"every byte fits a line", test_every_byte_fits_a_line},
        {"limit: audit", test_limit_audit},
        {"in lock step the audit has the run's time",
         test_in_lock_step_the_audit_has_the_run_s_time},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/trust", tests);
}
