/* SPDX-License-Identifier: Apache-2.0 */
/* What a mind notes for recordings: each line has its cause above it, and nothing goes unsaid. */
#include "mind/mind.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TEXT = 65536 };

static const char rules[] =
    "(defglobal ?*said* = 0)\n"
    "(defrule see (position ? ?x $?) (go) => (setSpeed 300 20) (send blue near ?x))\n"
    "(defrule alone (declare (salience -1)) (go) (not (friend ?)) => (assert (lonely)) (stop))\n"
    "(defrule hear ?m <- (message hello ?who) => (retract ?m) (assert (friend ?who)))\n";

static char text[TEXT];

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

static struct mind *mind_with(bool diary, const char *program)
{
    static struct mind *all[16]; /* a mind's memory is for the life of the process */
    static size_t count;
    struct mu_fault fault;
    struct mind_options options = {
        .name = "red", .seed = 1, .trace = diary, .ports = {.send = post}};
    CU_ASSERT_FATAL(count < sizeof all / sizeof all[0]);
    CU_ASSERT_EQUAL_FATAL(mind_open(&all[count], &options, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mind_load_text(all[count], "rules", program, &fault), MU_OK);
    return all[count++];
}

static const char *diary(struct mind *m)
{
    struct mu_text out;
    mu_text_init(&out, text, sizeof text);
    mind_trace(m, &out);
    CU_ASSERT(!out.cut);
    return text;
}

static void step(struct mind *m, double x_m)
{
    struct mind_act act;
    struct mu_percept percept = {.time_ns = 100000000, .x_m = x_m, .battery_share = -1};
    mind_percept(m, &percept);
    mind_fire(m, &act);
}

static void line(struct mind *m, const char *words)
{
    char bytes[1024];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    CU_ASSERT_EQUAL(mind_line(m, words, &out), MU_OK);
}

static bool has(const char *words)
{
    bool found = strstr(text, words) != NULL;
    if (!found) {
        fprintf(stderr, "no \"%s\" in:\n%s", words, text);
    }
    return found;
}

static void test_off(void)
{
    struct mind *m = mind_with(false, rules);
    step(m, 1);
    CU_ASSERT_STRING_EQUAL(diary(m), "");
    mind_close(m);
}

static void test_begins_anew(void)
{
    struct mind *m = mind_with(true, rules);
    CU_ASSERT_EQUAL(strncmp(diary(m), "0\n", 2), 0);
    CU_ASSERT(has("(initial-fact)\n"));
    CU_ASSERT_STRING_EQUAL(diary(m), ""); /* it is said once */
    mind_close(m);
}

static void test_percept(void)
{
    struct mind *m = mind_with(true, "");
    diary(m);
    step(m, 1.2345678);
    diary(m);
    long long index;
    CU_ASSERT_EQUAL(strncmp(text, "S\n+", 3), 0);
    CU_ASSERT_EQUAL(sscanf(text + 3, "%lld", &index), 1);
    CU_ASSERT(has(" (position 0.1 1234.568 0.0 0.0 0.0 0.0 FALSE)\n"));
    step(m, -0.0004);
    diary(m);
    char gone[64];
    snprintf(gone, sizeof gone, "S\n-%lld\n+%lld (position 0.1 -0.4 ", index, index + 1);
    CU_ASSERT(has(gone));
    mind_close(m);
}

static void test_extreme_readings(void)
{
    struct mind *m = mind_with(true, "");
    const double values[] = {1e12, -3e300, 0.0, -1e-9, 999.9999999, 0.0005, 123456.7};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        double x, time_s;
        long long index;
        diary(m);
        step(m, values[i]);
        const char *at = strchr(diary(m), '+');
        CU_ASSERT_PTR_NOT_NULL_FATAL(at);
        int read = sscanf(at, "+%lld (position %lf %lf", &index, &time_s, &x);
        CU_ASSERT_EQUAL_FATAL(read, 3);
        double mm = values[i] * 1000;
        CU_ASSERT(fabs(x - mm) <= 0.00051 + fabs(mm) * 1e-15);
    }
    mind_close(m);
}

