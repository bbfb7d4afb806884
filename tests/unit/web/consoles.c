/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Consoles of pages: which lines go out, who is told which answer, who watches, what is given up.
 * This test is the broker and the robots: its readers and writers share the participant of the
 * process under test.
 */
#include "core/clock.h"
#include "core/text.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"
#include "told.h"
#include "web/web.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;
static const uint64_t MOMENT_NS = 60000000u;

enum { SENT_MAX = 512 };

/* The broker's ends. */
static mu_process *process;
static struct bus_reader registrations, ups;
static struct bus_writer beacon, delivery;
static uint64_t delivered; /* numbers of our box */

static struct viewers viewers;
static struct consoles *consoles;
static struct viewer *one, *two;

/* What has gone out: mails, each once, and glances. */
static struct sent {
    uint64_t seq; /* 0: a glance */
    uint64_t glance;
    char to[MU_NAME_MAX + 1], performative[32], label[MU_FIELD_MAX + 1], content[256];
} sent[SENT_MAX];
static size_t sent_count;
static uint64_t sent_seq;

static char name[MU_NAME_MAX + 1]; /* that the last registration has */
static unsigned registered;

/* --- the network ------------------------------------------------------------------------------ */

static void mail_note(const muster_Mail *m)
{
    if (m->seq <= sent_seq || sent_count == SENT_MAX) {
        return; /* it goes out again until it is answered for */
    }
    struct sent *s = &sent[sent_count++];
    *s = (struct sent){.seq = m->seq};
    sent_seq = m->seq;
    snprintf(s->to, sizeof s->to, "%s", m->dst);
    snprintf(s->performative, sizeof s->performative, "%s", m->performative);
    snprintf(s->label, sizeof s->label, "%s", m->reply_with);
    snprintf(s->content, sizeof s->content, "%s", m->content);
}

static void glance_note(const muster_Glance *g)
{
    if (g->word != muster_GLANCE_ASK || sent_count == SENT_MAX) {
        return;
    }
    struct sent *s = &sent[sent_count++];
    *s = (struct sent){.glance = g->number};
    snprintf(s->to, sizeof s->to, "%s", g->agent);
    snprintf(s->content, sizeof s->content, "%s", g->text);
}

static void look(void)
{
    enum bus_life life;
    for (const muster_Registration *r; (r = bus_next(&registrations, &life));) {
        for (uint32_t i = 0; life == BUS_DATA && i < r->agents._length; i++) {
            const muster_Entry *e = &r->agents._buffer[i];
            registered += e->state == muster_STATE_RUNNING && strcmp(e->name, name) != 0;
            if (e->state == muster_STATE_RUNNING) {
                snprintf(name, sizeof name, "%s", e->name);
            }
        }
    }
    for (const muster_Up *up; (up = bus_next(&ups, &life));) {
        for (uint32_t i = 0; life == BUS_DATA && i < up->acts._length; i++) {
            const muster_Act *act = &up->acts._buffer[i];
            for (uint32_t k = 0; k < act->mails._length; k++) {
                mail_note(&act->mails._buffer[k]);
            }
        }
        for (uint32_t i = 0; life == BUS_DATA && i < up->glances._length; i++) {
            glance_note(&up->glances._buffer[i]);
        }
    }
}

static void shine(void)
{
    muster_Beacon b = {.broker = words("main"),
                       .incarnation = 5,
                       .host = words("elsewhere"),
                       .takes_agents = true};
    CU_ASSERT_EQUAL_FATAL(bus_write(&beacon, &b), MU_OK);
}

static void turn(void)
{
    CU_ASSERT_EQUAL_FATAL(mu_process_spin(process, 2000000), MU_OK);
    consoles_round(consoles);
    look();
}

static void turn_for(uint64_t ns)
{
    for (uint64_t until_ns = mu_clock_ns() + ns; mu_clock_ns() < until_ns;) {
        turn();
    }
}

#define TURN_UNTIL(condition)                              \
    do {                                                   \
        uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;   \
        while (!(condition) && mu_clock_ns() < until_ns) { \
            shine();                                       \
            turn();                                        \
        }                                                  \
        CU_ASSERT_TRUE_FATAL(condition);                   \
    } while (0)

