/* SPDX-License-Identifier: Apache-2.0 */
/* What a monitor's mind is told: units, words that are no symbols, and a real mind that reads it.
 */
#include "monitor/facts.h"
#include "core/paths.h"
#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/memory.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static char bytes[FACTS_TEXT];
static struct mu_text text;
static mu_stats *stats;
static struct mind *mind;
static char printed[8192];

static void port_print(void *self, const char *said)
{
    (void)self;
    strncat(printed, said, sizeof printed - strlen(printed) - 1);
}

static const char rules[] =
    "(defrule seen (step (number ?n) (world ?w)) (robot (name ?r) (x ?x) (heading ?h) (stalled ?s)"
    " (nearest ?who) (goal-time ?g)) => (printout t ?n \" \" ?w \" \" ?r \" \" ?x \" \" ?h \" \" ?s"
    " \" \" ?who \" \" ?g crlf))"
    "(defrule mail (mail-seen (from ?f) (to ?t) (performative ?p) (conversation ?v) (outside ?o)"
    " (content $?c)) => (printout t ?f \" \" ?t \" \" ?p \" \" ?v \" \" ?o \" \" (length$ ?c) \" "
    "\" ?c crlf))"
    "(defrule fired (fired ?r ?rule) => (printout t ?r \" fired \" ?rule crlf))"
    "(defrule agents (agent (name ?a) (state ?s) (sent ?n) (received ?m) (fired ?f)) =>"
    " (printout t ?a \" \" ?s \" \" ?n \" \" ?m \" \" ?f crlf))"
    "(defrule over (run-ended (how ?h) (hash ?x)) => (printout t ?h \" \" ?x crlf))";

static int mind_make(void)
{
    char folder[PATH_MAX], path[PATH_MAX];
    struct mu_fault fault;
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = "watcher",
                                   .rules_folder = folder,
                                   .ports = {.print = port_print}};
    bool made = mu_path_rules(folder, sizeof folder) &&
                mu_path_join(path, sizeof path, folder, "monitor.clp") &&
                mind_open(&mind, &options, &fault) == MU_OK &&
                mind_load(mind, path, &fault) == MU_OK &&
                mind_load_text(mind, "rules", rules, &fault) == MU_OK;
    if (!made) {
        mu_fault_print(&fault);
    }
    return !made;
}

static const char *word(const char *of)
{
    mu_text_clear(&text);
    facts_add_word(&text, of);
    return text.at;
}

static const char *content(const char *language, const char *of)
{
    mu_text_clear(&text);
    facts_add_content(&text, language, of);
    return text.at;
}

static void test_words(void)
{
    READS(word("red"), "red");
    READS(word("near:2.5"), "near:2.5");
    READS(word(""), "nil");
    READS(word("12"), "\"12\"");
    READS(word("a b"), "\"a b\"");
    READS(word("?x"), "\"?x\"");
    READS(word("=(exit)"), "\"=(exit)\"");
    READS(word("a)(b"), "\"a)(b\"");
    READS(word("\"\\"), "\"\\\"\\\\\"");
    READS(content("", "mate-pos red 1.0 \"a b\""), "mate-pos red 1.0 \"a b\"");
    READS(content("clips", ""), "");
    READS(content("", "a) (assert (b)"), "\"a) (assert (b)\"");
    READS(content("", "?*x* &b"), "\"?*x* &b\"");
    READS(content("plain", "any words"), "\"any words\"");
}

static struct mu_mail mails[4] = {
    {.src = "red", .dst = "all", .performative = "", .language = "", .content = "mate-pos red 1 2"},
    {.src = "red",
     .dst = "a,b",
     .performative = "tell",
     .language = "json",
     .conversation = "job-1",
     .content = "{\"a\": 1}"},
    {.src = "red", .dst = "blue", .performative = "tell", .language = "", .content = "(no fields"},
    {.src = "red",
     .dst = "all",
     .performative = "",
     .language = "",
     .content = "mate-pos red 1 2"}};

static void world_take(struct mu_frame *frame)
{
    static struct mu_robot_view views[2] = {
        {.name = "red", .state = MU_RUNNING, .x_m = 1.5, .heading_rad = -M_PI},
        {.name = "blue", .state = MU_STANDBY, .x_m = 2.5, .stalled = true}};
    static struct mu_agent_view agent = {"clerk", MU_RUNNING, 7, 3, 5};
    static struct mu_object_view puck = {"puck", 1, 2, 0};
    static struct mu_act_view act = {
        .agent = "red", .rules = "go go MAIN::stay", .diary = "", .mails = mails, .mail_count = 4};
    *frame = (struct mu_frame){.step = 3,
                               .time_ns = 300000000,
                               .robot_count = 2,
                               .robots = views,
                               .object_count = 1,
                               .objects = &puck,
                               .act_count = 1,
                               .acts = &act,
                               .outside_count = 1,
                               .outside = mails + 1,
                               .agent_count = 1,
                               .agents = &agent};
}

