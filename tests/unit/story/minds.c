/* SPDX-License-Identifier: Apache-2.0 */
/* Diaries read back: which facts stood when, and what a chain of causes ends in. */
#include "muster/agent.h"
#include "story/story.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 1 << 16, ROBOTS = 4 };

static char text[TEXT];
static struct mu_text out;

static struct minds *minds_new(size_t bytes)
{
    mu_text_init(&out, text, sizeof text);
    return minds_open(bytes, ROBOTS);
}

/* All facts that stood at the end of a step, a line each. */
static const char *facts(const struct minds *m, const char *robot, uint32_t step)
{
    int32_t line = minds_at(m, minds_robot(m, robot), step);
    mu_text_clear(&out);
    for (int32_t f = minds_next_fact(m, line, MINDS_NONE); f != MINDS_NONE;
         f = minds_next_fact(m, line, f)) {
        size_t bytes;
        const char *fact = minds_text(m, f, &bytes);
        mu_text_format(&out, "%lld %.*s;", m->lines[f].fact, (int)bytes, fact);
    }
    return text;
}

static void test_facts_come_and_go(void)
{
    struct minds *m = minds_new(TEXT);
    minds_add(m, "red", 0,
              "0\n+0 (initial-fact)\nS\n+1 (position 0.1)\nR go 0\n+2 (goal wander)\n");
    minds_add(m, "red", 1, "S\n-1\n+3 (position 0.2)\n");
    minds_add(m, "blue", 1, "0\n+1 (other)\n");
    minds_add(m, "red", 3, "L (retract 2)\n-2\n");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 0),
                           "0 (initial-fact);1 (position 0.1);2 (goal wander);");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 1),
                           "0 (initial-fact);2 (goal wander);3 (position 0.2);");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 2),
                           "0 (initial-fact);2 (goal wander);3 (position 0.2);");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 3), "0 (initial-fact);3 (position 0.2);");
    CU_ASSERT_STRING_EQUAL(facts(m, "blue", 9), "1 (other);");
    CU_ASSERT_STRING_EQUAL(facts(m, "blue", 0), "");
    CU_ASSERT_EQUAL(minds_robot(m, "green"), MINDS_NONE);
}

static void test_begins_anew(void)
{
    struct minds *m = minds_new(TEXT);
    minds_add(m, "red", 0, "0\n+0 (initial-fact)\n+1 (old)\n");
    minds_add(m, "red", 5, "0\n+1 (new)\n");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 4), "0 (initial-fact);1 (old);");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 5), "1 (new);");
    int32_t at = minds_at(m, 0, 5);
    CU_ASSERT_EQUAL(minds_fact(m, at, 0), MINDS_NONE); /* of the life before */
    CU_ASSERT_EQUAL(minds_fact(m, at, 1), at);
}

/* A random history against facts kept in an array. */
static void test_against_a_model(void)
{
    enum { STEPS = 400, FACTS = 64 };
    static bool stands[STEPS][FACTS];
    static char diary[4096];
    struct minds *m = minds_new(1 << 20);
    bool now[FACTS] = {false};
    srand(7);
    for (uint32_t step = 0; step < STEPS; step++) {
        struct mu_text d;
        mu_text_init(&d, diary, sizeof diary);
        mu_text_add(&d, rand() % 50 == 0 ? "0\n" : "S\n");
        memset(now, diary[0] == '0' ? 0 : now[0], diary[0] == '0' ? sizeof now : 1);
        for (int i = 0; i < rand() % 8; i++) {
            int f = rand() % FACTS;
            now[f] = !now[f];
            mu_text_format(&d, now[f] ? "+%d (fact)\n" : "-%d\n", f);
        }
        minds_add(m, "red", step, diary);
        minds_add(m, "blue", step, step % 3 ? "S\n-1\n+1 (other)\n+2 (more)\n-2\n" : "");
        memcpy(stands[step], now, sizeof now);
    }
    for (uint32_t step = 0; step < STEPS; step++) {
        bool seen[FACTS] = {false};
        int32_t line = minds_at(m, 0, step);
        for (int32_t f = minds_next_fact(m, line, MINDS_NONE); f != MINDS_NONE;
             f = minds_next_fact(m, line, f)) {
            CU_ASSERT(!seen[m->lines[f].fact]);
            seen[m->lines[f].fact] = true;
        }
        CU_ASSERT_EQUAL(memcmp(seen, stands[step], sizeof seen), 0);
    }
}

