/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Lines and rule files that nobody would write, from random calls of all functions and from
 * damaged rules: whatever they do, the mind answers the next line, or says that its rules are gone.
 * MUSTER_SEED and MUSTER_ROUNDS choose others and more: make soak-minds.
 */
#include "core/text_file.h"
#include "garble.h"
#include "mind/mind.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    ROUNDS = 4000,
    MINDS_MAX = 512,
    LINES_A_MIND = 5000, /* then another one begins */
    STEP_EVERY = 50,     /* lines */
    DEPTH_MAX = 5,
    TEXT_MAX = 16384,
    SONARS = 16
};

/* Functions of CLIPS and of ours, and words that are none. */
static const char *const words[] = {"+",
                                    "-",
                                    "*",
                                    "/",
                                    "div",
                                    "mod",
                                    "**",
                                    "sqrt",
                                    "exp",
                                    "log",
                                    "abs",
                                    "min",
                                    "max",
                                    "integer",
                                    "float",
                                    "round",
                                    "sin",
                                    "cos",
                                    "tan",
                                    "atan",
                                    "=",
                                    "<>",
                                    "<",
                                    ">=",
                                    "eq",
                                    "neq",
                                    "and",
                                    "or",
                                    "not",
                                    "if",
                                    "while",
                                    "loop-for-count",
                                    "progn",
                                    "progn$",
                                    "foreach",
                                    "switch",
                                    "return",
                                    "break",
                                    "bind",
                                    "assert",
                                    "retract",
                                    "modify",
                                    "duplicate",
                                    "facts",
                                    "rules",
                                    "agenda",
                                    "run",
                                    "reset",
                                    "halt",
                                    "focus",
                                    "pop-focus",
                                    "list-focus-stack",
                                    "matches",
                                    "refresh",
                                    "remove-break",
                                    "set-break",
                                    "ppdefrule",
                                    "undefrule",
                                    "undeffacts",
                                    "undeftemplate",
                                    "undeffunction",
                                    "undefglobal",
                                    "undefclass",
                                    "undefgeneric",
                                    "undefmodule",
                                    "undefinstances",
                                    "str-cat",
                                    "sym-cat",
                                    "str-length",
                                    "sub-string",
                                    "str-index",
                                    "upcase",
                                    "lowcase",
                                    "str-compare",
                                    "format",
                                    "printout",
                                    "create$",
                                    "nth$",
                                    "first$",
                                    "rest$",
                                    "insert$",
                                    "delete$",
                                    "replace$",
                                    "subseq$",
                                    "member$",
                                    "subsetp",
                                    "explode$",
                                    "implode$",
                                    "expand$",
                                    "length$",
                                    "sort",
                                    "string-to-field",
                                    "eval",
                                    "build",
                                    "funcall",
                                    "assert-string",
                                    "gensym",
                                    "gensym*",
                                    "fact-index",
                                    "fact-existp",
                                    "fact-relation",
                                    "fact-slot-value",
                                    "fact-slot-names",
                                    "any-factp",
                                    "find-fact",
                                    "find-all-facts",
                                    "do-for-fact",
                                    "do-for-all-facts",
                                    "make-instance",
                                    "send",
                                    "unmake-instance",
                                    "initialize-instance",
                                    "instances",
                                    "instance-name",
                                    "slot-insert$",
                                    "class",
                                    "superclassp",
                                    "describe-class",
                                    "browse-classes",
                                    "list-defclasses",
                                    "get-strategy",
                                    "set-strategy",
                                    "set-fact-duplication",
                                    "set-salience-evaluation",
                                    "set-dynamic-constraint-checking",
                                    "watch",
                                    "unwatch",
                                    "time",
                                    "random",
                                    "seed",
                                    "mem-used",
                                    "mem-requests",
                                    "set-current-module",
                                    "get-current-module",
                                    "get-defrule-list",
                                    "deftemplate-slot-names",
                                    "deftemplate-slot-range",
                                    "dependencies",
                                    "dependents",
                                    "timetag",
                                    "apropos",
                                    "options",
                                    "check-syntax",
                                    "symbol-to-instance-name",
                                    "position",
                                    "gps",
                                    "odometer",
                                    "stalled",
                                    "sonar",
                                    "laser",
                                    "camera",
                                    "fiducials",
                                    "bumpers",
                                    "battery",
                                    "gripper",
                                    "sonar-data",
                                    "clear-way",
                                    "speed-to",
                                    "plan",
                                    "setSpeed",
                                    "stop",
                                    "update-sensors",
                                    "broadcast",
                                    "getmsg",
                                    "speak",
                                    "tell",
                                    "ask-one",
                                    "reply",
                                    "you-do",
                                    "send-layer",
                                    "on-layer",
                                    "group-join",
                                    "members",
                                    "advertise",
                                    "find-service",
                                    "send-near",
                                    "my-name",
                                    "lookup",
                                    "listing",
                                    "failures",
                                    "findall",
                                    "fact-fields",
                                    "sind",
                                    "asind",
                                    "norm-angle",
                                    "distance",
                                    "clamp",
                                    "now",
                                    "wander",
                                    "follow",
                                    "gohome",
                                    "stay",
                                    "new-goal",
                                    "exit",
                                    "system",
                                    "open",
                                    "load",
                                    "clear",
                                    "nothing-of-that-name",
                                    "steer",
                                    "test",
                                    "declare"};

