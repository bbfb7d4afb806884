/* SPDX-License-Identifier: Apache-2.0 */
/* The mind from C: its limits, its globals, and the fragment of rules that the paper publishes. */
#include "mind/mind.h"
#include "core/text_file.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MINDS_MAX = 32, SONARS = 16, PRINTED = 8192 };

static struct mind *minds[MINDS_MAX]; /* a mind's memory is for the life of the process */
static size_t mind_count;
static char printed[PRINTED];
static size_t printed_bytes;
static char posted[MU_CONTENT_MAX + 64];
static float sonar_m[SONARS];
static uint64_t steps;

static void print(void *self, const char *text)
{
    (void)self;
    printed_bytes += strlen(text);
    size_t len = strlen(printed);
    snprintf(printed + len, sizeof printed - len, "%s", text);
}

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    snprintf(posted, sizeof posted, "%s: %s", letter->dst, letter->content);
    return MU_OK;
}

static struct mind *open_mind(const char *rules_folder)
{
    struct mu_fault fault;
    struct mind *m = NULL;
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = "blue",
                                   .seed = 1,
                                   .rules_folder = rules_folder,
                                   .forward_max_m_s = 0.5,
                                   .turn_max_rad_s = 1.6,
                                   .ports = {.send = post, .print = print}};
    mu_result r = mind_open(&m, &options, &fault);
    if (r != MU_OK) {
        mu_fault_print(&fault);
    }
    CU_ASSERT_EQUAL_FATAL(r, MU_OK);
    CU_ASSERT_FATAL(mind_count < MINDS_MAX);
    minds[mind_count++] = m;
    printed[0] = '\0';
    printed_bytes = 0;
    posted[0] = '\0';
    for (size_t i = 0; i < SONARS; i++) {
        sonar_m[i] = 5;
    }
    return m;
}

static mu_result say(struct mind *m, const char *line, char *answer, size_t size)
{
    struct mu_text out;
    mu_text_init(&out, answer, size);
    return mind_line(m, line, &out);
}

static mu_result answers(struct mind *m, const char *line, const char *want)
{
    static char got[4096];
    mu_result r = say(m, line, got, sizeof got);
    if (strcmp(got, want) != 0) {
        printf("\n  %.60s\n  want %s  got  %s", line, want, got);
    }
    CU_ASSERT_STRING_EQUAL(got, want);
    return r;
}

static void sense(struct mind *m)
{
    struct mu_percept p = {.time_ns = steps++ * MU_STEP_NS,
                           .x_m = 1,
                           .y_m = 2,
                           .sonar_count = SONARS,
                           .sonar_m = sonar_m};
    mind_percept(m, &p);
}

static mu_result take_mail(struct mind *m, uint64_t id, const char *content)
{
    struct mind_mail mail = {id, "red", "", "", "", "", "", "", content, 0, 0};
    return mind_take_mail(m, &mail);
}

static void take(struct mind *m, uint64_t id, const char *content)
{
    CU_ASSERT_EQUAL(take_mail(m, id, content), MU_OK);
}

static struct mind_act step(struct mind *m)
{
    struct mind_act act;
    sense(m);
    mind_fire(m, &act);
    return act;
}

/* (moveTo), (clone) and (dispose) let the right-hand side run to its end, and end the step; of
 * several wishes the first counts. */
static void test_who_wants_to_go_goes_at_the_end_of_its_right_hand_side(void)
{
    static const struct {
        const char *call;
        enum mind_travel_kind kind;
    } wishes[] = {{"(moveTo south)", MIND_MOVES},
                  {"(clone ruby south)", MIND_CLONES},
                  {"(dispose)", MIND_DISPOSES}};
    struct mind *m = open_mind(NULL);
    (void)say(m,
              "(defrule go (declare (salience 1)) (go ?call) => (eval ?call) (moveTo north)"
              " (setSpeed 100 0))",
              (char[256]){0}, 256);
    (void)say(m, "(defrule later (go ?) =>)", (char[256]){0}, 256);
    for (size_t i = 0; i < sizeof wishes / sizeof wishes[0]; i++) {
        char line[64];
        snprintf(line, sizeof line, "(assert (go \"%s\"))", wishes[i].call);
        (void)say(m, line, (char[256]){0}, 256);
        struct mind_act act = step(m);
        CU_ASSERT_STRING_EQUAL(act.rules, "go");
        CU_ASSERT_TRUE(act.drives);
        struct mind_travel travel = mind_travel(m);
        CU_ASSERT_EQUAL(travel.kind, wishes[i].kind);
        CU_ASSERT_STRING_EQUAL(travel.host, wishes[i].kind == MIND_DISPOSES ? "" : "south");
        CU_ASSERT_EQUAL(mind_travel(m).kind, MIND_STAYS);
        act = step(m);
        CU_ASSERT_STRING_EQUAL(act.rules, "later");
    }
}