static muster_Delivery delivery_make(void)
{
    return (muster_Delivery){.process = words(process->name),
                             .broker = words("main"),
                             .broker_incarnation = process->link.incarnation,
                             .step = muster_STEP_NOW};
}

static void deliver(const muster_Delivery *d)
{
    CU_ASSERT_EQUAL_FATAL(bus_write(&delivery, d), MU_OK);
}

static void verdict(bool accepted, const char *reason)
{
    muster_Verdict v = {.agent = words(name),
                        .accepted = accepted,
                        .broker_incarnation = process->link.incarnation,
                        .code = accepted || strcmp(reason, "taken by another") != 0
                                    ? muster_REFUSAL_NONE
                                    : muster_REFUSAL_NAME_HELD,
                        .reason = words(reason)};
    muster_Delivery d = delivery_make();
    d.verdicts._buffer = &v;
    d.verdicts._length = d.verdicts._maximum = 1;
    deliver(&d);
}

/* A mail of an agent to ours. */
static void says(const char *agent, const char *performative, const char *label,
                 const char *ontology, const char *content)
{
    muster_Parcel parcel = {.box = words(name), .number = ++delivered};
    parcel.letter = letter(agent, delivered, name, content);
    parcel.letter.layer = MU_LAYER_SPEECH;
    parcel.letter.performative = words(performative);
    parcel.letter.in_reply_to = words(label);
    parcel.letter.ontology = words(ontology);
    muster_Delivery d = delivery_make();
    d.parcels._buffer = &parcel;
    d.parcels._length = d.parcels._maximum = 1;
    deliver(&d);
}

static void receipt(uint64_t seq, muster_Outcome outcome)
{
    muster_Receipt r = {.agent = words(name), .first_seq = seq, .last_seq = seq, .result = outcome};
    muster_Delivery d = delivery_make();
    d.receipts._buffer = &r;
    d.receipts._length = d.receipts._maximum = 1;
    deliver(&d);
}

static void probe_end(uint64_t number, muster_GlanceWord word, const char *agent, const char *text)
{
    muster_Glance g = {.word = word,
                       .asker = words(name),
                       .number = number,
                       .agent = words(agent),
                       .text = words(text)};
    muster_Delivery d = delivery_make();
    d.glances._buffer = &g;
    d.glances._length = d.glances._maximum = 1;
    deliver(&d);
}

/* --- what viewers are told -------------------------------------------------------------------- */

static void is_told(struct viewer *v, const char *wanted)
{
    TURN_UNTIL(v->stream.queue_len > 0);
    turn_for(MOMENT_NS / 3); /* what belongs together may come in two rounds */
    READS(told(v), wanted);
}

/* Everybody has read, and nothing is under way. */
static void begin(void)
{
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        struct console *k = &consoles->all[i];
        if (k->used) {
            console_link_forget(&k->link);
            memset(k->watchers, 0, sizeof k->watchers);
        }
    }
    turn_for(MOMENT_NS);
    (void)told(one);
    (void)told(two);
    sent_count = 0;
}

static enum consoles_outcome say(const char *agent, const char *text, uint64_t number)
{
    return consoles_say(consoles, agent, text, one->id, number);
}

/* Waits for the count-th of what has gone out. */
static const struct sent *sent_await(size_t count)
{
    TURN_UNTIL(sent_count >= count);
    return &sent[count - 1];
}

static struct console *console_of(const char *agent)
{
    for (size_t i = 0; i < CONSOLES_MAX; i++) {
        if (consoles->all[i].used && strcmp(consoles->all[i].name, agent) == 0) {
            return &consoles->all[i];
        }
    }
    return NULL;
}

/* --- joining ---------------------------------------------------------------------------------- */