static const char *const atoms[] = {"0",
                                    "1",
                                    "-1",
                                    "2",
                                    "7",
                                    "1000000",
                                    "9223372036854775807",
                                    "-9223372036854775808",
                                    "1e308",
                                    "-1e-308",
                                    "0.5",
                                    "3.25",
                                    "nan",
                                    "TRUE",
                                    "FALSE",
                                    "nil",
                                    "abc",
                                    "red",
                                    "x",
                                    "goal",
                                    "position",
                                    "mail",
                                    "message",
                                    "sonar",
                                    "\"\"",
                                    "\"a b\"",
                                    "\"(+ 1 2)\"",
                                    "\"(exit)\"",
                                    "\"%s %d %n\"",
                                    "\"(deffunction f () (f))\"",
                                    "[initial-object]",
                                    "[none]",
                                    "?x",
                                    "?y",
                                    "$?z",
                                    "?*mate*",
                                    "?*my-name*",
                                    "?*care*",
                                    "?*nothing*",
                                    "t",
                                    "crlf",
                                    "do",
                                    "then",
                                    "else",
                                    "case",
                                    "default",
                                    "()",
                                    "(create$ 1 a 2.5)",
                                    "(create$)",
                                    "?f:x",
                                    "MAIN",
                                    "USER",
                                    "mate-pos",
                                    "group:north",
                                    "all"};

static const char *const samples[] = {
    "(defrule r1 (declare (salience 5)) (goal ?g) (position ?t ?x ?y $?) (test (> ?x 1)) => "
    "(setSpeed 1 ?x) (assert (seen ?g ?t)) (update-sensors))",
    "(defrule r2 ?f <- (message mate-pos ?*mate* ?x&:(> ?x 0) ?y) (not (seen $?)) => (retract ?f) "
    "(bind ?*mate* red) (broadcast ?x ?y))",
    "(deffunction f1 (?x $?y) (if (> ?x 3) then (return ?y)) (f1 (+ ?x 1) ?y))",
    "(deftemplate t1 (slot a (type INTEGER) (default 1)) (multislot b (default x y)))",
    "(deffacts f2 (t1 (a 2)) (x 1 2 3) (x))",
    "(defclass C1 (is-a USER) (role concrete) (slot n (default 1)) (multislot m))",
    "(defmessage-handler USER h1 (?a) (bind ?b ?a) (call-next-handler))",
    "(defgeneric g1)(defmethod g1 ((?x INTEGER (> ?x 1))) (call-next-method))",
    "(defmodule M1 (export ?ALL)) (defrule M1::r (declare (auto-focus TRUE)) => (halt))",
    "(defglobal ?*a* = (create$ 1 2) ?*b* = 3)",
    "(defrule r3 (forall (x ?a) (y ?a)) (or (x 1) (logical (z ?b))) => (assert (w (x 1))))",
    "(do-for-all-facts ((?f goal)) TRUE (retract ?f))",
    "(progn$ (?x (create$ 1 2 3)) (assert (x ?x)) (printout t ?x-index crlf))"};

