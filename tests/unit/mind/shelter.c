/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Memory may be refused at any moment of any call: the call returns, the mind says that it is
 * broken, and another one lives in its place.
 */
#include "mind/engine/engine.h"
#include "mind/mind.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

enum { SONARS = 16, ROOM_MOST = 4 << 20, SNAPSHOT_BYTES = 1 << 18 };

static const char rules[] =
    "(defglobal ?*n* = 0)\n"
    "(deftemplate seen (slot what) (multislot where))\n"
    "(deffunction more (?x) (bind ?*n* (+ ?*n* 1)) (str-cat ?x \" and \" ?*n*))\n"
    "(deffunction answer-how () (bind ?much (more thanks))\n"
    "  (loop-for-count 12 (bind ?much (str-cat ?much ?much))) (create$ well (str-length ?much)))\n"
    "(deffunction heard (?from ?performative ?content ?id)\n"
    "  (assert (heard ?from ?content)) TRUE)\n"
    "(on-layer 4 heard)\n"
    "(defrule look (position ? ?x ?y $?) (sonar ? $?all)\n"
    "  => (assert (seen (what (more wall)) (where ?x ?y ?all)))\n"
    "     (setSpeed 100 (nth$ 1 ?all)) (send blue seen ?x (more ?y)))\n"
    "(defrule tell (message $?words) => (broadcast told ?words))\n"
    "(defrule note ?m <- (mail (content $?words)) => (retract ?m) (assert (noted ?words)))\n"
    "(defrule gone (event on-leave) => (printout t \"bye \" (more now) crlf))\n";

static struct mind *mind;
static char snapshot[SNAPSHOT_BYTES], said[8192];
static size_t snapshot_bytes;

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

static void print(void *self, const char *text)
{
    (void)self;
    (void)text;
}

static const struct mind_options options = {
    .name = "red", .seed = 1, .trace = true, .ports = {.send = post, .print = print}};

static const struct mind_mail mail = {.id = 7,
                                      .src = "blue",
                                      .performative = "tell",
                                      .language = "clips",
                                      .ontology = "",
                                      .reply_with = "",
                                      .in_reply_to = "",
                                      .conversation = "talk",
                                      .content = "near 1.5 \"a wall\" (brick)",
                                      .layer = 0};

/* --- the calls -------------------------------------------------------------------------------- */

static struct mu_text *out(void)
{
    static struct mu_text text;
    mu_text_init(&text, said, sizeof said);
    return &text;
}

static void percept(void)
{
    float sonar_m[SONARS];
    for (size_t i = 0; i < SONARS; i++) {
        sonar_m[i] = 0.25F + (float)i;
    }
    struct mu_percept p = {
        .time_ns = 100000000, .x_m = 1.25, .sonar_count = SONARS, .sonar_m = sonar_m};
    mind_percept(mind, &p);
}

static void fire(void)
{
    struct mind_act act;
    mind_fire(mind, &act);
    CU_ASSERT(!mind_is_broken(mind) || act.end == MIND_STOPPED);
}

static void call_step(void)
{
    percept();
    fire();
}

static void call_mail(void)
{
    (void)!mind_take_mail(mind, &mail);
    fire();
}

static void call_handler(void)
{
    struct mind_mail handed = mail;
    handed.layer = 4;
    bool taken = mind_handle(mind, &handed);
    CU_ASSERT(taken || mind_is_broken(mind));
}

static void call_answer(void)
{
    struct mind_mail asked = mail;
    asked.content = "how";
    bool answered = mind_answer(mind, &asked, out());
    CU_ASSERT(answered || mind_is_broken(mind));
}

static void call_line(void)
{
    (void)!mind_line(mind,
                     "(defrule more (a ?x) (not (b ?x)) => (assert (b ?x)))"
                     "(assert (a (more 1))) (bind ?*n* (create$ 1 2.5 \"three\")) (facts)",
                     out());
}

static void call_facts(void)
{
    (void)mind_facts(mind, "", out());
}

static void call_load(void)
{
    struct mu_fault fault;
    (void)!mind_load_text(mind, "again", rules, &fault);
}

static void call_save(void)
{
    struct mu_text text;
    struct mu_fault fault;
    mu_text_init(&text, snapshot, sizeof snapshot);
    mu_result saved = mind_save(mind, &text, &fault);
    CU_ASSERT_EQUAL(saved, mind_is_broken(mind) ? MU_REFUSED : MU_OK);
    snapshot_bytes = text.len;
}

