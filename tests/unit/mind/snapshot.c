/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A mind that is written down and made again goes on as the one that was not: the same rules in the
 * same order, the same mail, and at the end the same snapshot.
 */
#include "core/random.h"
#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/limits.h"
#include "muster/memory.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SNAPSHOT_MAX = 1 << 20, LOG_MAX = 1 << 16, SONARS = 16, CUTS = 100 };

/* A mind, and what it has said and done. */
struct soul {
    struct mind *mind;
    char log_bytes[LOG_MAX];
    struct mu_text log;
};

static struct soul stays, goes;
static char snapshot_bytes[SNAPSHOT_MAX], other_bytes[SNAPSHOT_MAX];

static mu_result post(void *self, const struct mind_letter *letter)
{
    struct soul *s = self;
    mu_text_format(&s->log, "to %s: %s\n", letter->dst, letter->content);
    return MU_OK;
}

static void print(void *self, const char *text)
{
    struct soul *s = self;
    mu_text_add(&s->log, text);
}

static void soul_begin(struct soul *s, const char *name, const char *library)
{
    struct mu_fault fault;
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = name,
                                   .seed = 3,
                                   .rules_folder = library,
                                   .forward_max_m_s = 0.5,
                                   .turn_max_rad_s = 1.5,
                                   .ports = {.self = s, .send = post, .print = print}};
    if (s->mind) {
        mind_close(s->mind);
    } else {
        s->mind = mind_reserve();
    }
    mu_text_init(&s->log, s->log_bytes, sizeof s->log_bytes);
    mu_result begun = mind_begin(s->mind, &options, &fault);
    CU_ASSERT_EQUAL_FATAL(begun, MU_OK);
}

static void soul_load(struct soul *s, const char *rules)
{
    struct mu_fault fault = {.text = ""};
    mu_result loaded = mind_load_text(s->mind, "test", rules, &fault);
    if (loaded != MU_OK) {
        mu_fault_print(&fault);
    }
    CU_ASSERT_EQUAL_FATAL(loaded, MU_OK);
}

static const char *say(struct soul *s, const char *line)
{
    static char bytes[16384];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    mu_result done = mind_line(s->mind, line, &out);
    (void)done; /* what it printed says so */
    return bytes;
}

static mu_result save(struct soul *s, char *to, size_t *len, const char **why)
{
    static struct mu_fault fault;
    struct mu_text out;
    mu_text_init(&out, to, SNAPSHOT_MAX);
    mu_result saved = mind_save(s->mind, &out, &fault);
    *len = out.len;
    *why = saved == MU_OK ? "" : fault.text;
    return saved;
}

/* Makes `goes` what `stays` is, by way of a snapshot. */
static void move_as(const char *name)
{
    size_t len;
    const char *why;
    struct mu_fault fault = {.text = ""};
    CU_ASSERT_EQUAL_FATAL(save(&stays, snapshot_bytes, &len, &why), MU_OK);
    soul_begin(&goes, name, NULL);
    mu_result restored = mind_restore(goes.mind, snapshot_bytes, len, &fault);
    if (restored != MU_OK) {
        mu_fault_print(&fault);
    }
    CU_ASSERT_EQUAL_FATAL(restored, MU_OK);
    mu_text_clear(&stays.log);
}

static bool same_snapshots(void)
{
    size_t len, other;
    const char *why;
    CU_ASSERT_EQUAL(save(&stays, snapshot_bytes, &len, &why), MU_OK);
    CU_ASSERT_EQUAL(save(&goes, other_bytes, &other, &why), MU_OK);
    size_t at = 96; /* behind the checksum */
    while (at < len && at < other && snapshot_bytes[at] == other_bytes[at]) {
        at++;
    }
    if (at == len && len == other) {
        return true;
    }
    while (at > 96 && snapshot_bytes[at - 1] != '\n') {
        at--;
    }
    printf("\n  stayed: %.160s\n  moved:  %.160s\n", snapshot_bytes + at, other_bytes + at);
    return false;
}

/* --- the follow behaviour --------------------------------------------------------------------- */