/* How deep the tree of facts below one is. */
static int depth(const struct minds *m, int32_t fact)
{
    if (fact == MINDS_NONE) {
        return 0;
    }
    int one = depth(m, m->lines[fact].below[0]);
    int other = depth(m, m->lines[fact].below[1]);
    return 1 + (one > other ? one : other);
}

static void fact_say(struct minds *m, char letter, long long index)
{
    char diary[64];
    snprintf(diary, sizeof diary, letter == '+' ? "+%lld (fact)\n" : "-%lld\n", index);
    minds_add(m, "red", 0, diary);
}

/* Whatever indices there are, and in whichever order facts go, the way to one is short: else this
 * takes 10^10 steps. */
static void test_facts_without_end(void)
{
    enum { FACTS = 100000 };
    static const unsigned shifts[] = {0, 20, 46};
    struct minds *m = minds_new(64 * FACTS);
    for (size_t k = 0; k < sizeof shifts / sizeof shifts[0]; k++) {
        for (long long i = 0; i < FACTS; i++) {
            fact_say(m, '+', i << shifts[k]);
        }
        CU_ASSERT(depth(m, m->robots[0].stands) <= 65);
        for (long long i = 0; i < FACTS; i++) {
            fact_say(m, '-', (k % 2 ? FACTS - 1 - i : i) << shifts[k]);
        }
        CU_ASSERT_EQUAL(m->robots[0].stands, MINDS_NONE);
        minds_clear(m);
    }
}

/* The line that it had gone with had no room. */
static void test_an_index_that_comes_twice(void)
{
    struct minds *m = minds_new(TEXT);
    minds_add(m, "red", 0, "+1 (old)\n+3 (three)\n+5 (five)\n");
    minds_add(m, "red", 1, "+1 (new)\n");
    minds_add(m, "red", 2, "-1\n");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 0), "1 (old);3 (three);5 (five);");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 1), "3 (three);5 (five);1 (new);");
    CU_ASSERT_STRING_EQUAL(facts(m, "red", 2), "3 (three);5 (five);");
}

static struct interventions interventions;

static uint32_t why(const struct minds *m, const char *robot, uint32_t step)
{
    struct why w = {.minds = m, .interventions = &interventions, .step_s = 0.1, .out = &out};
    mu_text_clear(&out);
    return why_speed(&w, minds_robot(m, robot), step);
}

static void test_why_down_to_a_person(void)
{
    struct minds *m = minds_new(TEXT);
    minds_add(m, "red", 0, "0\n+0 (initial-fact)\n");
    minds_add(m, "red", 20, "L (wander)\n+1 (goal wander)\n");
    minds_add(m, "red", 21, "S\n+2 (sonar 2.1 900.0)\nR drive 2,1,*\nV 300.0 0.0\n");
    minds_add(m, "red", 22, "S\n-2\n+3 (sonar 2.2 800.0)\n");
    CU_ASSERT_EQUAL(why(m, "red", 19), 0);
    CU_ASSERT_EQUAL(why(m, "red", 30), WHY_SENSED | WHY_LINE);
    CU_ASSERT_STRING_EQUAL(text, "speed and turn rate (mm/s, deg/s) 300.0 0.0, at 2.1 s\n"
                                 "  rule drive 2,1,*, at 2.1 s\n"
                                 "    f-2 (sonar 2.1 900.0)\n"
                                 "      sensed, at 2.1 s\n"
                                 "    f-1 (goal wander)\n"
                                 "      a line: (wander), at 2.0 s\n");
}

/* Who looks at a percept's fact is not sensed, nor is what follows. */
static void test_why_after_a_look(void)
{
    struct minds *m = minds_new(TEXT);
    minds_add(m, "red", 1, "0\n+0 (initial-fact)\nS\n+2 (position 0.1 1.0)\n");
    minds_add(m, "red", 2, "E on-run\nR look 0\n=1 (sonar 0.1 900.0)\n+3 (goal x)\n");
    struct why w = {.minds = m, .interventions = &interventions, .step_s = 0.1, .out = &out};
    CU_ASSERT_EQUAL(why_fact(&w, 0, 2, 3), WHY_RULES);
    CU_ASSERT_EQUAL(why_fact(&w, 0, 2, 1), WHY_SENSED);
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "sensed, at 0.1 s"));
}

