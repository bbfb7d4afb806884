/* SPDX-License-Identifier: Apache-2.0 */
/* Minds that want more memory or time than they may have: they are gone, and what they had is given
 * back. */
#include "mind/mind.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

enum { ROUNDS = 20, MATCHES_EVERY = 5, GROWTH_KIB_MAX = 8 << 10, HELD_KIB_LEAST = 16 << 10 };

/* The heap of a checker keeps what is given back, and says itself what is lost. */
#ifdef __SANITIZE_ADDRESS__
static const bool is_measured = false;
#else
static const bool is_measured = true;
#endif

/* A fact completes 2^28 matches. */
static const char matches[] =
    "(defrule matches (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?)"
    " (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) =>)"
    "(assert (m 1) (m 2))";

/* Many small things, and then a multifield beyond all bounds. */
static const char many[] = "(loop-for-count (?i 30000) (assert (fact ?i (str-cat \"number \" ?i))))"
                           "(bind ?*all* (create$ 1 2))"
                           "(loop-for-count 18 (bind ?*all* (create$ ?*all* ?*all*)))";
static const char giant[] =
    "(bind ?*all* (create$ ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all*"
    " ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all*"
    " ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all*"
    " ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all* ?*all*))";

static struct mind *mind;
static const struct mind_options options = {.name = "red", .seed = 1};

static long resident_kib(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "re");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    CU_ASSERT_EQUAL(fscanf(file, "%*d %ld", &pages), 1);
    fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

static mu_result say(const char *line)
{
    char answer[4096];
    struct mu_text out;
    mu_text_init(&out, answer, sizeof answer);
    mu_result r = mind_line(mind, line, &out);
    return strstr(answer, "stopped") ? MU_REFUSED : r; /* by a guard */
}

static void begin(void)
{
    struct mu_fault fault;
    mind = mind ? mind : mind_reserve();
    CU_ASSERT_EQUAL_FATAL(mind_begin(mind, &options, &fault), MU_OK);
    CU_ASSERT_EQUAL(say("(defglobal ?*all* = 0)"), MU_OK);
}

static void break_it(int round)
{
    if (round % MATCHES_EVERY == 0) {
        (void)say(matches);
        return;
    }
    long before_kib = resident_kib();
    CU_ASSERT_EQUAL(say(many), MU_OK);
    CU_ASSERT(!is_measured || resident_kib() - before_kib > HELD_KIB_LEAST);
    (void)say(giant);
}

static void test_what_a_broken_mind_had_is_given_back(void)
{
    begin();
    mind_close(mind);
    long before_kib = resident_kib();
    for (int round = 0; round < ROUNDS; round++) {
        begin();
        break_it(round);
        CU_ASSERT(mind_is_broken(mind));
        CU_ASSERT(!is_measured || resident_kib() - before_kib <
                                      GROWTH_KIB_MAX); /* at once, not when it is closed */
        mind_close(mind);
    }
    printf("%ld KiB more ", resident_kib() - before_kib);
}

/* A mind that is closed in good health gives back as much. */
static void test_what_a_mind_had_is_given_back(void)
{
    long before_kib = resident_kib();
    for (int round = 0; round < 4; round++) {
        begin();
        CU_ASSERT_EQUAL(say(many), MU_OK);
        mind_close(mind);
        CU_ASSERT(!is_measured || resident_kib() - before_kib < GROWTH_KIB_MAX);
    }
}

static void test_a_broken_mind_answers_that_it_is(void)
{
    char bytes[256], goal[MU_FIELD_MAX + 1] = "wander";
    struct mu_text out;
    struct mu_fault fault;
    struct mind_act act;
    struct mu_percept percept = {.time_ns = 0};
    begin();
    CU_ASSERT_EQUAL(say("(defrule near (sonar $?) => )"), MU_OK);
    break_it(0);
    mu_text_init(&out, bytes, sizeof bytes);
    CU_ASSERT_EQUAL(mind_line(mind, "(+ 1 1)", &out), MU_MALFORMED);
    CU_ASSERT_PTR_NOT_NULL(strstr(bytes, "the rules are gone"));
    mu_text_clear(&out);
    mind_words(mind, &out);
    CU_ASSERT_STRING_EQUAL(bytes, "");
    CU_ASSERT_EQUAL(mind_facts(mind, "", &out), MU_ABSENT);
    CU_ASSERT_EQUAL(mind_save(mind, &out, &fault), MU_REFUSED);
    CU_ASSERT_EQUAL(mind_set_global(mind, "all", "1"), MU_MALFORMED);
    CU_ASSERT_EQUAL(mind_senses(mind), 0);
    CU_ASSERT_EQUAL(mind_probe(mind, "(facts)", &out), MU_ABSENT);
    mind_goal(mind, goal);
    CU_ASSERT_STRING_EQUAL(goal, "");
    CU_ASSERT_FALSE(mind_looks_at(mind, "sonar"));
    mind_percept(mind, &percept);
    mind_feel_nothing(mind, 0);
    mind_event(mind, MU_ON_RUN);
    mind_event_now(mind, MU_ON_LEAVE, &act);
    mind_refused(mind, "group-create scouts", "group-exists");
    mind_fire(mind, &act);
    CU_ASSERT_EQUAL(act.end, MIND_STOPPED);
    CU_ASSERT_STRING_EQUAL(act.enough, "its rules are gone: memory");
    mind_close(mind);
    begin();
    CU_ASSERT_EQUAL(say("(+ 1 1)"), MU_OK);
    mind_close(mind);
}