static void test_name_is_checked(void)
{
    struct mu_fault fault;
    struct mind *m = NULL;
    struct mind_options options = {.name = "not a name"};
    CU_ASSERT_EQUAL(mind_open(&m, &options, &fault), MU_FAULT_FILE);
}

static void test_paper_fragment(void)
{
    const char *folder = getenv("MUSTER_TEST_DATA");
    char path[512];
    struct mu_fault fault;
    if (!folder) {
        printf("skipped: MUSTER_TEST_DATA is not set ");
        return;
    }
    snprintf(path, sizeof path, "%s/paper-fragment.clp", folder);
    struct mind *m = open_mind("rules");
    CU_ASSERT_EQUAL_FATAL(mind_load(m, path, &fault), MU_OK);
    CU_ASSERT_EQUAL(mind_set_global(m, "mate", "red"), MU_OK);
    char answer[256];
    CU_ASSERT_EQUAL(say(m, "(follow red)", answer, sizeof answer), MU_OK);
    struct mind_act act = step(m);
    CU_ASSERT_STRING_EQUAL(act.rules, "wait-for-mate");
    sense(m);
    take(m, 1, "mate-pos red 5000.0 2000.0");
    mind_fire(m, &act);
    CU_ASSERT_STRING_EQUAL(act.rules, "follow-robot");
    CU_ASSERT_EQUAL(act.end, MIND_SENSE_AGAIN);
    CU_ASSERT(act.drives && act.forward_m_s > 0.3 && fabs(act.turn_rad_s) < 1e-9);
    CU_ASSERT_STRING_EQUAL(posted, "all: mate-pos blue 1000.0 2000.0");
    sonar_m[5] = 0.3F; /* something close at the right */
    act = step(m);
    CU_ASSERT_STRING_EQUAL(act.rules, "safe-following");
    CU_ASSERT(act.turn_rad_s > 0);
    for (size_t i = 1; i <= 6; i++) {
        sonar_m[i] = 0.2F;
    }
    act = step(m);
    CU_ASSERT(act.forward_m_s == 0 && act.turn_rad_s == 1.6); /* 180 deg/s, clamped */
    CU_ASSERT_EQUAL(say(m, "(ppdefrule follow-robot)", answer, sizeof answer), MU_OK);
    CU_ASSERT_PTR_NOT_NULL(strstr(answer, "(message mate-pos ?*mate* ?mate-x ?mate-y)"));
    mind_close(m);
}

static void test_globals(void)
{
    struct mind *m = open_mind(NULL);
    CU_ASSERT_EQUAL(answers(m, "?*my-name*", "blue\n"), MU_OK);
    CU_ASSERT_EQUAL(mind_set_global(m, "mate", "red"), MU_OK);
    CU_ASSERT_EQUAL(mind_set_global(m, "follow-distance", "700.5"), MU_OK);
    CU_ASSERT_EQUAL(mind_set_global(m, "no-such", "1"), MU_ABSENT);
    CU_ASSERT_EQUAL(mind_set_global(m, "mate", "red) (x"), MU_MALFORMED);
    CU_ASSERT_EQUAL(mind_set_global(m, "mate", ""), MU_MALFORMED);
    CU_ASSERT_EQUAL(answers(m, "(reset)", ""), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(create$ ?*mate* ?*follow-distance*)", "(red 700.5)\n"), MU_OK);
    mind_close(m);
}

static void test_limit_line(void)
{
    static char line[20000];
    struct mind *m = open_mind(NULL);
    memset(line, ' ', 16384);
    memcpy(line, "(+ 1 2)", 7);
    line[16384] = '\0';
    CU_ASSERT_EQUAL(answers(m, line, "3\n"), MU_OK);
    line[16384] = ' ';
    line[16385] = '\0';
    CU_ASSERT_EQUAL(answers(m, line, "a line has at most 16384 bytes\n"), MU_MALFORMED);
    mind_close(m);
}

static void nest(char *line, int depth)
{
    struct mu_text t;
    mu_text_init(&t, line, 4096);
    for (int i = 0; i < depth; i++) {
        mu_text_add(&t, "(+ 1 ");
    }
    mu_text_add(&t, "1");
    for (int i = 0; i < depth; i++) {
        mu_text_add(&t, ")");
    }
}

static void test_limit_nesting(void)
{
    static char line[4096];
    static char answer[4096];
    struct mind *m = open_mind(NULL);
    for (int depth = 256; depth <= 257; depth++) {
        nest(line, depth);
        CU_ASSERT_EQUAL(say(m, line, answer, sizeof answer), depth == 256 ? MU_OK : MU_MALFORMED);
    }
    mind_close(m);
}

/* Mails first to last - 1; content is their number. */
static void take_many(struct mind *m, uint64_t first, uint64_t last)
{
    for (uint64_t i = first; i < last; i++) {
        char content[32];
        snprintf(content, sizeof content, "word%llu x", (unsigned long long)i);
        take(m, i, content);
    }
}

static void test_limit_messages(void)
{
    struct mind *m = open_mind(NULL);
    sense(m);
    take_many(m, 0, 1025);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (message $?)))", "1024\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (message word0 x)))", "0\n"), MU_OK);
    mind_close(m);
}