struct fuzz {
    struct mu_random random;
    struct mind *mind;
    size_t minds;
    uint64_t lines_of_mind, step, broken, refused;
    char text[TEXT_MAX + 1];
    char answer[TEXT_MAX];
};

static struct fuzz fuzz;
static struct mind *minds[MINDS_MAX]; /* their memory is for the life of the process */

static int64_t draw(struct fuzz *f, int64_t most)
{
    return mu_random_between(&f->random, 0, most);
}

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    return letter->content ? MU_OK : MU_FULL;
}

static void swallow(void *self, const char *text)
{
    (void)self;
    (void)text;
}

static mu_result lookup(void *self, const char *name, struct mind_member *out)
{
    (void)self;
    *out = (struct mind_member){name, "robot", "running", "here"};
    return strcmp(name, "red") == 0 ? MU_OK : MU_ABSENT;
}

static mu_result listing(void *self, size_t index, struct mind_member *out)
{
    return index == 0 ? lookup(self, "red", out) : MU_DONE;
}

static mu_result change(void *self, enum mind_change what, const char *name, const char *attributes,
                        uint64_t lease_ns)
{
    (void)self;
    (void)what;
    (void)lease_ns;
    return name && attributes ? MU_OK : MU_FULL;
}

static const char *entry(void *self, enum mind_list list, const char *of, size_t index)
{
    (void)self;
    (void)list;
    return of && index == 0 ? "red" : NULL;
}

static void fuzz_open(struct fuzz *f)
{
    struct mu_fault fault;
    if (f->minds > 0) {
        mind_close(minds[f->minds - 1]);
    }
    CU_ASSERT_FATAL(f->minds < MINDS_MAX);
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = "blue",
                                   .seed = 1,
                                   .rules_folder = "rules",
                                   .failures_max = 10,
                                   .ports = {.self = f,
                                             .send = post,
                                             .lookup = lookup,
                                             .listing = listing,
                                             .change = change,
                                             .entry = entry,
                                             .print = swallow}};
    CU_ASSERT_EQUAL_FATAL(mind_open(&f->mind, &options, &fault), MU_OK);
    minds[f->minds++] = f->mind;
    f->lines_of_mind = 0;
}

static void expression(struct fuzz *f, struct mu_text *out, int depth)
{
    if (depth == 0 || draw(f, 2) == 0) {
        mu_text_add(out, atoms[draw(f, sizeof atoms / sizeof atoms[0] - 1)]);
        return;
    }
    mu_text_add(out, "(");
    mu_text_add(out, words[draw(f, sizeof words / sizeof words[0] - 1)]);
    for (int64_t arguments = draw(f, 4); arguments > 0; arguments--) {
        mu_text_add(out, " ");
        expression(f, out, depth - 1);
    }
    mu_text_add(out, ")");
}

/* A random call, a damaged construct, or both. */
static void line_make(struct fuzz *f)
{
    struct mu_text out;
    mu_text_init(&out, f->text, sizeof f->text);
    int64_t kind = draw(f, 9);
    if (kind < 7) {
        mu_text_add(&out, "(");
        mu_text_add(&out, words[draw(f, sizeof words / sizeof words[0] - 1)]);
        for (int64_t arguments = draw(f, 4); arguments > 0; arguments--) {
            mu_text_add(&out, " ");
            expression(f, &out, (int)draw(f, DEPTH_MAX));
        }
        mu_text_add(&out, ")");
    } else {
        const char *sample = samples[draw(f, sizeof samples / sizeof samples[0] - 1)];
        if (kind == 9) {
            mu_text_add(&out, sample);
        } else {
            (void)garble(&f->random, f->text, sizeof f->text, sample, strlen(sample));
        }
    }
}

static bool line_do(struct fuzz *f, const char *line)
{
    struct mu_text out;
    mu_text_init(&out, f->answer, sizeof f->answer);
    return mind_line(f->mind, line, &out) == MU_OK;
}