static void call_restore(void)
{
    struct mu_fault fault;
    mu_result restored = mind_restore(mind, snapshot, snapshot_bytes, &fault);
    CU_ASSERT_EQUAL(restored, mind_is_broken(mind) ? MU_FAULT_FILE : MU_OK);
}

static void call_events(void)
{
    struct mind_act act;
    mind_event(mind, MU_ON_RUN);
    mind_refused(mind, "group-create scouts", "group-exists");
    mind_event_now(mind, MU_ON_LEAVE, &act);
}

static void call_global(void)
{
    (void)!mind_set_global(mind, "n", "\"some words\"");
}

static void call_tell(void)
{
    static const char *const relations[] = {"robot", NULL};
    static const struct mind_slot slot = {
        .name = "what", .kind = MIND_SLOT_STRING, .word = "slot by slot"};
    mind_observe(mind, 100000000, relations);
    (void)mind_tell(mind, "(robot (name red) (x 12.0))");
    (void)mind_tell(mind, "(seen (what \"it\") (where 1 2 3.5))");
    mu_result told = mind_tell_slots(mind, "seen", &slot, 1);
    CU_ASSERT_EQUAL(told, mind_is_broken(mind) ? MU_MALFORMED : MU_OK);
}

/* --- the test --------------------------------------------------------------------------------- */

static void begin(bool with_rules)
{
    struct mu_fault fault;
    mind = mind ? mind : mind_reserve();
    CU_ASSERT_EQUAL_FATAL(mind_begin(mind, &options, &fault), MU_OK);
    if (with_rules) {
        CU_ASSERT_EQUAL_FATAL(mind_load_text(mind, "rules", rules, &fault), MU_OK);
        call_step();
        call_mail();
    }
}

/* From now on it gets so many bytes more, and nothing that it has had before. */
static void leave_room(size_t room)
{
#if MEM_TABLE_SIZE > 0
    memset(MemoryData(mind->env)->MemoryTable, 0, MEM_TABLE_SIZE * sizeof(struct memoryPtr *));
#endif
    mind->heap.held = BUDGET_MEMORY_BURST - room;
}

static void all_answers(void)
{
    call_step();
    call_line();
    CU_ASSERT_PTR_NOT_NULL(strstr(said, "the rules are gone"));
    call_handler();
    call_facts();
}

/* @return whether the mind broke */
static bool breaks(void (*call)(void), bool with_rules, size_t room)
{
    begin(with_rules);
    leave_room(room);
    call();
    bool broke = mind_is_broken(mind);
    if (broke) {
        all_answers();
    }
    mind_close(mind);
    return broke;
}

/* With no room it breaks, with more later, with enough not at all. */
static void breaks_everywhere(void (*call)(void), bool with_rules)
{
    size_t room = 0, breaks_count = 0;
    while (room < ROOM_MOST && breaks(call, with_rules, room)) {
        room += 64 + room / 8;
        breaks_count++;
    }
    CU_ASSERT(breaks_count > 0);
    CU_ASSERT(room < ROOM_MOST);
    CU_ASSERT_FALSE(breaks(call, with_rules, ROOM_MOST));
}

#define BREAKS_IN(call)                \
    static void test_##call(void)      \
    {                                  \
        breaks_everywhere(call, true); \
    }

BREAKS_IN(call_step)
BREAKS_IN(call_mail)
BREAKS_IN(call_handler)
BREAKS_IN(call_answer)
BREAKS_IN(call_line)
BREAKS_IN(call_load)
BREAKS_IN(call_save)
BREAKS_IN(call_events)
BREAKS_IN(call_global)
BREAKS_IN(call_tell)

static void test_call_restore(void)
{
    begin(true);
    call_save();
    mind_close(mind);
    breaks_everywhere(call_restore, false);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a step", test_call_step},
        {"mail", test_call_mail},
        {"a handler of a layer", test_call_handler},
        {"a question", test_call_answer},
        {"a line", test_call_line},
        {"rules that are loaded", test_call_load},
        {"a snapshot that is written", test_call_save},
        {"a snapshot that is read", test_call_restore},
        {"events", test_call_events},
        {"a global", test_call_global},
        {"what is told", test_call_tell},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/shelter", tests);
}