/* A step's senses and mail, drawn from a stream: the same for both minds. */
static void world_step(struct soul *s, uint64_t step)
{
    struct mu_random r;
    float sonar[SONARS];
    mu_random_seed(&r, step, "senses");
    for (size_t i = 0; i < SONARS; i++) {
        sonar[i] = (float)(0.2 + 4.8 * mu_random_unit(&r));
    }
    struct mu_percept p = {.time_ns = step * MU_STEP_NS,
                           .x_m = 10 * mu_random_unit(&r) - 5,
                           .y_m = 10 * mu_random_unit(&r) - 5,
                           .heading_rad = 6.28 * mu_random_unit(&r) - 3.14,
                           .forward_m_s = 0.4 * mu_random_unit(&r),
                           .stalled = mu_random_between(&r, 0, 9) == 0,
                           .battery_share = -1,
                           .sonar_count = SONARS,
                           .sonar_m = sonar};
    mind_percept(s->mind, &p);
    for (int i = 0; i < 3; i++) {
        static const char *const from[] = {"red", "green", "yellow"};
        char content[64];
        snprintf(content, sizeof content, "mate-pos %s %d %d", from[i],
                 (int)mu_random_between(&r, -5000, 5000), (int)mu_random_between(&r, -5000, 5000));
        struct mind_mail mail = {
            3 * step + (uint64_t)i, from[i], "", "", "", "", "", "", content, 0, 0};
        if (mu_random_between(&r, 0, 3) > 0) {
            CU_ASSERT_EQUAL(mind_take_mail(s->mind, &mail), MU_OK);
        }
    }
}

/* What people say to it on the way. */
static void world_words(struct soul *s, uint64_t step)
{
    static const char *const lines[] = {"(wander)", "(follow red)", "(follow green)",
                                        "(gohome 1000 2000)", "(stay)"};
    if (step % 17 == 0) {
        (void)say(s, lines[step / 17 % (sizeof lines / sizeof lines[0])]);
    }
}

static void step(struct soul *s, uint64_t n, uint32_t most)
{
    struct mind_act act;
    world_step(s, n);
    world_words(s, n);
    mind_fire_some(s->mind, most, &act);
    mu_text_format(&s->log, "%llu: %s [%d %a %a] end %d\n", (unsigned long long)n, act.rules,
                   act.drives, act.forward_m_s, act.turn_rad_s, (int)act.end);
}

static void cut_at(uint64_t cut, uint32_t most)
{
    soul_begin(&stays, "blue", "rules");
    soul_load(&stays, "(extends \"follower.clp\")");
    for (uint64_t n = 1; n <= cut; n++) {
        step(&stays, n, most);
    }
    move_as("blue");
    for (uint64_t n = cut + 1; n <= cut + 40; n++) {
        step(&stays, n, most);
        step(&goes, n, most);
    }
    CU_ASSERT(stays.log.len > 1000);
    READS(goes.log.at, stays.log.at);
    CU_ASSERT(same_snapshots());
}

/* Cuts at random steps; some with so small a budget that the agenda is never empty. */
static void test_follow_at_random_steps(void)
{
    struct mu_random r;
    mu_random_seed(&r, 1, "cuts");
    for (int i = 0; i < CUTS; i++) {
        uint64_t cut = (uint64_t)mu_random_between(&r, 1, 120);
        uint32_t most = i % 3 == 0 ? (uint32_t)mu_random_between(&r, 1, 4) : UINT32_MAX;
        cut_at(cut, most);
    }
}

/* --- what has fired does not fire again ------------------------------------------------------- */

static const char tangle[] =
    "(defmodule MAIN (export ?ALL))\n"
    "(deftemplate part (slot name) (multislot of) (slot weight (type FLOAT)))\n"
    "(deffunction heavy (?w) (> ?w 1.5))\n"
    "(defglobal ?*seen* = 0 ?*list* = (create$) ?*limit* = 2)\n"
    "(deffacts parts (part (name a) (of x y z) (weight 0.1)) (part (name b) (of y) (weight 2.0))\n"
    "  (list 1 2 3 4) (n 1) (n 2) (n 3) (stop))\n"
    "(defrule pairs (declare (salience 5)) (list $?a ?x $?b) =>\n"
    "  (bind ?*list* (create$ ?*list* ?x (length$ ?a))) (assert (seen ?x)))\n"
    "(defrule either (or (n ?i) (seen ?i)) (test (< ?i 3)) =>\n"
    "  (printout t \"either \" ?i \" \" (random 1 1000) crlf))\n"
    "(defrule weigh (declare (salience -2)) ?p <- (part (name ?n) (weight ?w&:(heavy ?w))) =>\n"
    "  (assert (weighed ?n ?p)) (bind ?*seen* (+ ?*seen* ?w)))\n"
    "(defrule none (not (never)) (n ?i) => (printout t \"none \" ?i crlf))\n"
    "(defrule all (declare (salience -5)) (forall (n ?i) (seen ?i)) => (assert (all seen)))\n"
    "(defrule dynamic (declare (salience (* 2 ?*limit*))) (weighed ?n ?p) (n ?i) =>\n"
    "  (printout t ?n \" \" ?i \" \" (gensym) crlf))\n"
    "(defrule free (declare (salience -9)) ?s <- (stop) => (retract ?s) (assert (n 4) (n 5)))\n"
    "(defmodule SIDE (import MAIN ?ALL))\n"
    "(defrule SIDE::beside (declare (auto-focus TRUE)) (n ?i&:(> ?i 3)) =>\n"
    "  (printout t \"side \" ?i crlf))\n";