/* A fact completes 10^10 matches, and the engine looks at nothing else before it has tried them. */
static const char tries[] = "(defrule tries (go) (m ?a) (m ?b) (m ?c) (m ?d) (m ?e)"
                            " (test (> (+ ?a ?b ?c ?d ?e) 1000000)) =>)"
                            "(loop-for-count (?i 100) (assert (m ?i))) (assert (go))";

static void test_what_goes_on_when_it_is_stopped_is_left(void)
{
    char bytes[4096];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    begin();
    CU_ASSERT_EQUAL(mind_line(mind, tries, &out), MU_MALFORMED);
    CU_ASSERT_PTR_NOT_NULL(strstr(bytes, "the rules are gone: a line has not come back from "
                                         "matching the patterns of rule tries\n"));
    mind_close(mind);
}

/* The same, of patterns in which there is nothing to count. */
static const char compares[] = "(defrule compares (m 1 ?x) (m ?k ?y) (m ? ?z) (n ?n&~?k ?) =>)"
                               "(loop-for-count (?i 30000) (assert (n 1 ?i)))"
                               "(loop-for-count (?i 100) (assert (m 1 ?i)))";

static unsigned stuck_ms;

static int stuck(void *self, unsigned ms)
{
    (void)self;
    stuck_ms = ms;
    return ms < 500 ? MIND_WAITS : MIND_BREAKS;
}

static void look(int number)
{
    (void)number;
    char bytes[320];
    struct mu_text why;
    mu_text_init(&why, bytes, sizeof bytes);
    (void)mind_look(250, &why);
}

static void look_from_now_on(void)
{
    const struct itimerval every = {.it_interval.tv_usec = 250000, .it_value.tv_usec = 250000};
    const struct sigaction action = {.sa_handler = look, .sa_flags = SA_RESTART | SA_NODEFER};
    CU_ASSERT_EQUAL(sigaction(SIGPROF, &action, NULL), 0);
    CU_ASSERT_EQUAL(setitimer(ITIMER_PROF, &every, NULL), 0);
}

static void test_what_does_not_come_back_is_left(void)
{
    char bytes[4096];
    struct mu_text out;
    struct mu_fault fault;
    const struct mind_options watched = {.name = "red", .seed = 1, .ports.stuck = stuck};
    mu_text_init(&out, bytes, sizeof bytes);
    CU_ASSERT_EQUAL_FATAL(mind_open(&mind, &watched, &fault), MU_OK);
    look_from_now_on();
    CU_ASSERT_EQUAL(say("(loop-for-count 300000 (+ 1 1))"), MU_OK);
    CU_ASSERT_EQUAL(stuck_ms, 0);
    CU_ASSERT_EQUAL(mind_line(mind, compares, &out), MU_MALFORMED);
    CU_ASSERT_EQUAL(stuck_ms, 500);
    CU_ASSERT_PTR_NOT_NULL(strstr(bytes, "the rules are gone: a line has not come back from "
                                         "matching the patterns of rule compares\n"));
    mind_close(mind);
}

/* What is not needed any more makes room for what is of another size: each time it is more than
 * half of what there may be. */
static void test_memory_of_one_size_becomes_memory_of_another(void)
{
    static const char fill[] =
        "(deffunction fill (?pad ?count)"
        " (loop-for-count (?i ?count) (assert (fact (str-cat ?pad ?i)))))"
        "(deffunction pad (?length)"
        " (bind ?pad \"\") (while (< (str-length ?pad) ?length) (bind ?pad (str-cat ?pad \".\")))"
        " ?pad)";
    static const char empty[] = "(do-for-all-facts ((?f fact)) TRUE (retract ?f))";
    begin();
    CU_ASSERT_EQUAL(say(fill), MU_OK);
    for (int length = 100; length <= 460; length += 120) {
        char line[64];
        snprintf(line, sizeof line, "(fill (pad %d) %d)", length, 38000000 / (length + 400));
        CU_ASSERT_EQUAL(say(line), MU_OK);
        CU_ASSERT_EQUAL(say(empty), MU_OK);
    }
    mind_close(mind);
}

/* A text of 4 MB, so often that its length is no number of 32 bits. */
static void test_a_text_longer_than_4_GiB_is_too_much(void)
{
    char line[8192], bytes[4096];
    struct mu_text joined, out;
    mu_text_init(&joined, line, sizeof line);
    mu_text_init(&out, bytes, sizeof bytes);
    mu_text_add(&joined, "(str-length (str-cat");
    for (int i = 0; i < 1030; i++) {
        mu_text_add(&joined, " ?*all*");
    }
    mu_text_add(&joined, "))");
    begin();
    CU_ASSERT_EQUAL(say("(bind ?*all* \"0123456789abcdef\")"
                        "(loop-for-count 18 (bind ?*all* (str-cat ?*all* ?*all*)))"),
                    MU_OK);
    CU_ASSERT_EQUAL(mind_line(mind, line, &out), MU_MALFORMED);
    CU_ASSERT_PTR_NOT_NULL(strstr(bytes, "the rules are gone"));
    mind_close(mind);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"what a broken mind had is given back", test_what_a_broken_mind_had_is_given_back},
        {"what a mind had is given back", test_what_a_mind_had_is_given_back},
        {"a broken mind answers that it is", test_a_broken_mind_answers_that_it_is},
        {"what goes on when it is stopped is left", test_what_goes_on_when_it_is_stopped_is_left},
        {"what does not come back is left", test_what_does_not_come_back_is_left},
        {"memory of one size becomes memory of another",
         test_memory_of_one_size_becomes_memory_of_another},
        {"a text longer than 4 GiB is too much", test_a_text_longer_than_4_GiB_is_too_much},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/broken", tests);
}