static void test_who_looks_joins_nothing(void)
{
    turn_for(MOMENT_NS);
    CU_ASSERT(registered == 0 && consoles->state == CONSOLES_OUT);
    CU_ASSERT_EQUAL(say("9lives", "(facts)", 1), CONSOLES_NO_NAME);
    CU_ASSERT_EQUAL(say("", "(facts)", 1), CONSOLES_NO_NAME);
    CU_ASSERT_EQUAL(consoles_watch(consoles, "a b", one->id, true), CONSOLES_NO_NAME);
    CU_ASSERT_EQUAL(consoles_complete(consoles, "../x", "(f", one->id, 1), CONSOLES_NO_NAME);
    turn_for(MOMENT_NS);
    CU_ASSERT(registered == 0 && consoles->state == CONSOLES_OUT);
}

static void test_who_acts_joins(void)
{
    CU_ASSERT_EQUAL(say("red", "(facts)", 1), CONSOLES_NO_BROKER);
    TURN_UNTIL(registered == 1);
    CU_ASSERT_EQUAL(say("red", "(facts)", 1), CONSOLES_NOT_YET);
    char first[MU_NAME_MAX + 1];
    snprintf(first, sizeof first, "%s", name);
    verdict(false, "taken by another");
    TURN_UNTIL(registered == 2); /* another name, unasked */
    CU_ASSERT_STRING_NOT_EQUAL(name, first);
    CU_ASSERT_EQUAL(say("red", "(facts)", 1), CONSOLES_NOT_YET);
    verdict(false, "not in the policy");
    TURN_UNTIL(consoles->state == CONSOLES_REFUSED);
    CU_ASSERT_EQUAL(say("red", "(facts)", 1), CONSOLES_DENIED);
    verdict(true, ""); /* it has thought better of it */
    TURN_UNTIL(consoles->state == CONSOLES_IN);
    CU_ASSERT_EQUAL(sent_count, 0);
}

/* --- lines ------------------------------------------------------------------------------------ */

static void test_what_is_no_line(void)
{
    static char many[3 * CONSOLE_PENDING_MAX + 4];
    begin();
    CU_ASSERT_EQUAL(say("red", "", 1), CONSOLES_NO_FORM);
    CU_ASSERT_EQUAL(say("red", " ; a comment", 1), CONSOLES_NO_FORM);
    CU_ASSERT_EQUAL(say("red", "(facts", 1), CONSOLES_NO_FORM);
    CU_ASSERT_EQUAL(say("red", "(a) (b", 1), CONSOLES_NO_FORM);
    CU_ASSERT_EQUAL(say("red", "(facts))", 1), CONSOLES_NO_FORM);
    CU_ASSERT_EQUAL(say("red", "\"open", 1), CONSOLES_NO_FORM);
    CU_ASSERT_EQUAL(say("observer", "(agents) (agents)", 1), CONSOLES_MANY);
    for (size_t i = 0; i <= CONSOLE_PENDING_MAX; i++) {
        memcpy(many + 3 * i, "(a)", 3);
    }
    CU_ASSERT_EQUAL(say("red", many, 1), CONSOLES_MANY);
    turn_for(MOMENT_NS);
    CU_ASSERT_EQUAL(sent_count, 0); /* nothing of them went out */
    READS(told(one), "");
}

static void test_an_answer_is_for_who_has_asked(void)
{
    begin();
    CU_ASSERT_EQUAL(say("red", "(assert (a))", 11), CONSOLES_DONE);
    const struct sent *s = sent_await(1);
    READS(s->to, "red");
    READS(s->performative, "do");
    READS(s->content, "(assert (a))");
    says("blue", "inform", s->label, "piece 1 1", "not mine to say");
    says("red", "inform", s->label, "piece 1 2", "<Fact");
    says("red", "inform", s->label, "piece 2 2", "-1>\n");
    is_told(one, "event: said\ndata: {\"agent\": \"red\", \"kind\": \"answer\", \"ask\": 11, "
                 "\"text\": \"<Fact\"}\n\n"
                 "event: said\ndata: {\"agent\": \"red\", \"kind\": \"answer\", \"ask\": 11, "
                 "\"text\": \"-1>\\n\"}\n\n"
                 "event: ended\ndata: {\"agent\": \"red\", \"ask\": 11, \"good\": true}\n\n");
    READS(told(two), "");
}