static void step_do(struct fuzz *f)
{
    float sonar_m[SONARS] = {0};
    struct mu_percept percept = {.time_ns = ++f->step * MU_STEP_NS,
                                 .battery_share = -1,
                                 .stalled = draw(f, 1),
                                 .sonar_count = SONARS,
                                 .sonar_m = sonar_m};
    struct mind_mail mail = {.id = f->step,
                             .src = "red",
                             .performative = "",
                             .language = "",
                             .ontology = "",
                             .reply_with = "",
                             .in_reply_to = "",
                             .conversation = "",
                             .content = f->text};
    struct mind_act act;
    mind_percept(f->mind, &percept);
    (void)mind_handle(f->mind, &mail);
    mu_result taken = mind_take_mail(f->mind, &mail);
    CU_ASSERT(taken == MU_OK || taken == MU_FULL);
    mind_event(f->mind, MU_ON_RUN);
    mind_fire(f->mind, &act);
    CU_ASSERT(act.rules != NULL);
}

/* A mind that still lives answers; one that does not says why. */
static void answers(struct fuzz *f)
{
    (void)line_do(f, "(stop)");
    bool gone = strstr(f->answer, "the rules are gone") != NULL;
    if (!gone && strcmp(f->answer, "TRUE\n") != 0) {
        printf("\nafter: %s\nanswer: %s\n", f->text, f->answer);
        CU_FAIL("it does not answer");
    }
    f->broken += gone;
    if (gone || ++f->lines_of_mind >= LINES_A_MIND) {
        fuzz_open(f);
    }
}

static void fuzz_begin(struct fuzz *f, const char *name)
{
    uint64_t seed = suite_setting("MUSTER_SEED", 61);
    printf("seed %llu ", (unsigned long long)seed);
    mu_random_seed(&f->random, seed, name);
    fuzz_open(f);
}

static void test_lines(void)
{
    struct fuzz *f = &fuzz;
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS);
    fuzz_begin(f, "lines");
    for (uint64_t i = 0; i < rounds; i++) {
        line_make(f);
        f->refused += !line_do(f, f->text);
        if (i % STEP_EVERY == 0) {
            step_do(f);
        }
        answers(f);
    }
    CU_ASSERT(f->refused > 0 && f->refused < rounds); /* neither all nonsense nor none */
    printf("refused %llu of %llu, %llu minds broken ", (unsigned long long)f->refused,
           (unsigned long long)rounds, (unsigned long long)f->broken);
}

static size_t file_read(const char *path, char *text, size_t size)
{
    FILE *in = fopen(path, "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(in);
    size_t len = fread(text, 1, size - 1, in);
    fclose(in);
    text[len] = '\0';
    return len;
}

/* The library's own files, damaged: refused with a place, or loaded. */
static void test_files(void)
{
    static const char *const files[] = {"rules/avoid.clp", "rules/follow.clp", "rules/gohome.clp",
                                        "rules/wander.clp", "rules/shop.clp"};
    static char text[TEXT_MAX / 2], damaged[TEXT_MAX];
    struct fuzz *f = &fuzz;
    char path[] = "/tmp/muster-fuzz-XXXXXX";
    int fd = mkstemp(path);
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS) / 20;
    unsigned loaded = 0;
    CU_ASSERT_FATAL(fd >= 0);
    fuzz_begin(f, "files");
    for (uint64_t i = 0; i < rounds; i++) {
        struct mu_fault fault = {.line = -1};
        size_t len = file_read(files[draw(f, 4)], text, sizeof text);
        len = garble(&f->random, damaged, sizeof damaged, text, len);
        CU_ASSERT_EQUAL_FATAL(ftruncate(fd, 0), 0);
        CU_ASSERT_EQUAL_FATAL(pwrite(fd, damaged, len, 0), (ssize_t)len);
        mu_result r = mind_load(f->mind, path, &fault);
        CU_ASSERT(r == MU_OK || (r == MU_FAULT_FILE && fault.line >= 0 && fault.text[0]));
        loaded += r == MU_OK;
        snprintf(f->text, sizeof f->text, "file %llu", (unsigned long long)i);
        step_do(f);
        answers(f);
        if (i % 100 == 99) {
            fuzz_open(f); /* what was loaded stays, and adds up */
        }
    }
    CU_ASSERT(loaded > 0 && loaded < rounds);
    close(fd);
    unlink(path);
}

int main(void)
{
    CU_TestInfo tests[] = {{"lines", test_lines}, {"rule files", test_files}, CU_TEST_INFO_NULL};
    return suite_run("mind/fuzz", tests);
}