/* Nobody looks at mail facts: there are none, and for (getmsg) the latest wait. */
static void test_limit_parked(void)
{
    struct mind *m = open_mind(NULL);
    sense(m);
    take_many(m, 0, 1025);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (mail)))", "0\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(getmsg)", "(red word1 x)\n"), MU_OK);
    mind_close(m);
}

static void test_limit_parked_bytes(void)
{
    static char content[MU_CONTENT_MAX + 1];
    struct mind *m = open_mind(NULL);
    sense(m);
    memset(content, 'x', MU_CONTENT_MAX);
    for (uint64_t i = 1; i <= 40; i++) { /* 15 of them fit; they go round the ring twice */
        int digits = snprintf(content, sizeof content, "w%llu", (unsigned long long)i);
        content[digits] = ' ';
        take(m, i, content);
    }
    for (int i = 26; i <= 40; i++) {
        char want[16];
        snprintf(want, sizeof want, "w%d\n", i);
        CU_ASSERT_EQUAL(answers(m, "(nth$ 2 (getmsg))", want), MU_OK);
    }
    CU_ASSERT_EQUAL(answers(m, "(getmsg)", "()\n"), MU_OK);
    mind_close(m);
}

/* A construct calls (getmsg): what waits for it is not thrown away. */
static void test_limit_getmsg(void)
{
    char answer[64];
    struct mind *m = open_mind(NULL);
    CU_ASSERT_EQUAL(say(m, "(deffunction next () (getmsg))", answer, sizeof answer), MU_OK);
    sense(m);
    take_many(m, 0, 1024);
    CU_ASSERT_EQUAL(take_mail(m, 1024, "one too many"), MU_FULL);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (message one $?)))", "1\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(next)", "(red word0 x)\n"), MU_OK);
    CU_ASSERT_EQUAL(take_mail(m, 1025, "one more"), MU_OK);
    CU_ASSERT_EQUAL(take_mail(m, 1026, "one too many"), MU_FULL);
    mind_close(m);
}

/* A rule waits for mail: 1024 facts stand, and the next is refused until one is taken. */
static void test_limit_mails(void)
{
    char answer[64];
    struct mind *m = open_mind(NULL);
    CU_ASSERT_EQUAL(say(m,
                        "(defrule one (go) ?m <- (mail (content word500 x)) (mail (from red))"
                        " => (retract ?m))",
                        answer, sizeof answer),
                    MU_OK);
    sense(m);
    take_many(m, 0, 1024);
    CU_ASSERT_EQUAL(take_mail(m, 1024, "one too many"), MU_FULL);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (message one $?)))", "1\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (mail)))", "1024\n"), MU_OK);
    CU_ASSERT_EQUAL(say(m, "(assert (go))", answer, sizeof answer), MU_OK);
    CU_ASSERT(step(m).firings > 0);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (mail)))", "1023\n"), MU_OK);
    CU_ASSERT_EQUAL(take_mail(m, 1025, "one more"), MU_OK);
    CU_ASSERT_EQUAL(take_mail(m, 1026, "one too many"), MU_FULL);
    CU_ASSERT_EQUAL(answers(m, "(getmsg)", "(red word0 x)\n"), MU_OK);
    mind_close(m);
}