static void fire_one_by_one(struct soul *s, int count)
{
    for (int i = 0; i < count; i++) {
        struct mind_act act;
        mind_fire_some(s->mind, 1, &act);
        mu_text_format(&s->log, "fired %s\n", act.rules);
    }
}

static void test_after_every_firing(void)
{
    static const char *const strategies[] = {"depth",      "breadth",    "lex",   "mea",
                                             "simplicity", "complexity", "random"};
    for (size_t k = 0; k < sizeof strategies / sizeof strategies[0]; k++) {
        for (int cut = 0; cut < 40; cut += 3) {
            char line[64];
            soul_begin(&stays, "blue", NULL);
            snprintf(line, sizeof line, "(set-strategy %s)", strategies[k]);
            (void)say(&stays, line);
            soul_load(&stays, tangle);
            fire_one_by_one(&stays, cut);
            move_as("blue");
            fire_one_by_one(&stays, 50);
            fire_one_by_one(&goes, 50);
            READS(goes.log.at, stays.log.at);
            CU_ASSERT(same_snapshots());
        }
    }
}

static void test_values_to_the_last_bit(void)
{
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, "(defglobal ?*f* = 0.0 ?*s* = a ?*m* = (create$) ?*p* = nil ?*gone* = nil)\n"
                      "(deffacts some (x))\n");
    (void)say(&stays, "(bind ?*f* (+ 0.1 0.2))");
    (void)say(&stays, "(bind ?*s* (sym-cat \"a b\" \"\\\"c\\\"\"))");
    (void)say(&stays,
              "(bind ?*m* (create$ 1e-300 -0.0 (* 1e300 1e300) \"two\nlines\\\\\" [i] i7))");
    (void)say(&stays, "(bind ?*p* (assert (pointed at)))");
    (void)say(&stays, "(bind ?*gone* (assert (gone soon)))");
    (void)say(&stays, "(retract ?*gone*)");
    (void)say(&stays, "(assert (third (/ 1.0 3)))");
    (void)say(&stays, "(seed 7)");
    (void)say(&stays, "(random)");
    move_as("blue");
    static const char *const asked[] = {
        "(eq ?*f* (+ 0.1 0.2))", "(eq ?*s* (sym-cat \"a b\" \"\\\"c\\\"\"))",
        "(eq (nth$ 3 ?*m*) (* 1e300 1e300))", "(eq (nth$ 4 ?*m*) \"two\nlines\\\\\")",
        "(eq (fact-fields ?*p*) (create$ at))"};
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        READS(say(&goes, asked[i]), "TRUE\n");
    }
    char first[64];
    CU_ASSERT(mu_text_copy(first, sizeof first, say(&stays, "(random)")));
    READS(say(&goes, "(random)"), first);
    CU_ASSERT(same_snapshots());
}