static void order_add(uint32_t step, muster_RunOrder what, uint32_t senses, bool on)
{
    muster_RunCommand order = {.order = what,
                               .source = (char[]){"observer"},
                               .name = (char[]){"red"},
                               .x_m = 1,
                               .y_m = 2,
                               .force_x_n = 30,
                               .time_s = what == muster_RUN_PUSH ? 0.5 : 0,
                               .senses = senses,
                               .on = on};
    interventions_add(&interventions, step, &order);
}

/* Somebody's hands are where a chain ends, as somebody's line is. */
static void test_why_of_interventions(void)
{
    struct minds *m = minds_new(TEXT);
    minds_add(m, "red", 1, "0\n+0 (initial-fact)\n");
    order_add(9, muster_RUN_PUSH, 0, false);
    CU_ASSERT_EQUAL(why(m, "red", 8), 0);
    CU_ASSERT_EQUAL(why(m, "red", 9), WHY_INTERVENTION);
    CU_ASSERT_STRING_EQUAL(text,
                           "intervention: pushed with (30, 0) N and 0 N m for 0.5 s by observer, "
                           "at 1.0 s\n");
    minds_add(m, "red", 40, "S\n+2 (position 4.0 1.0)\nR drive 2\nV 300.0 0.0\n");
    CU_ASSERT_EQUAL(why(m, "red", 40), WHY_SENSED);
    order_add(50, muster_RUN_PLACE, 0, false);
    order_add(51, muster_RUN_SENSOR, MU_SENSE_SONAR | MU_SENSE_LASER, false);
    order_add(52, muster_RUN_SENSOR, MU_SENSE_LASER, true);
    CU_ASSERT_EQUAL(why(m, "red", 60), WHY_SENSED | WHY_INTERVENTION);
    CU_ASSERT_PTR_NOT_NULL(
        strstr(text, "\nintervention: placed at (1.00, 2.00) m by observer, at 5.1 s\n"));
    minds_add(m, "red", 61, "S\n+3 (position 6.1 1.0)\nR drive 3\nV 100.0 0.0\n");
    CU_ASSERT_EQUAL(why(m, "red", 70), WHY_SENSED | WHY_INTERVENTION);
    CU_ASSERT_PTR_NOT_NULL(strstr(text,
                                  "sensed, at 6.1 s\n        intervention: sonar switched off by "
                                  "observer, at 5.2 s\n"));
    CU_ASSERT_PTR_NULL(strstr(text, "placed"));
    interventions.count = 0;
}

static void test_why_across_a_mail(void)
{
    struct minds *m = minds_new(TEXT);
    minds_add(m, "blue", 3, "S\n+5 (position 0.3 1.0)\nR tell-all 5\nT all tell near 1.0\n");
    minds_add(m, "red", 4,
              "M blue 1 tell near 1.0\n+9 (message near 1.0)\nR flee 9\nV -100.0 0.0\n");
    minds_add(m, "red", 5, "M operator 2 - stop\n+10 (message stop)\nR halt 10\nV 0.0 0.0\n");
    CU_ASSERT_EQUAL(why(m, "red", 4), WHY_SENSED | WHY_MAIL);
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "a mail of blue 1 tell near 1.0, at 0.4 s\n"));
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "sent by blue:\n"));
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "f-5 (position 0.3 1.0)\n"));
    CU_ASSERT_EQUAL(why(m, "red", 5), WHY_MAIL);
}

static void test_why_of_a_fact(void)
{
    struct minds *m = minds_new(TEXT);
    struct why w = {.minds = m, .interventions = &interventions, .step_s = 0.1, .out = &out};
    minds_add(m, "red", 1,
              "0\n+0 (initial-fact)\nE on-run\n+1 (event on-run)\nR go 0,1\n+2 (goal x)\n");
    CU_ASSERT_EQUAL(why_fact(&w, 0, 1, 2), WHY_RULES | WHY_EVENT);
    CU_ASSERT_EQUAL(why_fact(&w, 0, 1, 3), 0);
    CU_ASSERT_EQUAL(why_fact(&w, 0, 0, 2), 0);
}