static void test_chain(void)
{
    struct mind *m = mind_with(true, rules);
    line(m, "(assert (go))");
    diary(m);
    long long go, position;
    const char *said = strstr(text, "L (assert (go))\n+");
    CU_ASSERT_PTR_NOT_NULL_FATAL(said);
    CU_ASSERT_EQUAL(sscanf(said, "L (assert (go))\n+%lld", &go), 1);
    step(m, 2);
    CU_ASSERT_EQUAL(sscanf(diary(m), "S\n+%lld", &position), 1);
    char chain[256];
    snprintf(chain, sizeof chain, "R see %lld,%lld\nV 300.0 20.0\nT blue - near 2000.0", position,
             go);
    CU_ASSERT(has(chain));
    snprintf(chain, sizeof chain, "R alone %lld,*\n+%lld (lonely)\nV 0.0 0.0\n", go, position + 1);
    CU_ASSERT(has(chain));
    mind_close(m);
}

/* Who looks at what was sensed is not its cause, and it is not the cause of what the rule does. */
static void test_look(void)
{
    struct mind *m = mind_with(true, "(defrule look (position $?) => (get-fact-list) "
                                     "(assert (seen)))\n");
    const float sonar_m[] = {1};
    struct mu_percept percept = {
        .time_ns = 100000000, .sonar_m = sonar_m, .sonar_count = 1, .battery_share = -1};
    struct mind_act act;
    diary(m);
    mind_percept(m, &percept);
    mind_fire(m, &act);
    diary(m);
    CU_ASSERT_EQUAL(strncmp(text, "S\n", 2), 0);
    const char *rule = strstr(text, "R look ");
    CU_ASSERT_PTR_NOT_NULL_FATAL(rule);
    long long sonar, position, seen;
    int read = sscanf(rule, "R look %lld\n=%lld (sonar 0.1 1000.0)\n+%lld (seen)\n", &position,
                      &sonar, &seen);
    CU_ASSERT_EQUAL(read, 3);
    mind_close(m);
}

static void test_mail(void)
{
    struct mind *m = mind_with(true, rules);
    diary(m);
    struct mind_mail mail = {.id = 7,
                             .src = "blue",
                             .performative = "tell",
                             .language = "",
                             .ontology = "",
                             .reply_with = "",
                             .in_reply_to = "",
                             .conversation = "",
                             .content = "hello blue"};
    CU_ASSERT_EQUAL(mind_take_mail(m, &mail), MU_OK);
    step(m, 0);
    diary(m);
    CU_ASSERT(has("M blue 7 tell hello blue\n+"));
    CU_ASSERT(has(" (message hello blue)\n"));
    CU_ASSERT(has("R hear "));
    CU_ASSERT(has(" (friend blue)\n"));
    mind_close(m);
}

static void test_agenda(void)
{
    struct mind *m = mind_with(true, "(defrule later (go ?x) =>)\n");
    struct mind_act act;
    line(m, "(assert (go 1) (go 2) (go 3))");
    diary(m);
    mind_fire_some(m, 1, &act);
    diary(m);
    size_t left = 0;
    for (const char *at = strstr(text, "A later "); at; at = strstr(at + 1, "A later ")) {
        left++;
    }
    CU_ASSERT_EQUAL(left, 2);
    mind_close(m);
}