static void test_mail_and_events_come_along(void)
{
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, "(defrule wait (never) (mail (performative ask-one)) =>)\n"
                      "(deffunction take (?id ?from ?p ?c) (assert (took ?c)))\n"
                      "(on-layer 4 take)\n(deffunction later () (getmsg))\n"
                      "(deffunction first (?rest ?sender) (create$ ?rest ?sender))\n"
                      "(on-resolve busy first)\n");
    struct mu_percept p = {.time_ns = MU_STEP_NS, .battery_share = 0.5};
    mind_percept(stays.mind, &p);
    struct mind_mail asked = {1, "red", "ask-one", "", "", "q1", "", "", "where \"are\" you", 0, 0};
    struct mind_mail prose = {2, "green", "", "english", "", "", "", "", "plain\ntext", 0, 0};
    CU_ASSERT_EQUAL(mind_take_mail(stays.mind, &asked), MU_OK);
    CU_ASSERT_EQUAL(mind_take_mail(stays.mind, &prose), MU_OK);
    mind_refused(stays.mind, "group-create scouts", "group-exists");
    mind_event(stays.mind, MU_ON_RUN);
    move_as("blue");
    CU_ASSERT(mind_has_layer(goes.mind, 4));
    char bytes[64];
    struct mu_text names = mu_text_in(bytes, sizeof bytes);
    CU_ASSERT_STRING_EQUAL(mind_scheme(goes.mind), "busy");
    CU_ASSERT(mind_resolve(goes.mind, "low", "red", &names));
    CU_ASSERT_STRING_EQUAL(bytes, "low,red");
    READS(say(&goes, "(battery)"), "0.5\n");
    mind_percept(stays.mind, &p);
    mind_percept(goes.mind, &p);
    CU_ASSERT(strstr(say(&goes, "(facts)"), "(event on-run)") != NULL);
    READS(say(&goes, "(getmsg)"), "(red where \"are\" you)\n");
    READS(say(&goes, "(later)"), "(green \"plain\ntext\")\n");
    READS(say(&goes, "(getmsg)"), "()\n");
    (void)say(&stays, "(getmsg)");
    (void)say(&stays, "(getmsg)");
    (void)say(&stays, "(getmsg)");
    CU_ASSERT(same_snapshots());
}

/* The same line, and the same answer, from both. */
static void same_answer(const char *line)
{
    char first[16384];
    (void)mu_text_copy(first, sizeof first, say(&stays, line));
    READS(say(&goes, line), first);
}

static void test_breakpoints_and_watches_come_along(void)
{
    static const char rules[] = "(deftemplate point (slot x)) (defrule one (a ?) (or (b) (c)) =>)"
                                "(defrule two (a ?) =>) (defrule three (b) =>)";
    soul_begin(&stays, "blue", "rules");
    soul_load(&stays, rules);
    (void)say(&stays, "(set-break one)");
    (void)say(&stays, "(set-break two)");
    (void)say(&stays, "(watch facts)");
    (void)say(&stays, "(unwatch facts point)");
    (void)say(&stays, "(watch rules)");
    (void)say(&stays, "(watch globals)");
    (void)say(&stays, "(assert (a 1) (b))");
    struct mind_act act;
    mind_fire(stays.mind, &act);
    CU_ASSERT_EQUAL(act.end, MIND_BREAK);
    move_as("blue");
    CU_ASSERT(same_snapshots());
    same_answer("(show-breaks)");
    CU_ASSERT_PTR_NOT_NULL(strstr(say(&goes, "(show-breaks)"), "one"));
    for (struct soul *soul = &stays; soul; soul = soul == &stays ? &goes : NULL) {
        const char *facts = say(soul, "(list-watch-items facts)");
        CU_ASSERT_PTR_NOT_NULL(strstr(facts, "point = off"));
        CU_ASSERT_PTR_NOT_NULL(strstr(facts, "a = on"));
    }
    same_answer("(list-watch-items rules)");
    same_answer("(list-watch-items globals)");
    CU_ASSERT_PTR_NOT_NULL(strstr(say(&goes, "(list-watch-items rules)"), "rules = on"));
    mind_go_on(stays.mind);
    mind_go_on(goes.mind);
    for (uint64_t n = 1; n < 6; n++) {
        step(&stays, n, UINT32_MAX);
        step(&goes, n, UINT32_MAX);
    }
    READS(goes.log.at, stays.log.at);
    CU_ASSERT(same_snapshots());
}

static void test_a_clone_has_its_own_name(void)
{
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, "(deffacts f (x 1))");
    move_as("ruby");
    READS(say(&goes, "?*my-name*"), "ruby\n");
    READS(say(&goes, "(my-name)"), "ruby\n");
    (void)say(&goes, "(reset)");
    READS(say(&goes, "?*my-name*"), "ruby\n");
    READS(say(&stays, "?*my-name*"), "blue\n");
}

/* --- what is refused -------------------------------------------------------------------------- */

static void refuses(const char *rules, const char *why_wanted)
{
    size_t len;
    const char *why;
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, rules);
    struct mind_act act;
    mind_fire(stays.mind, &act);
    CU_ASSERT_EQUAL(save(&stays, snapshot_bytes, &len, &why), MU_REFUSED);
    READS(why, why_wanted);
    mind_fire(stays.mind, &act); /* it goes on */
}

