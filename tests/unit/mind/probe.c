/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A mind that is looked at all the time and one that is not: the same rules in the same order, the
 * same mail and diary, what is watched is shown alike, and at the end the same snapshot.
 */
#include "core/probe.h"
#include "core/random.h"
#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

enum { SNAPSHOT_MAX = 1 << 20, LOG_MAX = 1 << 20, SHOWN_MAX = 256 << 10, SONARS = 16 };

/* A mind, and what it has said and done. */
struct soul {
    struct mind *mind;
    char log_bytes[LOG_MAX];
    struct mu_text log;
    bool traces; /* somebody watches */
};

static struct soul alone, looked;
static char snapshot_bytes[SNAPSHOT_MAX], other_bytes[SNAPSHOT_MAX];

static mu_result post(void *self, const struct mind_letter *letter)
{
    struct soul *s = self;
    mu_text_format(&s->log, "to %s: %s\n", letter->dst, letter->content);
    return MU_OK;
}

static void print(void *self, const char *text)
{
    mu_text_add(&((struct soul *)self)->log, text);
}

static bool trace(void *self, const char *text)
{
    print(self, text);
    return ((struct soul *)self)->traces;
}

static mu_result nobody(void *self, const char *name, struct mind_member *out)
{
    (void)self;
    (void)name;
    (void)out;
    return MU_ABSENT;
}

static mu_result none(void *self, size_t index, struct mind_member *out)
{
    (void)self;
    (void)index;
    (void)out;
    return MU_DONE;
}

static const char *entry(void *self, enum mind_list list, const char *of, size_t index)
{
    (void)self;
    (void)list;
    (void)of;
    return index == 0 ? "scouts" : NULL;
}

static void soul_begin(struct soul *s, const char *library, const char *rules)
{
    struct mu_fault fault = {.text = ""};
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = "blue",
                                   .seed = 3,
                                   .rules_folder = library,
                                   .forward_max_m_s = 0.5,
                                   .turn_max_rad_s = 1.5,
                                   .trace = true,
                                   .ports = {.self = s,
                                             .send = post,
                                             .print = print,
                                             .trace = trace,
                                             .lookup = nobody,
                                             .listing = none,
                                             .entry = entry}};
    if (s->mind) {
        mind_close(s->mind);
    } else {
        s->mind = mind_reserve();
    }
    mu_text_init(&s->log, s->log_bytes, sizeof s->log_bytes);
    s->traces = true;
    CU_ASSERT_EQUAL_FATAL(mind_begin(s->mind, &options, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mind_load_text(s->mind, "test", rules, &fault), MU_OK);
}

static void both_begin(const char *library, const char *rules)
{
    soul_begin(&alone, library, rules);
    soul_begin(&looked, library, rules);
}

static void say(struct soul *s, const char *line)
{
    static char bytes[SHOWN_MAX];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    (void)!mind_line(s->mind, line, &out);
}

static void both_say(const char *line)
{
    say(&alone, line);
    say(&looked, line);
}

/* @return what a probe shows; NULL: it is none */
static const char *look(struct soul *s, const char *line, mu_result wanted)
{
    static char bytes[SHOWN_MAX];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    mu_result got = mind_probe(s->mind, line, &out);
    if (got != wanted) {
        printf("\n  %s: %d %s\n", line, (int)got, bytes);
    }
    CU_ASSERT_EQUAL(got, wanted);
    return got == MU_ABSENT ? NULL : bytes;
}

/* With no literal, one and two of each sort; CLIPS refuses many of these. */
static void look_at_all(struct soul *s)
{
    static const char *const literals[] = {
        "", " follow-robot", " MAIN", " 1", " 0 200", " safe-following succinct", " nonsense"};
    static char bytes[SHOWN_MAX];
    char line[MU_GLANCE_LINE_MAX + 1];
    const char *word;
    for (size_t i = 0; (word = mu_probe_at(i)) != NULL; i++) {
        for (size_t k = 0; k < sizeof literals / sizeof literals[0]; k++) {
            struct mu_text out;
            mu_text_init(&out, bytes, sizeof bytes);
            snprintf(line, sizeof line, "(%s%s)", word, literals[k]);
            CU_ASSERT_NOT_EQUAL(mind_probe(s->mind, line, &out), MU_ABSENT);
        }
    }
    (void)look(s, "?*mate*", MU_OK);
    (void)look(s, "?*nobody*", MU_MALFORMED);
}

