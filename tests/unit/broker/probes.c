/* SPDX-License-Identifier: Apache-2.0 */
/* Lines that only look pass beside all mail: outside of steps, and with the policy's leave. */
#include "broker/control/parts.h"
#include "broker_story.h"

/* An Up of a process with a probe in it. */
static void say(const char *process, muster_GlanceWord word, const char *asker, uint64_t number,
                const char *agent, const char *text)
{
    muster_Glance g = {.word = word,
                       .asker = words(asker),
                       .number = number,
                       .agent = words(agent),
                       .text = words(text)};
    struct one_up u;
    one_up(&u, "", process, NULL, 0, 0);
    u.up.step = muster_STEP_NOW;
    u.up.acts._length = 0;
    u.up.glances = (dds_sequence_muster_Glance){._length = 1, ._buffer = &g};
    broker_up(story.b, &u.up, story.now_ns);
}

static void ask(uint64_t number, const char *agent)
{
    say("p-operator", muster_GLANCE_ASK, "operator", number, agent, "(facts)");
}

static void answer(uint64_t number, const char *agent, const char *text)
{
    say("p-red", muster_GLANCE_DONE, "operator", number, agent, text);
}

static void begin(void)
{
    story_begin_with(0, true);
    story_join("operator");
    story_join("red");
    story_join("blue");
}

static void roster_say(int64_t step)
{
    char *processes[] = {words("p-red"), words("p-blue")};
    muster_Roster roster = {
        .simulator = words("sim"), .lockstep = true, .step = step, .step_ns = 100 * MS};
    roster.processes._buffer = processes;
    roster.processes._length = 2;
    broker_roster(story.b, &roster, story.now_ns);
}

static void test_question_and_answer(void)
{
    begin();
    ask(1, "red");
    EXPECT("p-red: operator/1 red asks (facts)");
    CU_ASSERT_EQUAL(broker_samples_wanted(story.b), 1);
    answer(1, "red", "f-0");
    EXPECT("p-operator: operator/1 red done f-0");
    CU_ASSERT_EQUAL(story.b->probes.count, 0);
    answer(1, "red", "f-0"); /* once more: nobody waits for it */
    EXPECT("");
    CU_ASSERT_EQUAL(story.b->counters.sent, 0);
}

/* In the middle of a step, and the step is what it was. */
static void test_a_step_does_not_notice(void)
{
    begin();
    story_match("sim");
    (void)story_collect();
    roster_say(0);
    (void)story_collect();
    story_up("blue", 0, muster_STATE_RUNNING, NULL, 0, 0);
    ask(1, "red");
    EXPECT("p-red: operator/1 red asks (facts)");
    answer(1, "red", "f-0");
    EXPECT("p-operator: operator/1 red done f-0");
    story_up("red", 0, muster_STATE_RUNNING, NULL, 0, 0);
    EXPECT("p-red@0; p-blue@0; sim@0");
    muster_Mail m = directive("operator", 1, "red", "(stay)");
    story_mail(m);
    ask(2, "red");
    EXPECT("p-red: operator/2 red asks (facts)"); /* what came before it waits for the step */
    story_up("red", 1, muster_STATE_RUNNING, NULL, 0, 0);
    story_up("blue", 1, muster_STATE_RUNNING, NULL, 0, 0);
    EXPECT("p-red@1; red #1 operator/1 (stay); p-blue@1; sim@1; outside operator/1");
    answer(2, "red", "f-1");
    EXPECT("p-operator: operator/2 red done f-1");
}

static void test_who_may_not_direct_may_not_look(void)
{
    struct mu_fault fault;
    struct audit_record r;
    begin();
    CU_ASSERT_EQUAL(trust_read(&story.b->trust,
                               "allow operator direct all\ndeny operator direct blue\n",
                               "team.policy", &fault),
                    MU_OK);
    ask(1, "blue");
    EXPECT("p-operator: operator/1 blue declined ");
    CU_ASSERT_FALSE(audit_next(&story.b->audit, &r)); /* the directive that follows is refused */
    CU_ASSERT_EQUAL(story.b->counters.refused, 0);
    say("p-blue", muster_GLANCE_ASK, "blue", 1, "red", "(facts)");
    EXPECT("p-blue: blue/1 red declined ");
    ask(2, "red");
    EXPECT("p-red: operator/2 red asks (facts)");
    CU_ASSERT_TRUE_FATAL(audit_next(&story.b->audit, &r));
    CU_ASSERT_TRUE(r.allowed);
    CU_ASSERT_STRING_EQUAL(r.sender, "operator");
    CU_ASSERT_STRING_EQUAL(r.receiver, "red");
    CU_ASSERT_STRING_EQUAL(r.performative, "glance");
    CU_ASSERT_STRING_EQUAL(r.line, "(facts)");
}

static void test_where_nobody_can_look(void)
{
    begin();
    ask(1, "nobody");
    EXPECT("p-operator: operator/1 operator declined ");
    ask(2, "broker");
    EXPECT("p-operator: operator/2 broker declined ");
    story_state("red", muster_STATE_MOVING);
    (void)story_collect();
    ask(3, "red");
    EXPECT("p-operator: operator/3 red declined ");
    story_gone("p-blue");
    (void)story_collect();
    ask(4, "blue");
    EXPECT("p-operator: operator/4 blue declined ");
}