/* Rules that feed each other do not make a chain without an end. */
static void test_why_ends(void)
{
    struct minds *m = minds_new(1 << 20);
    minds_add(m, "red", 0, "0\n+0 (n 0)\n");
    for (uint32_t i = 1; i < 300; i++) {
        char diary[128];
        snprintf(diary, sizeof diary, "R count %u,%u,%u\n+%u (n %u)\nV 1.0 %u.0\n", i - 1, i / 2,
                 i / 3, i, i, i);
        minds_add(m, "red", i, diary);
    }
    CU_ASSERT(why(m, "red", 300) & WHY_UNKNOWN);
    CU_ASSERT(out.len < sizeof text / 2);
}

/* A rule that names what was long before, again and again: it is given up, and said. */
static void test_why_does_not_look_for_ever(void)
{
    enum { FACTS = 200000, MATCHES = 5000 };
    static char diary[64 + 2 * MATCHES];
    struct minds *m = minds_new(64 * FACTS);
    minds_add(m, "red", 0, "0\n+1 (first)\n");
    for (long long i = 2; i < FACTS; i++) {
        fact_say(m, '+', i);
    }
    struct mu_text d;
    mu_text_init(&d, diary, sizeof diary);
    mu_text_add(&d, "R much 1");
    for (int i = 1; i < MATCHES; i++) {
        mu_text_add(&d, ",1");
    }
    mu_text_add(&d, "\nV 1.0 1.0\n");
    minds_add(m, "red", 1, diary);
    CU_ASSERT_EQUAL(why(m, "red", 1), WHY_RULES | WHY_UNKNOWN);
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "f-1: there is too much to look through\n"));
}

static void test_garbage(void)
{
    static char noise[4096];
    struct minds *m = minds_new(TEXT);
    static const char *const wrong[] = {"+",
                                        "-",
                                        "+x (a)",
                                        "R",
                                        "T",
                                        "~",
                                        "~ 3",
                                        "?",
                                        "\n\n",
                                        "+ ",
                                        "R rule 1,,2,",
                                        "V",
                                        "M",
                                        "M x",
                                        "+99999999999999999999 (a)"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        minds_add(m, "red", (uint32_t)i, wrong[i]);
    }
    CU_ASSERT_EQUAL(m->robots[0].lost, 3);
    srand(3);
    for (uint32_t step = 20; step < 2000; step++) {
        size_t len = (size_t)rand() % (sizeof noise - 1);
        for (size_t i = 0; i < len; i++) {
            noise[i] = "0SMELR+-VTA~ 19,*(\nx"[rand() % 20];
        }
        noise[len] = '\0';
        minds_add(m, step % 3 ? "red" : "blue", step, noise);
        (void)why(m, "red", step);
    }
    CU_ASSERT(m->cut); /* there is no more than it was given */
    CU_ASSERT(m->text_len <= TEXT);
}

static void test_limit_robots(void)
{
    struct minds *m = minds_new(TEXT);
    for (int i = 0; i < ROBOTS + 3; i++) {
        char name[16];
        snprintf(name, sizeof name, "r%d", i);
        minds_add(m, name, 0, "0\n");
    }
    CU_ASSERT_EQUAL(m->robots_count, ROBOTS);
    CU_ASSERT(m->cut);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"facts come and go", test_facts_come_and_go},
        {"a mind begins anew", test_begins_anew},
        {"facts against a model", test_against_a_model},
        {"facts without end", test_facts_without_end},
        {"an index that comes twice", test_an_index_that_comes_twice},
        {"why: down to a person", test_why_down_to_a_person},
        {"why: after a look", test_why_after_a_look},
        {"why: of interventions", test_why_of_interventions},
        {"why: across a mail", test_why_across_a_mail},
        {"why: of a fact", test_why_of_a_fact},
        {"why: it ends", test_why_ends},
        {"why: it does not look for ever", test_why_does_not_look_for_ever},
        {"garbage", test_garbage},
        {"limit: robots", test_limit_robots},
        CU_TEST_INFO_NULL,
    };
    return suite_run("story/minds", tests);
}