static void test_switches_come_along(void)
{
    static const char *const asked[] = {
        "(get-strategy)",
        "(get-salience-evaluation)",
        "(get-fact-duplication)",
        "(get-reset-globals)",
        "(get-sequence-operator-recognition)",
        "(get-incremental-reset)",
        "(get-auto-float-dividend)",
        "(get-dynamic-constraint-checking)",
        "(get-static-constraint-checking)",
        "(gensym*)",
    };
    static const char *const wanted[] = {"mea\n",   "when-activated\n", "TRUE\n",  "FALSE\n",
                                         "TRUE\n",  "FALSE\n",          "FALSE\n", "TRUE\n",
                                         "FALSE\n", "gen44\n"};
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, "(deftemplate t (slot x (type SYMBOL)))\n");
    (void)say(&stays, "(set-static-constraint-checking FALSE) (set-incremental-reset FALSE)");
    (void)say(&stays, "(defrule r (t (x 7)) => (assert (seven)))");
    (void)say(&stays, "(set-strategy mea) (set-salience-evaluation when-activated)"
                      "(set-fact-duplication TRUE) (set-reset-globals FALSE)"
                      "(set-sequence-operator-recognition TRUE) (set-auto-float-dividend FALSE)"
                      "(set-dynamic-constraint-checking TRUE) (setgen 44)");
    move_as("blue");
    CU_ASSERT(same_snapshots());
    for (size_t i = 0; i < sizeof asked / sizeof asked[0]; i++) {
        READS(say(&goes, asked[i]), wanted[i]);
    }
    READS(say(&goes, "(defrule other (t (x 8)) =>)"), "");
    READS(say(&goes, "(/ 7 2)"), "3\n");
}

/* Texts that are longer than any mail, in a global, a fact and a name. */
static void test_long_texts(void)
{
    char rule[600];
    soul_begin(&stays, "blue", NULL);
    snprintf(rule, sizeof rule, "(defrule r%0400d (initial-fact) => (assert (fired)))", 1);
    soul_load(&stays, "(defglobal ?*text* = \"\\\"quoted\\\" \")\n(deffacts some (text none))\n");
    READS(say(&stays, rule), "");
    (void)say(&stays, "(loop-for-count 13 (bind ?*text* (str-cat ?*text* ?*text*)))");
    (void)say(&stays, "(assert (text (sym-cat ?*text*)) (text ?*text*))");
    READS(say(&stays, "(str-length ?*text*)"), "73728\n");
    move_as("blue");
    READS(say(&goes, "(str-length ?*text*)"), "73728\n");
    READS(say(&goes, "(length$ (findall (text ?)))"), "3\n");
    READS(say(&goes, "(length$ (get-defrule-list))"), "1\n");
    CU_ASSERT(same_snapshots());
}

/* So many that a snapshot is nearly full of them. */
static void test_a_long_agenda(void)
{
    enum { FACTS = 12000, FIRED = 200 };
    struct mind_act act;
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, "(defrule r (n ?x) =>)\n");
    char line[64];
    snprintf(line, sizeof line, "(loop-for-count (?i %d) (assert (n ?i)))", FACTS);
    READS(say(&stays, line), "FALSE\n");
    mind_fire_some(stays.mind, FIRED, &act);
    CU_ASSERT_EQUAL(act.firings, FIRED);
    move_as("blue");
    CU_ASSERT(same_snapshots());
    uint32_t left = FACTS - FIRED;
    while (left > 0) {
        mind_fire(goes.mind, &act);
        CU_ASSERT_FATAL(act.firings > 0 && act.firings <= left);
        left -= act.firings;
    }
    mind_fire(goes.mind, &act);
    CU_ASSERT_EQUAL(act.firings, 0);
}

/* Rules that take the focus and never give it back have a tall stack. */
static void test_a_tall_stack_of_modules(void)
{
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, "(defmodule A)\n(defmodule B)\n(defmodule C)\n");
    (void)say(&stays, "(loop-for-count 30000 (focus A B))");
    (void)say(&stays, "(focus C)");
    READS(say(&stays, "(length$ (get-focus-stack))"), "60002\n");
    move_as("blue");
    READS(say(&goes, "(subseq$ (get-focus-stack) 1 4)"), "(C A B A)\n");
    CU_ASSERT(same_snapshots());
}

static void test_what_cannot_be_written_down(void)
{
    refuses("(defrule r (logical (initial-fact)) => (assert (b)))\n", "a fact has logical support");
    refuses("(defclass C (is-a USER) (role concrete))\n(definstances d (c of C))\n",
            "it has instances of classes");
}