static size_t save(struct soul *s, char *to)
{
    struct mu_fault fault;
    struct mu_text out;
    mu_text_init(&out, to, SNAPSHOT_MAX);
    CU_ASSERT_EQUAL_FATAL(mind_save(s->mind, &out, &fault), MU_OK);
    return out.len;
}

static void same_souls(void)
{
    size_t len = save(&alone, snapshot_bytes), other = save(&looked, other_bytes);
    CU_ASSERT_EQUAL(len, other);
    CU_ASSERT_EQUAL(memcmp(snapshot_bytes, other_bytes, len), 0);
    size_t at = 0;
    while (alone.log.at[at] && alone.log.at[at] == looked.log.at[at]) {
        at++;
    }
    if (alone.log.at[at] != looked.log.at[at]) {
        at = at > 80 ? at - 80 : 0;
        printf("\n  alone:  %.160s\n  looked: %.160s\n", alone.log.at + at, looked.log.at + at);
    }
    CU_ASSERT_EQUAL(strcmp(alone.log.at, looked.log.at), 0);
    CU_ASSERT_FALSE(alone.log.cut);
}

/* A step's senses and mail, drawn from a stream: the same for both minds. */
static void step(struct soul *s, uint64_t n, uint32_t most)
{
    static char diary_bytes[MU_NOTE_MAX + 1];
    struct mu_text diary;
    struct mind_act act;
    struct mu_random r;
    float sonar[SONARS];
    char content[64];
    mu_random_seed(&r, n, "senses");
    for (size_t i = 0; i < SONARS; i++) {
        sonar[i] = (float)(0.2 + 4.8 * mu_random_unit(&r));
    }
    struct mu_percept p = {.time_ns = n * MU_STEP_NS,
                           .x_m = 10 * mu_random_unit(&r) - 5,
                           .y_m = 10 * mu_random_unit(&r) - 5,
                           .battery_share = -1,
                           .sonar_count = SONARS,
                           .sonar_m = sonar};
    mind_percept(s->mind, &p);
    snprintf(content, sizeof content, "mate-pos red %d %d", (int)mu_random_between(&r, 0, 5000),
             (int)mu_random_between(&r, 0, 5000));
    struct mind_mail mail = {n, "red", "", "", "", "", "", "", content, 0, 0};
    CU_ASSERT_EQUAL(mind_take_mail(s->mind, &mail), MU_OK);
    mind_fire_some(s->mind, most, &act);
    mu_text_init(&diary, diary_bytes, sizeof diary_bytes);
    mind_trace(s->mind, &diary);
    mu_text_format(&s->log, "%llu: %s [%d %a %a] end %d %s\n%s", (unsigned long long)n, act.rules,
                   act.drives, act.forward_m_s, act.turn_rad_s, (int)act.end,
                   act.why ? act.why : "", diary.at);
}

static void both_step(uint64_t n, uint32_t most)
{
    step(&alone, n, most);
    step(&looked, n, most);
    look_at_all(&looked);
}

static void test_who_is_looked_at_lives_the_same_life(void)
{
    static const char *const strategies[] = {"depth", "breadth", "lex", "mea", "random"};
    for (size_t k = 0; k < sizeof strategies / sizeof strategies[0]; k++) {
        char line[64];
        both_begin("rules", "(extends \"follower.clp\")");
        snprintf(line, sizeof line, "(set-strategy %s)", strategies[k]);
        both_say(line);
        both_say("(follow red)");
        for (uint64_t n = 1; n <= 30; n++) {
            both_step(n, n % 3 == 0 ? 2 : UINT32_MAX);
        }
        CU_ASSERT(alone.log.len > 1000);
        same_souls();
    }
}