static void test_nobody_asks_or_answers_for_others(void)
{
    begin();
    uint64_t malformed = story.b->counters.malformed;
    say("p-red", muster_GLANCE_ASK, "operator", 1, "blue", "(facts)");
    say("p-red", muster_GLANCE_ASK, "stranger", 1, "blue", "(facts)");
    EXPECT("");
    CU_ASSERT_EQUAL(story.b->counters.malformed, malformed + 2);
    ask(1, "red");
    (void)story_collect();
    say("p-blue", muster_GLANCE_DONE, "operator", 1, "red", "a lie");
    say("p-red", muster_GLANCE_DONE, "operator", 2, "red", "not asked");
    EXPECT("");
    answer(1, "red", "the truth");
    EXPECT("p-operator: operator/1 red done the truth");
}

static void test_who_dies(void)
{
    begin();
    ask(1, "red");
    (void)story_collect();
    ask(2, "red"); /* not out yet */
    story_gone("p-red");
    EXPECT("p-operator: operator/1 red declined ; p-operator: operator/2 red declined ");
    CU_ASSERT_EQUAL(story.b->probes.count, 0);
    ask(3, "blue");
    (void)story_collect();
    ask(4, "blue");
    story_gone("p-operator");
    EXPECT("");
    CU_ASSERT_EQUAL(story.b->probes.count, 0);
    CU_ASSERT_EQUAL(story.b->probes.words_count, 0);
}

/* What the network does not take goes out later. */
static void test_a_network_that_is_slow(void)
{
    const char *process;
    muster_Delivery d;
    begin();
    ask(1, "red");
    CU_ASSERT_TRUE_FATAL(broker_next(story.b, &process, &d));
    broker_undelivered(story.b);
    EXPECT("");
    story_tick(10 * MS);
    EXPECT("p-red: operator/1 red asks (facts)");
}

static void test_limit_share_of_a_process(void)
{
    begin();
    for (uint64_t i = 1; i <= MU_GLANCES_EACH; i++) {
        ask(i, "red");
    }
    (void)story_collect();
    ask(MU_GLANCES_EACH + 1, "red");
    CU_ASSERT(strstr(story_collect(), "red declined") != NULL);
    say("p-blue", muster_GLANCE_ASK, "blue", 1, "red", "(facts)");
    CU_ASSERT(strstr(story_collect(), "red declined") != NULL); /* by the policy: others go on */
    answer(1, "red", "f-0");
    (void)story_collect();
    ask(MU_GLANCES_EACH + 2, "red");
    EXPECT("p-red: operator/18 red asks (facts)");
    CU_ASSERT_EQUAL(story.b->probes.declined, 2);
}

static void test_limit_glances(void)
{
    char name[MU_NAME_MAX + 1], process[MU_PROCESS_MAX + 1];
    begin();
    for (uint64_t i = 0; i <= MU_GLANCES_MAX / MU_GLANCES_EACH; i++) {
        snprintf(name, sizeof name, "operator-%u", (unsigned)i + 1);
        snprintf(process, sizeof process, "p-%s", name);
        muster_Registration r = registration(name, process);
        entry_of(&r)->kind = muster_KIND_SPECIAL;
        broker_registration(story.b, &r, story.now_ns);
        story_match(process);
        (void)story_collect();
        for (uint64_t n = 1; n <= MU_GLANCES_EACH; n++) {
            say(process, muster_GLANCE_ASK, name, n, "red", "(facts)");
        }
    }
    CU_ASSERT_EQUAL(story.b->probes.count, MU_GLANCES_MAX);
    CU_ASSERT_EQUAL(story.b->probes.declined, MU_GLANCES_EACH);
    CU_ASSERT_EQUAL(story.b->probes.lost, 0);
    CU_ASSERT(strstr(story_collect(), "p-operator-5: operator-5/16 red declined") != NULL);
}

/* Of words that nobody takes the last ones are lost, and counted. */
static void test_limit_words(void)
{
    begin();
    for (uint64_t i = 1; i <= PROBES_WORDS + 3; i++) {
        ask(i, "nobody");
    }
    CU_ASSERT_EQUAL(story.b->probes.lost, 3);
    ask(PROBES_WORDS + 4, "red"); /* who is never asked never answers: it takes no place */
    CU_ASSERT_EQUAL(story.b->probes.lost, 4);
    CU_ASSERT_EQUAL(story.b->probes.count, 0);
    CU_ASSERT(strstr(story_collect(), "operator/256 operator declined") != NULL);
    CU_ASSERT_EQUAL(story.b->probes.words_count, 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"question and answer", test_question_and_answer},
        {"a step does not notice", test_a_step_does_not_notice},
        {"who may not direct may not look", test_who_may_not_direct_may_not_look},
        {"where nobody can look", test_where_nobody_can_look},
        {"nobody asks or answers for others", test_nobody_asks_or_answers_for_others},
        {"who dies", test_who_dies},
        {"a network that is slow", test_a_network_that_is_slow},
        {"limit: the share of a process", test_limit_share_of_a_process},
        {"limit: glances", test_limit_glances},
        {"limit: words", test_limit_words},
        CU_TEST_INFO_NULL,
    };
    return suite_run("glances", tests);
}