static void test_too_large(void)
{
    struct mu_fault fault;
    char small[4096];
    struct mu_text out;
    soul_begin(&stays, "blue", "rules");
    mu_text_init(&out, small, sizeof small);
    CU_ASSERT_EQUAL(mind_save(stays.mind, &out, &fault), MU_FULL);
}

static mu_result restore(const char *bytes, size_t len)
{
    struct mu_fault fault;
    soul_begin(&goes, "blue", NULL);
    return mind_restore(goes.mind, bytes, len, &fault);
}

static void test_what_is_not_whole(void)
{
    size_t len;
    const char *why;
    struct mu_random r;
    mu_random_seed(&r, 1, "damage");
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, tangle);
    CU_ASSERT_EQUAL_FATAL(save(&stays, snapshot_bytes, &len, &why), MU_OK);
    CU_ASSERT_EQUAL(restore(snapshot_bytes, len), MU_OK);
    CU_ASSERT_EQUAL(restore(snapshot_bytes, len - 1), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(restore(snapshot_bytes, 10), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(restore("", 0), MU_FAULT_FILE);
    for (int i = 0; i < 100; i++) {
        size_t at = 96 + (size_t)mu_random_between(&r, 0, (int64_t)len - 97);
        char was = snapshot_bytes[at];
        snapshot_bytes[at] = (char)(was ^ (1 << mu_random_between(&r, 0, 7)));
        CU_ASSERT_EQUAL(restore(snapshot_bytes, len), MU_FAULT_FILE);
        snapshot_bytes[at] = was;
    }
    memcpy(snapshot_bytes, "muster-capsule 4", 16);
    CU_ASSERT_EQUAL(restore(snapshot_bytes, len), MU_FAULT_FILE);
}

/* Writes the checksum of what is there now. */
static void seal(char *bytes, size_t len)
{
    uint64_t sum = 14695981039346656037ull;
    for (size_t i = 96; i < len; i++) {
        sum = (sum ^ (unsigned char)bytes[i]) * 1099511628211ull;
    }
    char head[97];
    int used = snprintf(head, sizeof head, "muster-capsule 3 %zu %016llx", len - 96,
                        (unsigned long long)sum);
    memset(bytes, ' ', 95);
    memcpy(bytes, head, (size_t)used);
}

/* Whoever writes a snapshot by hand gets a mind or a refusal, and nothing breaks. */
static void test_forged(void)
{
    static const char letters[] = "\n ()\"\\0123456789ayfsn-,*:";
    size_t len;
    const char *why;
    struct mu_random r;
    mu_random_seed(&r, 1, "forgery");
    soul_begin(&stays, "blue", NULL);
    soul_load(&stays, tangle);
    world_step(&stays, 1);
    CU_ASSERT_EQUAL_FATAL(save(&stays, snapshot_bytes, &len, &why), MU_OK);
    int refused = 0, taken = 0;
    for (int i = 0; i < 300; i++) {
        memcpy(other_bytes, snapshot_bytes, len);
        for (int64_t k = mu_random_between(&r, 0, 3); k >= 0; k--) {
            size_t at = 96 + (size_t)mu_random_between(&r, 0, (int64_t)len - 98);
            other_bytes[at] = letters[mu_random_between(&r, 0, (int64_t)sizeof letters - 2)];
        }
        seal(other_bytes, len);
        mu_result restored = restore(other_bytes, len);
        refused += restored == MU_FAULT_FILE;
        taken += restored == MU_OK;
        if (restored == MU_OK) {
            struct mind_act act;
            world_step(&goes, 2);
            mind_fire(goes.mind, &act);
        }
    }
    CU_ASSERT_EQUAL(refused + taken, 300);
    CU_ASSERT(refused > 100 && taken > 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"follow, cut at random steps", test_follow_at_random_steps},
        {"what has fired does not fire again", test_after_every_firing},
        {"values to the last bit", test_values_to_the_last_bit},
        {"mail and events come along", test_mail_and_events_come_along},
        {"breakpoints and watches come along", test_breakpoints_and_watches_come_along},
        {"a clone has its own name", test_a_clone_has_its_own_name},
        {"switches come along", test_switches_come_along},
        {"long texts", test_long_texts},
        {"a long agenda", test_a_long_agenda},
        {"a tall stack of modules", test_a_tall_stack_of_modules},
        {"what cannot be written down", test_what_cannot_be_written_down},
        {"a snapshot that is too large", test_too_large},
        {"a snapshot that is not whole", test_what_is_not_whole},
        {"forged snapshots", test_forged},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/snapshot", tests);
}