/* The fact of the sonar ring is made for who looks, and goes with the look. */
static void test_what_nobody_matches_is_shown_and_gone_again(void)
{
    both_begin(NULL, "(defrule tick (position $?) => (assert (seen (gensym) (random))))\n");
    both_say("(watch facts)");
    for (uint64_t n = 1; n <= 20; n++) {
        both_step(n, UINT32_MAX);
        CU_ASSERT(strstr(look(&looked, "(facts)", MU_OK), "(sonar ") != NULL);
        CU_ASSERT(strstr(look(&looked, "(facts)", MU_OK), "==>") == NULL);
    }
    same_souls();
    both_say("(assert (after all))");
    both_step(21, UINT32_MAX);
    same_souls();
}

/* What a guard has counted, and that it has stopped something, stays with the step. */
static void test_guards_are_not_touched(void)
{
    both_begin(NULL, "(deffunction spin (?n) (loop-for-count ?n do (bind ?x 1)))\n"
                     "(defrule runaway (position ?t $?) => (spin 1500000) (assert (at ?t)))\n"
                     "(defrule again (at ?t) => (spin 1500000) (assert (again ?t)))\n");
    for (uint64_t n = 1; n <= 3; n++) {
        both_step(n, UINT32_MAX);
    }
    CU_ASSERT(strstr(alone.log.at, "ticks") != NULL);
    same_souls();
}

static void test_a_word_that_rules_have_taken_is_none(void)
{
    both_begin(NULL, "(defglobal ?*list* = (create$ a \"b\"))\n"
                     "(defmethod facts ((?x SYMBOL)) (assert (changed)))\n");
    CU_ASSERT_PTR_NULL(look(&looked, "(facts)", MU_ABSENT));
    CU_ASSERT_PTR_NULL(look(&looked, "(facts a)", MU_ABSENT));
    CU_ASSERT_PTR_NULL(look(&looked, "(assert (a))", MU_ABSENT));
    CU_ASSERT_PTR_NULL(look(&looked, "(+ 1 2)", MU_ABSENT));
    READS(look(&looked, "?*list*", MU_OK), "(a \"b\")\n");
    READS(look(&looked, "(my-name)", MU_OK), "blue\n");
    CU_ASSERT(strstr(look(&looked, "(ppdefrule nonsense)", MU_OK), "Unable to find") != NULL);
    CU_ASSERT(strstr(look(&looked, "(ppdefrule)", MU_MALFORMED), "expected exactly 1") != NULL);
    same_souls();
}

/* It shows what a line would, rules with globals in patterns as they were written. */
static void test_a_probe_shows_what_a_line_does(void)
{
    static const char *const lines[] = {"(facts)",     "(rules)",           "(agenda)",
                                        "(matches g)", "(ppdefrule g)",     "(list-defglobals)",
                                        "?*mate*",     "(ppdefglobal mate)"};
    static char first[SHOWN_MAX], bytes[SHOWN_MAX];
    both_begin(NULL, "(deffacts f (goal nil) (goal stay))\n(defrule g (goal ?*mate*) => (gensym))");
    both_say("(run)");
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct mu_text out;
        mu_text_init(&out, bytes, sizeof bytes);
        CU_ASSERT_EQUAL(mind_line(alone.mind, lines[i], &out), MU_OK);
        CU_ASSERT(mu_text_copy(first, sizeof first, bytes));
        READS(look(&looked, lines[i], MU_OK), first);
    }
    CU_ASSERT(strstr(look(&looked, "(ppdefrule g)", MU_OK), "(goal ?*mate*)") != NULL);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"who is looked at lives the same life", test_who_is_looked_at_lives_the_same_life},
        {"what nobody matches is shown and gone again",
         test_what_nobody_matches_is_shown_and_gone_again},
        {"guards are not touched", test_guards_are_not_touched},
        {"a word that rules have taken is none", test_a_word_that_rules_have_taken_is_none},
        {"a probe shows what a line does", test_a_probe_shows_what_a_line_does},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/probe", tests);
}