static void test_two_forms_have_one_end(void)
{
    begin();
    CU_ASSERT_EQUAL(say("red", "(assert (a)) (assert (b))", 12), CONSOLES_DONE);
    const struct sent first = *sent_await(1), second = *sent_await(2);
    says("red", "inform", first.label, "", "1\n");
    is_told(one, "event: said\ndata: {\"agent\": \"red\", \"kind\": \"answer\", \"ask\": 12, "
                 "\"text\": \"1\\n\"}\n\n");
    says("red", "failure", second.label, "", "no\n");
    is_told(one, "event: said\ndata: {\"agent\": \"red\", \"kind\": \"failure\", \"ask\": 12, "
                 "\"text\": \"no\\n\"}\n\n"
                 "event: ended\ndata: {\"agent\": \"red\", \"ask\": 12, \"good\": false}\n\n");
}

static void test_a_line_that_only_looks_is_a_glance(void)
{
    begin();
    CU_ASSERT_EQUAL(say("red", "(facts)", 13), CONSOLES_DONE);
    const struct sent *s = sent_await(1);
    CU_ASSERT_EQUAL(s->seq, 0);
    READS(s->content, "(facts)");
    probe_end(s->glance, muster_GLANCE_DONE, "red", "f-0\n");
    is_told(one, "event: said\ndata: {\"agent\": \"red\", \"kind\": \"answer\", \"ask\": 13, "
                 "\"text\": \"f-0\\n\"}\n\n"
                 "event: ended\ndata: {\"agent\": \"red\", \"ask\": 13, \"good\": true}\n\n");
    CU_ASSERT_EQUAL(say("red", "(facts)", 14), CONSOLES_DONE);
    s = sent_await(2);
    probe_end(s->glance, muster_GLANCE_DECLINED, "red", ""); /* then as any other line */
    s = sent_await(3);
    READS(s->performative, "do");
    says("red", "inform", s->label, "", "f-0\n");
    TURN_UNTIL(one->stream.queue_len > 0);
    has(told(one), "\"ask\": 14, \"text\": \"f-0\\n\"");
}

static void test_a_line_that_is_not_delivered(void)
{
    begin();
    CU_ASSERT_EQUAL(say("nobody", "(assert (a))", 15), CONSOLES_DONE);
    receipt(sent_await(1)->seq, muster_OUTCOME_UNKNOWN_NAME);
    TURN_UNTIL(one->stream.queue_len > 0);
    const char *got = told(one); /* what is to be done about it is for operator/answer.c to say */
    has(got, "\"kind\": \"note\", \"ask\": 15, \"text\": \"muster: to nobody: unknown-name");
    has(got, "event: ended\ndata: {\"agent\": \"nobody\", \"ask\": 15, \"good\": false}");
}

static void test_who_has_asked_has_left(void)
{
    begin();
    CU_ASSERT_EQUAL(say("red", "(assert (a))", 16), CONSOLES_DONE);
    const struct sent *s = sent_await(1);
    viewers_release(one);
    one = viewers_take(&viewers); /* the same place, and nobody that has asked */
    says("red", "inform", s->label, "", "1\n");
    TURN_UNTIL(console_of("red")->link.pending_count == 0);
    READS(told(one), "");
    READS(told(two), "");
    CU_ASSERT_EQUAL(say("red", "(assert (b))", 17), CONSOLES_DONE);
    says("red", "inform", sent_await(2)->label, "", "2\n");
    TURN_UNTIL(one->stream.queue_len > 0);
    has(told(one), "\"ask\": 17, \"text\": \"2\\n\"");
}

static void test_silence_is_told_and_a_late_answer_is_not(void)
{
    begin();
    CU_ASSERT_EQUAL(say("red", "(assert (a))", 18), CONSOLES_DONE);
    const struct sent late = *sent_await(1);
    console_of("red")->link.heard_ns = 1; /* long ago */
    is_told(one, "event: said\ndata: {\"agent\": \"red\", \"kind\": \"note\", \"ask\": 18, "
                 "\"text\": \"[no answer]\"}\n\n"
                 "event: ended\ndata: {\"agent\": \"red\", \"ask\": 18, \"good\": false}\n\n");
    CU_ASSERT_EQUAL(say("red", "(assert (b))", 19), CONSOLES_DONE);
    says("red", "inform", late.label, "", "late\n");
    turn_for(MOMENT_NS);
    READS(told(one), "");
    says("red", "inform", sent_await(2)->label, "", "2\n");
    TURN_UNTIL(one->stream.queue_len > 0);
    has(told(one), "\"ask\": 19, \"text\": \"2\\n\"");
}