static void test_a_step_reaches_rules(void)
{
    struct mu_frame frame;
    struct mind_act act;
    world_take(&frame);
    mu_stats_begin(stats, NULL);
    mu_stats_take(stats, &frame);
    printed[0] = '\0';
    mind_observe(mind, frame.time_ns, facts_of_a_step);
    CU_ASSERT_EQUAL(mind_tell(mind, "(step (number 3) (time 0.3) (world arena))"), MU_OK);
    facts_tell(mind, stats, &frame);
    mind_fire(mind, &act);
    static const char *const lines[] = {"3 arena red 1500.0 180.0 FALSE blue nil\n",
                                        "3 arena blue 2500.0 0.0 TRUE red nil\n",
                                        "red all nil nil FALSE 4 (mate-pos red 1 2)\n",
                                        "red a,b tell job-1 FALSE 1 (\"{\"a\": 1}\")\n",
                                        "red a,b tell job-1 TRUE 1 (\"{\"a\": 1}\")\n",
                                        "red blue tell nil FALSE 1 (\"(no fields\")\n",
                                        "clerk running 3 5 7\n",
                                        "red fired go\n",
                                        "red fired MAIN::stay\n"};
    size_t bytes_wanted = 0;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        CU_ASSERT_PTR_NOT_NULL(strstr(printed, lines[i]));
        bytes_wanted += strlen(lines[i]);
    }
    CU_ASSERT_EQUAL(strlen(printed), bytes_wanted); /* and nothing else, or twice */
}

static void test_the_next_step_begins_anew(void)
{
    struct mu_text out;
    char said[4096];
    struct mind_act act;
    mu_text_init(&out, said, sizeof said);
    printed[0] = '\0';
    mind_observe(mind, 400000000, facts_of_a_step);
    mind_fire(mind, &act);
    READS(printed, "");
    CU_ASSERT_EQUAL(mind_facts(mind, "robot", &out), MU_OK);
    READS(said, "For a total of 0 facts.\n");
    struct mu_run_result result = {.end = MU_RUN_FAULT, .hash = "n\"o", .reason = ""};
    facts_write_end(&text, &result);
    CU_ASSERT_EQUAL(mind_tell(mind, text.at), MU_OK);
    mind_fire(mind, &act);
    READS(printed, "fault n\"o\n");
}

static void test_what_is_no_fact(void)
{
    static const char *const none[] = {"",       "(",       "(robot (name red)", "(robot (nme x))",
                                       "robot)", "(exit))", "(robot (name a b))"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        CU_ASSERT_EQUAL(mind_tell(mind, none[i]), MU_MALFORMED);
    }
    struct mind_slot slots[] = {{.name = "y", .kind = MIND_SLOT_REAL, .real = 1},
                                {.name = "name", .kind = MIND_SLOT_STRING, .word = "a b"}};
    CU_ASSERT_EQUAL(mind_tell_slots(mind, "thing", slots, 2), MU_OK); /* in any order */
    CU_ASSERT_EQUAL(mind_tell_slots(mind, "thing", slots, 2), MU_MALFORMED);
    CU_ASSERT_EQUAL(mind_tell_slots(mind, "nothing", slots, 2), MU_MALFORMED);
    slots[0].name = "content"; /* a multislot, */
    CU_ASSERT_EQUAL(mind_tell_slots(mind, "mail-seen", slots, 1), MU_MALFORMED);
    slots[0].name = "nme"; /* and none */
    CU_ASSERT_EQUAL(mind_tell_slots(mind, "thing", slots, 1), MU_MALFORMED);
    CU_ASSERT_TRUE(mind_looks_at(mind, "mail-seen"));
    CU_ASSERT_FALSE(mind_looks_at(mind, "thing"));
    CU_ASSERT_FALSE(mind_looks_at(mind, "nothing"));
}

static void test_questions_of_one_word(void)
{
    struct mind_mail ask = {.src = "blue",
                            .performative = "ask-one",
                            .language = "",
                            .ontology = "",
                            .reply_with = "q",
                            .in_reply_to = "",
                            .conversation = "",
                            .content = "goal"};
    mu_text_clear(&text);
    CU_ASSERT_TRUE(mind_answer(mind, &ask, &text));
    READS(text.at, "goal none");
    CU_ASSERT_EQUAL(mind_tell(mind, "(goal gohome 1 2.5)"), MU_OK);
    mu_text_clear(&text);
    CU_ASSERT_TRUE(mind_answer(mind, &ask, &text));
    READS(text.at, "goal gohome 1 2.5");
    static const char *const nothing[] = {"", "where", "goal x", "(goal)", "goal\n"};
    for (size_t i = 0; i < sizeof nothing / sizeof nothing[0]; i++) {
        ask.content = nothing[i];
        CU_ASSERT_FALSE(mind_answer(mind, &ask, &text));
    }
}

int main(void)
{
    mu_text_init(&text, bytes, sizeof bytes);
    stats = mu_stats_open();
    if (mind_make()) {
        return 1;
    }
    mu_memory_seal();
    CU_TestInfo tests[] = {
        {"words and contents", test_words},
        {"a step reaches rules", test_a_step_reaches_rules},
        {"the next step begins anew", test_the_next_step_begins_anew},
        {"what is no fact", test_what_is_no_fact},
        {"questions of one word", test_questions_of_one_word},
        CU_TEST_INFO_NULL,
    };
    return suite_run("facts of a monitor", tests);
}