/* C code holds these: to remove them is refused, and nothing is left dangling. */
static void test_held(void)
{
    char answer[1024];
    struct mind *m = open_mind(NULL);
    (void)!say(m, "(undeftemplate *) (undeftemplate mail)", answer, sizeof answer);
    (void)!say(m, "(undefglobal *) (undefglobal care)", answer, sizeof answer);
    sense(m);
    take(m, 1, "hello");
    CU_ASSERT_EQUAL(answers(m, "(length$ (clear-way 0))", "2\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (message hello)))", "1\n"), MU_OK);
    CU_ASSERT_EQUAL(say(m, "(defglobal ?*sonar-margin* = 100)", answer, sizeof answer), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(sonar-data 300)", "200.0\n"), MU_OK);
    mind_close(m);
}

static void test_limit_content(void)
{
    static char content[MU_CONTENT_MAX + 2];
    static char answer[2 * MU_CONTENT_MAX];
    struct mind *m = open_mind(NULL);
    sense(m);
    memset(content, 'x', MU_CONTENT_MAX);
    take(m, 1, content);
    CU_ASSERT_EQUAL(answers(m, "(str-length (nth$ 2 (getmsg)))", "16384\n"), MU_OK);
    CU_ASSERT_EQUAL(say(m,
                        "(bind ?s \"x\") (loop-for-count (?i 1 14) do (bind ?s (str-cat ?s ?s)))"
                        " (send red (sub-string 3 16384 ?s))",
                        answer, sizeof answer),
                    MU_OK);
    CU_ASSERT_EQUAL(strlen(posted), strlen("red: ") + 16384);
    CU_ASSERT_EQUAL(say(m, "(send red (sub-string 2 16384 ?s))", answer, sizeof answer),
                    MU_MALFORMED);
    CU_ASSERT_PTR_NOT_NULL(strstr(answer, "a content of at most 16384 bytes"));
    mind_close(m);
}

static void test_limit_print(void)
{
    char answer[256];
    struct mind *m = open_mind(NULL);
    CU_ASSERT_EQUAL(say(m,
                        "(defrule talk (talk) => (loop-for-count (?i 1 200000) do"
                        " (printout t \"ten bytes.\")))",
                        answer, sizeof answer),
                    MU_OK);
    CU_ASSERT_EQUAL(say(m, "(assert (talk))", answer, sizeof answer), MU_OK);
    struct mind_act act = step(m);
    CU_ASSERT_EQUAL(act.firings, 1);
    CU_ASSERT(printed_bytes > 65000 && printed_bytes < 64 * 1024 + 200);
    mind_close(m);
}

static void test_limit_fired_names(void)
{
    char answer[256];
    struct mind *m = open_mind(NULL);
    CU_ASSERT_EQUAL(say(m,
                        "(defrule a-name-that-is-long-enough-to-fill-8-KiB-with-200-of-it "
                        "?n <- (n ?x) => (retract ?n) (assert (n (+ ?x 1))))",
                        answer, sizeof answer),
                    MU_OK);
    CU_ASSERT_EQUAL(say(m, "(assert (n 1))", answer, sizeof answer), MU_OK);
    struct mind_act act = step(m);
    CU_ASSERT_EQUAL(act.firings, MU_FIRINGS_PER_STEP);
    CU_ASSERT_EQUAL(act.end, MIND_BUDGET);
    CU_ASSERT(strlen(act.rules) == 8191);
    mind_close(m);
}

static void test_some_rules_are_fired_and_no_more(void)
{
    char answer[256];
    struct mind_act act;
    struct mind *m = open_mind(NULL);
    CU_ASSERT_EQUAL(say(m, "(defrule one ?n <- (n ?x) => (retract ?n) (assert (n (+ ?x 1))))",
                        answer, sizeof answer),
                    MU_OK);
    CU_ASSERT_EQUAL(say(m, "(assert (n 1))", answer, sizeof answer), MU_OK);
    sense(m);
    mind_fire_some(m, 2, &act);
    CU_ASSERT_EQUAL(act.firings, 2);
    CU_ASSERT_STRING_EQUAL(act.rules, "one one");
    CU_ASSERT_EQUAL(act.end, MIND_BUDGET);
    sense(m);
    mind_fire_some(m, UINT32_MAX, &act);
    CU_ASSERT_EQUAL(act.firings, MU_FIRINGS_PER_STEP);
    mind_close(m);
}

static bool file_write(const char *path, const char *text, size_t blanks)
{
    FILE *f = fopen(path, "w");
    if (!f) {
        return false;
    }
    fputs(text, f);
    for (size_t i = 0; i < blanks; i++) {
        fputc(' ', f);
    }
    return fclose(f) == 0;
}

static void test_limit_file(void)
{
    enum { MIB = 1 << 20 };
    char path[] = "/tmp/muster-test-XXXXXX";
    struct mu_fault fault;
    struct mind *m = open_mind(NULL);
    int fd = mkstemp(path);
    CU_ASSERT_FATAL(fd >= 0);
    close(fd);
    CU_ASSERT(file_write(path, "(deffacts x (x))", MIB - 16));
    CU_ASSERT_EQUAL(mind_load(m, path, &fault), MU_OK);
    CU_ASSERT(file_write(path, "(deffacts x (x))", MIB - 15));
    CU_ASSERT_EQUAL(mind_load(m, path, &fault), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "1 MiB"));
    unlink(path);
    CU_ASSERT_EQUAL(mind_load(m, path, &fault), MU_FAULT_FILE);
    mind_close(m);
}