static void test_limit_lines_that_wait(void)
{
    begin();
    for (uint64_t i = 0; i < CONSOLE_PENDING_MAX; i++) {
        CU_ASSERT_EQUAL(say("red", "(assert (a))", 100 + i), CONSOLES_DONE);
    }
    CU_ASSERT_EQUAL(say("red", "(assert (b))", 1), CONSOLES_BUSY);
    CU_ASSERT_EQUAL(say("green", "(assert (b))", 2), CONSOLES_DONE);
    const struct sent first = *sent_await(1);
    says("red", "inform", first.label, "", "1\n");
    TURN_UNTIL(one->stream.queue_len > 0);
    CU_ASSERT_EQUAL(say("red", "(a) (b)", 3), CONSOLES_BUSY); /* there is room for one */
    CU_ASSERT_EQUAL(say("red", "(assert (b))", 4), CONSOLES_DONE);
    CU_ASSERT_EQUAL(say("observer", "(agents)", 5), CONSOLES_DONE);
    CU_ASSERT_EQUAL(say("observer", "(agents)", 6), CONSOLES_BUSY); /* it answers one at a time */
}

/* --- who watches ------------------------------------------------------------------------------ */

static void test_who_watches_is_shown_what_nobody_has_asked(void)
{
    begin();
    CU_ASSERT_EQUAL(consoles_watch(consoles, "red", one->id, true), CONSOLES_DONE);
    CU_ASSERT_EQUAL(consoles_watch(consoles, "red", one->id, true), CONSOLES_DONE);
    CU_ASSERT_EQUAL(consoles_watch(consoles, "red", two->id, true), CONSOLES_DONE);
    READS(sent_await(1)->content, "attach 16");
    says("red", "trace", "", "", "FIRE 1\n");
    const char *shown = "event: said\ndata: {\"agent\": \"red\", \"kind\": \"trace\", \"ask\": 0, "
                        "\"text\": \"FIRE 1\\n\"}\n\n";
    is_told(one, shown);
    READS(told(two), shown);
    READS(sent_await(2)->content, "more 1"); /* once for both */
    CU_ASSERT_EQUAL(consoles_watch(consoles, "red", one->id, false), CONSOLES_DONE);
    says("red", "trace", "", "", "FIRE 2\n");
    is_told(two, "event: said\ndata: {\"agent\": \"red\", \"kind\": \"trace\", \"ask\": 0, "
                 "\"text\": \"FIRE 2\\n\"}\n\n");
    READS(told(one), "");
    READS(sent_await(3)->content, "more 1");
    viewers_release(two); /* without a word */
    READS(sent_await(4)->content, "detach");
    two = viewers_take(&viewers);
    CU_ASSERT_EQUAL(consoles_watch(consoles, "nobody-yet", one->id, false), CONSOLES_DONE);
    turn_for(MOMENT_NS);
    CU_ASSERT_EQUAL(sent_count, 4);
}

/* --- words ------------------------------------------------------------------------------------ */

static enum consoles_outcome complete(const char *line, uint64_t number)
{
    return consoles_complete(consoles, "red", line, one->id, number);
}