/* Strangers' text stays in its line, and says nothing that is not so. */
static void test_garbage(void)
{
    struct mind *m = mind_with(true, "");
    diary(m);
    line(m, "(assert (note \"two\n+9 (lies)\rlines\"))");
    diary(m);
    CU_ASSERT(has("(note \"two\\n+9 (lies)\\rlines\")\n"));
    CU_ASSERT_PTR_NULL(strstr(text, "\n+9 "));
    struct mind_mail mail = {.src = "blue",
                             .performative = "",
                             .language = "text",
                             .ontology = "",
                             .reply_with = "",
                             .in_reply_to = "",
                             .conversation = "",
                             .content = "a\nR forged 1"};
    CU_ASSERT_EQUAL(mind_take_mail(m, &mail), MU_OK);
    CU_ASSERT_PTR_NULL(strstr(diary(m), "\nR forged"));
    mind_close(m);
}

static void test_limit(void)
{
    struct mind *m = mind_with(true, "");
    diary(m);
    line(m, "(loop-for-count (?i 1 2000) (assert (filler-for-a-diary ?i)))");
    diary(m);
    CU_ASSERT(strlen(text) <= MU_NOTE_MAX);
    const char *lost = strstr(text, "\n~ ");
    unsigned count = 0, lines = 0;
    CU_ASSERT_PTR_NOT_NULL_FATAL(lost);
    CU_ASSERT_EQUAL(sscanf(lost, "\n~ %u\n", &count), 1);
    for (const char *at = strstr(text, "\n+"); at; at = strstr(at + 1, "\n+")) {
        lines++;
    }
    CU_ASSERT_EQUAL(lines + count, 2000);
    step(m, 1);
    CU_ASSERT_PTR_NULL(strstr(diary(m), "~"));
    mind_close(m);
}

/* Instances have names, not indices: a rule may stand on both. */
static void test_instances(void)
{
    struct mind *m = mind_with(
        true, "(defclass BALL (is-a USER) (role concrete) (pattern-match reactive))\n"
              "(defrule kick (go) (object (is-a BALL)) (not (tired)) => (assert (kicked)))\n");
    line(m, "(make-instance [ball] of BALL)");
    line(m, "(assert (go))");
    diary(m);
    step(m, 1);
    diary(m);
    CU_ASSERT(has("\nR kick 1,[ball],*\n"));
    mind_close(m);
}

/* --- what it wants ---------------------------------------------------------------------------- */

static const char *goal(struct mind *m)
{
    static char words[MU_FIELD_MAX + 1];
    mind_goal(m, words);
    return words;
}

static void test_goal(void)
{
    struct mind *m = mind_with(false, "");
    CU_ASSERT_STRING_EQUAL(goal(m), "");
    line(m, "(assert (goal stay) (goal gohome 3000.0 -2 \"a b\" [i] nil))");
    CU_ASSERT_STRING_EQUAL(goal(m), "gohome 3000.0 -2 a b i nil");
    line(m, "(do-for-fact ((?f goal)) (eq (nth$ 1 ?f:implied) gohome) (retract ?f))");
    CU_ASSERT_STRING_EQUAL(goal(m), "stay");
    line(m, "(assert (goal a-goal-that-is-longer-than-what-anybody-wants-to-read "
            "beside-a-robot))");
    CU_ASSERT_EQUAL(strlen(goal(m)), MU_FIELD_MAX);
    line(m, "(reset)");
    CU_ASSERT_STRING_EQUAL(goal(m), "");
    mind_close(m);
}

static void test_goal_with_slots_is_none(void)
{
    struct mind *m = mind_with(false, "(deftemplate goal (slot x))");
    line(m, "(assert (goal (x 1)))");
    CU_ASSERT_STRING_EQUAL(goal(m), "");
    mind_close(m);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"off", test_off},
        {"begins anew", test_begins_anew},
        {"percept", test_percept},
        {"extreme readings", test_extreme_readings},
        {"a chain of causes", test_chain},
        {"a look at what was sensed", test_look},
        {"mail", test_mail},
        {"agenda", test_agenda},
        {"garbage", test_garbage},
        {"instances", test_instances},
        {"limit: bytes", test_limit},
        {"goal", test_goal},
        {"a goal with slots is none", test_goal_with_slots_is_none},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/trace", tests);
}