static void test_limit_extends(void)
{
    enum { DEEP = 17 };
    char folder[] = "/tmp/muster-test-XXXXXX";
    char path[DEEP][64];
    struct mu_fault fault;
    struct mind *m = open_mind(NULL);
    CU_ASSERT_PTR_NOT_NULL_FATAL(mkdtemp(folder));
    for (int i = 0; i < DEEP; i++) {
        char text[64];
        snprintf(path[i], sizeof path[i], "%s/%d.clp", folder, i);
        snprintf(text, sizeof text, "%s(extends \"%d.clp\")", i + 1 < DEEP ? "" : "; ", i + 1);
        CU_ASSERT(file_write(path[i], text, 0));
    }
    CU_ASSERT_EQUAL(mind_load(m, path[1], &fault), MU_OK);
    CU_ASSERT_EQUAL(mind_load(m, path[0], &fault), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "more than 16 files deep"));
    for (int i = 0; i < DEEP; i++) {
        unlink(path[i]);
    }
    rmdir(folder);
    mind_close(m);
}

static void test_percepts_that_are_no_numbers(void)
{
    struct mind *m = open_mind(NULL);
    float bad[2] = {NAN, INFINITY};
    struct mu_blob blob = {0xff0000, NAN, INFINITY, NAN};
    struct mu_fiducial fiducial = {1, NAN, INFINITY, NAN};
    struct mu_percept p = {.x_m = NAN,
                           .y_m = INFINITY,
                           .gps_x_m = NAN,
                           .compass_rad = INFINITY,
                           .battery_share = NAN,
                           .sonar_count = 2,
                           .sonar_m = bad,
                           .laser_count = 2,
                           .laser_m = bad,
                           .blob_count = 1,
                           .blobs = &blob,
                           .fiducial_count = 1,
                           .fiducials = &fiducial};
    mind_percept(m, &p);
    CU_ASSERT_EQUAL(answers(m, "(gps) (sonar)", "(0.0 0.0 0.0)\n(0.0 0.0)\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(laser) (camera)", "(0.0 0.0)\n(red 0.0 0.0 0.0)\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(fiducials) (battery)", "(1 0.0 0.0 0.0)\n0.0\n"), MU_OK);
    mind_close(m);
}

/* What is more than a mind has room for is left out; what comes after a call is not hurt. */
static void test_limit_readings(void)
{
    static float laser_m[MU_BEAMS_MAX + 1];
    static struct mu_blob blobs[MU_BLOBS_MAX + 1];
    static struct mu_fiducial fiducials[MU_FIDUCIALS_MAX + 1];
    struct mind *m = open_mind(NULL);
    struct mu_percept p = {.laser_count = MU_BEAMS_MAX + 1,
                           .laser_m = laser_m,
                           .blob_count = MU_BLOBS_MAX + 1,
                           .blobs = blobs,
                           .fiducial_count = MU_FIDUCIALS_MAX + 1,
                           .fiducials = fiducials};
    mind_percept(m, &p);
    CU_ASSERT_EQUAL(answers(m, "(length$ (laser))", "1024\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(div (length$ (camera)) 4)", "32\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(div (length$ (fiducials)) 4)", "32\n"), MU_OK);
    mind_close(m);
}