static void test_a_line_goes_on(void)
{
    begin();
    CU_ASSERT_EQUAL(complete("(fol", 21), CONSOLES_DONE);
    const struct sent s = *sent_await(1);
    READS(s.performative, "words");
    says("red", "inform", s.label, "piece 1 2", "f facts\nf follow\n");
    turn_for(MOMENT_NS);
    READS(told(one), ""); /* half of the words are none */
    says("red", "inform", s.label, "piece 2 2", "f fiducial\n");
    is_told(one, "event: completed\ndata: {\"agent\": \"red\", \"ask\": 21, \"count\": 1, "
                 "\"rest\": \"low \", \"words\": []}\n\n");
    CU_ASSERT_EQUAL(complete("(f", 22), CONSOLES_DONE); /* it knows them now */
    is_told(one, "event: completed\ndata: {\"agent\": \"red\", \"ask\": 22, \"count\": 3, "
                 "\"rest\": \"\", \"words\": [\"facts\", \"follow\", \"fiducial\"]}\n\n");
    CU_ASSERT_EQUAL(sent_count, 1);
    CU_ASSERT_EQUAL(say("red", "(deffunction fox () 1)", 23), CONSOLES_DONE);
    CU_ASSERT_EQUAL(complete("(fo", 24), CONSOLES_DONE); /* the line may have changed them */
    const struct sent again = *sent_await(3);
    READS(again.performative, "words");
    says("red", "inform", again.label, "", "f follow\nf fox\n");
    is_told(one, "event: completed\ndata: {\"agent\": \"red\", \"ask\": 24, \"count\": 2, "
                 "\"rest\": \"\", \"words\": [\"follow\", \"fox\"]}\n\n");
}

static void test_a_long_line_ends_in_a_word(void)
{
    static char line[2 * CONSOLES_TAB_BYTES];
    begin();
    memset(line, 'x', sizeof line - 6);
    memcpy(line + sizeof line - 6, " (fol", 6);
    CU_ASSERT_EQUAL(complete(line, 25), CONSOLES_DONE);
    is_told(one, "event: completed\ndata: {\"agent\": \"red\", \"ask\": 25, \"count\": 1, "
                 "\"rest\": \"low \", \"words\": []}\n\n");
}

static void test_words_that_do_not_come(void)
{
    begin();
    struct console *k = console_of("red");
    k->link.words_stale = true;
    CU_ASSERT_EQUAL(complete("(fol", 26), CONSOLES_DONE);
    READS(sent_await(1)->performative, "words");
    READS(told(one), "");
    k->tabs[0].since_ns = 1; /* long ago: old words are better than none */
    is_told(one, "event: completed\ndata: {\"agent\": \"red\", \"ask\": 26, \"count\": 1, "
                 "\"rest\": \"low \", \"words\": []}\n\n");
    for (uint64_t i = 0; i < CONSOLES_TABS_MAX; i++) {
        CU_ASSERT_EQUAL(complete("(fol", 30 + i), CONSOLES_DONE);
    }
    CU_ASSERT_EQUAL(complete("(fol", 40), CONSOLES_BUSY);
    TURN_UNTIL(k->tabs[0].viewer == 0);
}

/* --- places ----------------------------------------------------------------------------------- */

static const char *agent_name(int i)
{
    static char text[24];
    snprintf(text, sizeof text, "agent-%d", i);
    return text;
}

static void ask_all(int from, int to)
{
    for (int i = from; i < to; i++) {
        CU_ASSERT_EQUAL(say(agent_name(i), "(assert (a))", 50), CONSOLES_DONE);
    }
}

static void test_limit_consoles(void)
{
    begin();
    memset(consoles->all, 0, sizeof consoles->all);
    ask_all(0, CONSOLES_MAX);
    CU_ASSERT_EQUAL(say("one-more", "(assert (a))", 51), CONSOLES_BUSY);
    CU_ASSERT_EQUAL(consoles_watch(consoles, "one-more", one->id, true), CONSOLES_BUSY);
    CU_ASSERT_EQUAL(consoles_complete(consoles, "one-more", "(f", one->id, 51), CONSOLES_BUSY);
    CU_ASSERT_EQUAL(consoles_watch(consoles, "agent-0", one->id, true), CONSOLES_DONE);
    begin(); /* all are idle, but for who is watched */
    CU_ASSERT_EQUAL(consoles_watch(consoles, "agent-0", one->id, true), CONSOLES_DONE);
    CU_ASSERT_EQUAL(say("one-more", "(assert (a))", 52), CONSOLES_DONE);
    CU_ASSERT_PTR_NOT_NULL(console_of("agent-0"));
    CU_ASSERT_PTR_NULL(console_of("agent-1")); /* nobody has needed it for longest */
}