/* What was felt before goes; mail and rules go on. */
static void test_a_mind_without_a_body(void)
{
    struct mind_act act;
    struct mind *m = open_mind(NULL);
    sense(m);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (position $?)))", "1\n"), MU_OK);
    mind_feel_nothing(m, 7 * MU_STEP_NS);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (position $?)))", "0\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(length$ (findall (sonar $?)))", "0\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(now)", "0.7\n"), MU_OK);
    CU_ASSERT_EQUAL(answers(m, "(defrule heard (message hello) =>)", ""), MU_OK);
    take(m, 1, "hello");
    mind_fire(m, &act);
    CU_ASSERT_STRING_EQUAL(act.rules, "heard");
    mind_close(m);
}

static void test_same_seed_same_numbers(void)
{
    char first[256];
    struct mind *m = open_mind(NULL);
    struct mind *other = open_mind(NULL);
    CU_ASSERT_EQUAL(say(m, "(create$ (random) (random) (random))", first, sizeof first), MU_OK);
    CU_ASSERT_EQUAL(answers(other, "(create$ (random) (random) (random))", first), MU_OK);
    mind_close(m);
    mind_close(other);
}

static void test_which_rules_speak(void)
{
    static const struct {
        const char *rules;
        bool speaks;
    } cases[] = {
        {"(defrule a (step) => (printout t tell crlf))", false},
        {"(defrule a (step) (not (send red)) => (assert (send blue)))", false},
        {"(deffunction f () (new-goal stay)) (defrule a (step) => (f) (suspend))", false},
        {"(defrule a (step) => (if (> 1 0) then (send red hello)))", true},
        {"(deffunction f (?who) (ask-one ?who status))", true},
        {"(defrule a (step ?x&:(broadcast ?x)) =>)", true},
        {"(defrule a (step) => (eval \"(send red hello)\"))", true},
        {"(defrule a (step) => (funcall send red hello))", true},
        {"(defrule a (step) => (group-join scouts))", true},
        {"(defglobal ?*x* = (tell red hello))", true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct mu_fault fault;
        struct mind *m = open_mind("rules");
        CU_ASSERT_FALSE(mind_speaks(m)); /* the library does */
        mu_result loaded = mind_load_text(m, "a.clp", cases[i].rules, &fault);
        if (loaded != MU_OK) {
            mu_fault_print(&fault);
        }
        CU_ASSERT_EQUAL(loaded, MU_OK);
        CU_ASSERT_EQUAL(mind_speaks(m), cases[i].speaks);
        (void)say(m, "(send red hello)", (char[256]){0}, 256);
        CU_ASSERT_EQUAL(mind_speaks(m), cases[i].speaks); /* a person has said that */
        mind_close(m);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a name is checked", test_name_is_checked},
        {"who wants to go goes at the end of its right-hand side",
         test_who_wants_to_go_goes_at_the_end_of_its_right_hand_side},
        {"the paper's fragment runs unchanged", test_paper_fragment},
        {"globals are set, and survive (reset)", test_globals},
        {"limit: a line", test_limit_line},
        {"limit: nesting", test_limit_nesting},
        {"limit: message facts", test_limit_messages},
        {"limit: mails that nobody takes", test_limit_parked},
        {"limit: bytes of mails that nobody takes", test_limit_parked_bytes},
        {"limit: mails for getmsg", test_limit_getmsg},
        {"limit: mail facts", test_limit_mails},
        {"what C code holds stays", test_held},
        {"limit: content", test_limit_content},
        {"limit: what a step prints", test_limit_print},
        {"limit: names of the rules fired", test_limit_fired_names},
        {"some rules are fired and no more", test_some_rules_are_fired_and_no_more},
        {"limit: size of a rule file", test_limit_file},
        {"limit: files that extend each other", test_limit_extends},
        {"percepts that are no numbers", test_percepts_that_are_no_numbers},
        {"limit: readings", test_limit_readings},
        {"a mind without a body", test_a_mind_without_a_body},
        {"which rules speak", test_which_rules_speak},
        {"the same seed gives the same numbers", test_same_seed_same_numbers},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/mind", tests);
}