/* An agent that has lost its place, and has another one, still may answer what it was asked. */
static void test_a_late_answer_after_another_place(void)
{
    begin();
    memset(consoles->all, 0, sizeof consoles->all);
    for (int i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(say("agent-0", "(assert (a))", 60), CONSOLES_DONE);
    }
    ask_all(1, CONSOLES_MAX);
    const struct sent late[] = {*sent_await(1), *sent_await(2), *sent_await(3)};
    begin();
    CU_ASSERT_EQUAL(say("one-more", "(assert (a))", 61), CONSOLES_DONE);
    CU_ASSERT_PTR_NULL(console_of("agent-0"));
    CU_ASSERT_EQUAL(say("agent-0", "(assert (b))", 62), CONSOLES_DONE);
    const struct sent again = *sent_await(2);
    READS(again.to, "agent-0");
    for (size_t i = 0; i < 3; i++) {
        CU_ASSERT_STRING_NOT_EQUAL(late[i].label, again.label);
        says("agent-0", "inform", late[i].label, "", "late\n");
    }
    turn_for(MOMENT_NS);
    READS(told(one), "");
    says("agent-0", "inform", again.label, "", "b\n");
    TURN_UNTIL(one->stream.queue_len > 0);
    has(told(one), "\"ask\": 62, \"text\": \"b\\n\"");
}

static void test_another_name_forgets_what_was_asked(void)
{
    begin();
    CU_ASSERT_EQUAL(say("red", "(assert (a))", 70), CONSOLES_DONE);
    (void)sent_await(1);
    verdict(false, "taken by another"); /* a broker that does not know us */
    unsigned before = registered;
    TURN_UNTIL(registered == before + 1);
    is_told(one, "event: ended\ndata: {\"agent\": \"red\", \"ask\": 70, \"good\": false}\n\n");
    CU_ASSERT_EQUAL(say("red", "(assert (a))", 71), CONSOLES_NOT_YET);
}

static int open_all(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    viewers_init(&viewers, 1);
    one = viewers_take(&viewers);
    two = viewers_take(&viewers);
    struct mu_process_options options = {.domain = 100 + (int)(getpid() % 50), .name = "test"};
    if (mu_process_open(&process, &options) != MU_OK) {
        return -1;
    }
    consoles = consoles_open(process, &viewers);
    struct bus *bus = &process->bus;
    bool open = bus_reader_open(bus, BUS_REGISTRATION, NULL, &registrations) == MU_OK &&
                bus_reader_open(bus, BUS_UP, "broker.main", &ups) == MU_OK &&
                bus_writer_open(bus, BUS_BEACON, NULL, NULL, &beacon) == MU_OK &&
                bus_writer_open(bus, BUS_DELIVERY, process->name, NULL, &delivery) == MU_OK;
    return open ? 0 : -1;
}

static int close_all(void)
{
    mu_process_close(process);
    return 0;
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"who looks joins nothing", test_who_looks_joins_nothing},
        {"who acts joins", test_who_acts_joins},
        {"what is no line", test_what_is_no_line},
        {"an answer is for who has asked", test_an_answer_is_for_who_has_asked},
        {"two forms have one end", test_two_forms_have_one_end},
        {"a line that only looks is a glance", test_a_line_that_only_looks_is_a_glance},
        {"a line that is not delivered", test_a_line_that_is_not_delivered},
        {"who has asked has left", test_who_has_asked_has_left},
        {"silence is told, and a late answer is not",
         test_silence_is_told_and_a_late_answer_is_not},
        {"limit: lines that wait", test_limit_lines_that_wait},
        {"who watches is shown what nobody has asked",
         test_who_watches_is_shown_what_nobody_has_asked},
        {"a line goes on", test_a_line_goes_on},
        {"a long line ends in a word", test_a_long_line_ends_in_a_word},
        {"words that do not come", test_words_that_do_not_come},
        {"limit: consoles", test_limit_consoles},
        {"a late answer after another place", test_a_late_answer_after_another_place},
        {"another name forgets what was asked", test_another_name_forgets_what_was_asked},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"web/consoles", open_all, close_all, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
