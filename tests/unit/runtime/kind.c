/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Who takes a mail, what is answered, and which hooks are called: an agent in memory, without a
 * network.  What happens is one line of text, and answers are read from the outbox.
 */
#include "capture.h"
#include "core/text.h"
#include "runtime/process.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static mu_process process;
static muster_Sense sense;
static mu_agent *red;
static uint32_t answers_read;
static char heard_buffer[1024];
static struct mu_text heard;

static void hear(const char *who, const struct mu_mail *mail)
{
    mu_text_format(&heard, "%s %s; ", who, mail->performative);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    CU_ASSERT_PTR_EQUAL(self, &process);
    CU_ASSERT_PTR_EQUAL(a, red);
    hear("on_mail", mail);
}

/* --- two kinds -------------------------------------------------------------------------------- */

static enum mu_take parent_greet(void *self, mu_agent *a, const struct mu_mail *mail)
{
    CU_ASSERT_PTR_EQUAL(self, &process);
    hear("parent", mail);
    return mu_agent_reply(a, mail, "inform", "hello") == MU_OK ? MU_TAKEN : MU_DECLINE;
}

static enum mu_take parent_sell(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    hear("parent", mail);
    return MU_DECLINE;
}

static enum mu_take child_pass(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    hear("child looks at", mail);
    return MU_PASS;
}

static enum mu_take child_greet(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    hear("child", mail);
    enum mu_take took = mu_agent_take_parent(a, mail);
    hear("child again", mail);
    return took;
}

static enum mu_take child_any(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    hear("child any", mail);
    return strcmp(mail->performative, "pass") == 0 ? MU_PASS : MU_TAKEN;
}

static void parent_create(void *self, mu_agent *a)
{
    CU_ASSERT_PTR_EQUAL(self, &process);
    mu_text_format(&heard, "%s created; ", mu_agent_name(a));
}

static void parent_run(void *self, mu_agent *a)
{
    (void)self;
    mu_text_format(&heard, "%s runs; ", mu_agent_name(a));
}

static void child_run(void *self, mu_agent *a)
{
    (void)self;
    mu_text_add(&heard, "child: ");
    mu_agent_event_parent(a);
    mu_text_add(&heard, "ran; ");
}

static void child_dispose(void *self, mu_agent *a)
{
    (void)self;
    mu_text_format(&heard, "disposed while %s; ", mu_state_text(mu_agent_state(a)));
    mu_agent_event_parent(a); /* no parent has that hook */
    CU_ASSERT_EQUAL(mu_agent_broadcast(a, "farewell"), MU_OK);
}

static const struct mu_layer_handler parent_handlers[] = {
    {4, "greet", parent_greet}, {4, "sell", parent_sell}, {77, NULL, parent_greet}, {0}};
static const struct mu_agent_kind parent = {
    .name = "parent",
    .handlers = parent_handlers,
    .hooks = {[MU_ON_CREATE] = parent_create, [MU_ON_RUN] = parent_run}};
static const struct mu_layer_handler child_handlers[] = {{4, "greet", child_pass},
                                                         {4, "greet", child_greet},
                                                         {5, NULL, child_any},
                                                         {MU_LAYER_SYSTEM, "clone", child_any},
                                                         {0}};
static const struct mu_agent_kind child = {
    .name = "child",
    .parent = &parent,
    .handlers = child_handlers,
    .hooks = {[MU_ON_RUN] = child_run, [MU_ON_DISPOSE] = child_dispose}};

/* --- an agent of a kind ----------------------------------------------------------------------- */

static void set_up(enum mu_kind kind, const struct mu_agent_kind *of, bool has_on_mail)
{
    memset(&process, 0, sizeof process);
    memset(&sense, 0, sizeof sense);
    process_take_memory(&process, 0, 0);
    answers_read = 0;
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    struct mu_handlers handlers = {.self = &process, .on_mail = has_on_mail ? on_mail : NULL};
    capture_begin(); /* registering finds no network, and says so */
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &red, "red", kind, 0, &handlers), MU_OK);
    capture_end();
    if (of) {
        mu_agent_be(red, of);
    }
}

static struct mu_mail mail(uint32_t layer, const char *performative)
{
    return (struct mu_mail){.src = "blue",
                            .dst = "red",
                            .seq = 9,
                            .number = 1,
                            .layer = layer,
                            .performative = performative,
                            .language = "",
                            .ontology = "",
                            .reply_with = "q",
                            .in_reply_to = "",
                            .conversation = "c",
                            .content = ""};
}

static void take(struct mu_mail m)
{
    capture_begin();
    kind_mail(red, &m);
    capture_end();
}

/* @return the next answer in the outbox; NULL: there is none */
static const muster_Mail *answer(void)
{
    static muster_Mail mails[16];
    uint32_t count = outbox_unsent(&red->outbox, mails, 16);
    return answers_read < count ? &mails[answers_read++] : NULL;
}

static void expect_answer(const char *performative, const char *content)
{
    const muster_Mail *m = answer();
    CU_ASSERT_PTR_NOT_NULL_FATAL(m);
    CU_ASSERT_STRING_EQUAL(m->dst, "blue");
    CU_ASSERT_STRING_EQUAL(m->performative, performative);
    CU_ASSERT_STRING_EQUAL(m->content, content);
    CU_ASSERT_PTR_NULL(answer());
}

static void expect_heard(const char *want)
{
    CU_ASSERT_STRING_EQUAL(heard.at, want);
    mu_text_clear(&heard);
}

static void test_the_nearest_kind_takes_it(void)
{
    set_up(MU_KIND_AGENT, &parent, true);
    take(mail(4, "greet"));
    expect_heard("parent greet; ");
    expect_answer("inform", "hello");

    set_up(MU_KIND_AGENT, &child, true);
    take(mail(4, "greet"));
    expect_heard("child looks at greet; child greet; parent greet; child again greet; ");
    expect_answer("inform", "hello");
}

static void test_a_layer_is_a_number(void)
{
    set_up(MU_KIND_AGENT, &child, true);
    take(mail(5, "anything"));
    take(mail(5, "pass"));
    take(mail(6, "greet"));
    take(mail(77, "words"));
    take(mail(UINT32_MAX, "greet"));
    expect_heard("child any anything; child any pass; on_mail pass; on_mail greet; parent words; "
                 "on_mail greet; ");
    expect_answer("inform", "hello");
}

static void test_on_mail_has_what_no_kind_takes(void)
{
    set_up(MU_KIND_AGENT, NULL, true);
    take(mail(MU_LAYER_SPEECH, "tell"));
    take(mail(MU_LAYER_SYSTEM, "dance"));
    take(mail(MU_LAYER_QUERY, "weather"));
    take(mail(MU_LAYER_QUERY, "state")); /* this one the base kind takes */
    expect_heard("on_mail tell; on_mail dance; on_mail weather; ");
    expect_answer("inform", "state running");
}

static void test_what_nobody_takes_is_not_understood(void)
{
    set_up(MU_KIND_AGENT, &child, false);
    take(mail(MU_LAYER_SPEECH, "tell"));
    expect_answer("not-understood", "tell");
    set_up(MU_KIND_AGENT, &child, false);
    take(mail(5, "pass"));
    expect_answer("not-understood", "pass");
    expect_heard("child any pass; ");
}

static void test_no_answer_to_an_answer_or_to_many(void)
{
    static const struct {
        const char *dst, *performative, *in_reply_to;
        bool answered;
    } cases[] = {
        {"red", "tell", "", true},        {"blue,red", "tell", "", true},
        {"red,blue", "tell", "", true},   {"green,red,blue", "tell", "", true},
        {"all", "tell", "", false},       {"robots", "tell", "", false},
        {"group:red", "tell", "", false}, {"redder,blue", "tell", "", false},
        {"red", "tell", "q7", false},     {"red", "not-understood", "", false},
        {"red", "refuse", "", false},     {"red", "sorry", "", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        set_up(MU_KIND_AGENT, NULL, false);
        struct mu_mail m = mail(MU_LAYER_SPEECH, cases[i].performative);
        m.dst = cases[i].dst;
        m.in_reply_to = cases[i].in_reply_to;
        take(m);
        CU_ASSERT_EQUAL(answer() != NULL, cases[i].answered);
    }
}

static void test_declining_answers_refuse(void)
{
    set_up(MU_KIND_AGENT, &child, true);
    take(mail(4, "sell"));
    expect_heard("parent sell; ");
    expect_answer("refuse", "sell");

    set_up(MU_KIND_AGENT, &child, true);
    struct mu_mail m = mail(4, "sell");
    m.in_reply_to = "q7"; /* an answer is not refused */
    take(m);
    m.in_reply_to = "";
    m.dst = "all";
    m.reply_with = ""; /* a cry to everybody, either */
    take(m);
    CU_ASSERT_PTR_NULL(answer());
    m.reply_with = "q"; /* but a question to everybody is */
    take(m);
    expect_answer("refuse", "sell");
}

static void test_a_reply_goes_where_the_mail_came_from(void)
{
    set_up(MU_KIND_AGENT, NULL, true);
    struct mu_mail m = mail(12, "ask-one");
    m.language = "json";
    m.ontology = "map";
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "tell", "[1]"), MU_OK);
    const muster_Mail *a = answer();
    CU_ASSERT_PTR_NOT_NULL_FATAL(a);
    CU_ASSERT_STRING_EQUAL(a->dst, "blue");
    CU_ASSERT_EQUAL(a->layer, 12);
    CU_ASSERT_STRING_EQUAL(a->performative, "tell");
    CU_ASSERT_STRING_EQUAL(a->language, "json");
    CU_ASSERT_STRING_EQUAL(a->ontology, "map");
    CU_ASSERT_STRING_EQUAL(a->in_reply_to, "q");
    CU_ASSERT_STRING_EQUAL(a->conversation, "c");
    CU_ASSERT_STRING_EQUAL(a->content, "[1]");
    CU_ASSERT_STRING_EQUAL(a->reply_with, "");
    CU_ASSERT_EQUAL(a->ttl_ns, 0);
}

static enum mu_take take_whole(void *self, mu_agent *a, const struct mu_mail *m)
{
    (void)self;
    (void)a;
    CU_ASSERT_STRING_EQUAL(m->performative, "ask-one");
    CU_ASSERT_STRING_EQUAL(m->language, "json");
    CU_ASSERT_STRING_EQUAL(m->ontology, "map");
    CU_ASSERT_STRING_EQUAL(m->reply_with, "q");
    CU_ASSERT_STRING_EQUAL(m->in_reply_to, "p");
    CU_ASSERT_STRING_EQUAL(m->conversation, "c");
    CU_ASSERT_STRING_EQUAL(m->content, "[2]");
    CU_ASSERT_EQUAL(m->reply_by_ns, 7000);
    CU_ASSERT_EQUAL(m->priority, MU_PRIORITY_HIGH);
    CU_ASSERT_EQUAL(m->level, MU_LEVEL_SYNCED);
    hear("whole", m);
    return MU_TAKEN;
}

/* From mu_agent_send over the wire's form to the handler. */
static void test_every_field_goes_out_and_comes_in(void)
{
    static const struct mu_layer_handler handlers[] = {{8, NULL, take_whole}, {0}};
    static const struct mu_agent_kind whole = {.name = "whole", .handlers = handlers};
    set_up(MU_KIND_AGENT, &whole, false);
    struct mu_mail m = {.dst = "red",
                        .layer = 8,
                        .performative = "ask-one",
                        .language = "json",
                        .ontology = "map",
                        .reply_with = "q",
                        .in_reply_to = "p",
                        .conversation = "c",
                        .content = "[2]",
                        .reply_by_ns = 7000,
                        .priority = MU_PRIORITY_HIGH,
                        .level = MU_LEVEL_SYNCED};
    CU_ASSERT_EQUAL(mu_agent_send(red, &m, NULL), MU_OK);
    const muster_Mail *out = answer();
    CU_ASSERT_PTR_NOT_NULL_FATAL(out);
    agent_mail(red, &(muster_Parcel){.box = red->name, .number = 1, .letter = *out});
    expect_heard("whole ask-one; ");
}

/* Two agents that answer whatever they get end after one answer. */
static void test_answers_do_not_ping_pong(void)
{
    set_up(MU_KIND_AGENT, NULL, true);
    struct mu_mail m = mail(MU_LAYER_SPEECH, "inform");
    m.reply_with = "";
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "inform", "x"), MU_OK);
    const muster_Mail *a = answer();
    CU_ASSERT_PTR_NOT_NULL_FATAL(a);
    CU_ASSERT_STRING_EQUAL(a->in_reply_to, "9"); /* its number, for want of a name */

    m.in_reply_to = a->in_reply_to;
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "inform", "x"), MU_REFUSED);
    m.in_reply_to = "";
    m.performative = "failure";
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "inform", "x"), MU_REFUSED);
    CU_ASSERT_PTR_NULL(answer());
    m.reply_with = "q2"; /* a proposal wants to be accepted */
    m.performative = "propose";
    m.in_reply_to = "q1";
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "accept-proposal", "x"), MU_OK);
}

static void test_an_answer_that_comes_too_late(void)
{
    set_up(MU_KIND_AGENT, NULL, true);
    struct mu_mail m = mail(MU_LAYER_SPEECH, "ask-one");
    m.reply_by_ns = 500;
    sense.time_ns = 499;
    process.step = &sense;
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "tell", ""), MU_OK);
    const muster_Mail *a = answer();
    CU_ASSERT_PTR_NOT_NULL_FATAL(a);
    CU_ASSERT_EQUAL(a->ttl_ns, 1);
    sense.time_ns = 500;
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "tell", ""), MU_TIMEOUT);
    CU_ASSERT_PTR_NULL(answer());
    process.step = NULL; /* who has no step has no time of the run */
    CU_ASSERT_EQUAL(mu_agent_reply(red, &m, "tell", ""), MU_OK);
}

static void test_parents_outside_of_handlers(void)
{
    set_up(MU_KIND_AGENT, &child, true);
    struct mu_mail m = mail(4, "greet");
    CU_ASSERT_EQUAL(mu_agent_take_parent(red, &m), MU_PASS);
    mu_agent_event_parent(red);
    expect_heard("");
}

/* --- the base kind ---------------------------------------------------------------------------- */

static void test_requests_to_the_base_kind(void)
{
    static const struct {
        enum mu_state before;
        const char *performative;
        enum mu_state after;
        const char *answer, *content;
    } cases[] = {
        {MU_RUNNING, "suspend", MU_SUSPENDED, "agree", "suspend"},
        {MU_SUSPENDED, "suspend", MU_SUSPENDED, "agree", "suspend"},
        {MU_STANDBY, "suspend", MU_STANDBY, "refuse", "suspend"},
        {MU_SUSPENDED, "resume", MU_RUNNING, "agree", "resume"},
        {MU_STANDBY, "resume", MU_STANDBY, "refuse", "resume"},
        {MU_RUNNING, "dispose", MU_GONE, "agree", "dispose"},
        {MU_RUNNING, "dispatch", MU_RUNNING, "refuse", "dispatch no-mobility"},
        {MU_RUNNING, "retract", MU_RUNNING, "refuse", "retract no-mobility"},
        {MU_RUNNING, "clone", MU_RUNNING, "refuse", "clone no-mobility"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        set_up(MU_KIND_AGENT, NULL, true);
        red->state = cases[i].before;
        take(mail(MU_LAYER_SYSTEM, cases[i].performative));
        CU_ASSERT_EQUAL(mu_agent_state(red), cases[i].after);
        expect_answer(cases[i].answer, cases[i].content);
        expect_heard("");
    }
}

static void test_special_agents_obey_nobody_s_request(void)
{
    set_up(MU_KIND_SPECIAL, NULL, true);
    take(mail(MU_LAYER_SYSTEM, "dispose"));
    CU_ASSERT_EQUAL(mu_agent_state(red), MU_RUNNING);
    expect_answer("refuse", "dispose");
}

static void test_a_child_overrides_the_base_kind(void)
{
    set_up(MU_KIND_AGENT, &child, true);
    take(mail(MU_LAYER_SYSTEM, "clone"));
    expect_heard("child any clone; ");
    CU_ASSERT_PTR_NULL(answer());
}

/* --- hooks ------------------------------------------------------------------------------------ */

static void verdict(bool accepted)
{
    capture_begin();
    agent_verdict(red, &(muster_Verdict){.accepted = accepted, .reason = heard_buffer});
    capture_end();
}

static void change(enum mu_state state)
{
    capture_begin();
    mu_agent_set_state(red, state);
    capture_end();
}

static void test_hooks_of_a_robot(void)
{
    set_up(MU_KIND_ROBOT, &child, true);
    expect_heard("");
    verdict(true);
    expect_heard("red created; ");
    verdict(true);
    expect_heard("");
    change(MU_RUNNING);
    expect_heard("child: red runs; ran; ");
    change(MU_SUSPENDED);
    change(MU_RUNNING);
    expect_heard("");
    change(MU_STANDBY);
    change(MU_RUNNING);
    expect_heard("child: red runs; ran; ");
    change(MU_GONE);
    expect_heard("disposed while running; ");
    const muster_Mail *last = answer();
    CU_ASSERT_PTR_NOT_NULL_FATAL(last);
    CU_ASSERT_STRING_EQUAL(last->content, "farewell");
    kind_end(red);
    expect_heard("");
}

static void test_hooks_of_an_agent_that_runs_at_once(void)
{
    set_up(MU_KIND_AGENT, &parent, true);
    verdict(true);
    expect_heard("red created; red runs; ");
    change(MU_GONE);
    expect_heard("");
}

static void test_who_was_never_accepted_has_no_hooks(void)
{
    set_up(MU_KIND_AGENT, &child, true);
    verdict(false);
    change(MU_GONE);
    expect_heard("");
}

static void test_events_of_mobility_go_through_the_chain(void)
{
    set_up(MU_KIND_AGENT, &child, true);
    kind_event(red, MU_ON_ARRIVE);
    expect_heard("");
    kind_event(red, MU_ON_CREATE);
    expect_heard("red created; ");
}

static enum mu_take pass(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    (void)mail;
    return MU_PASS;
}

static void test_kinds_with_many_ancestors(void)
{
    static const struct mu_layer_handler handlers[] = {{4, NULL, pass}, {0}};
    static struct mu_agent_kind kinds[200];
    for (size_t i = 0; i < 200; i++) {
        kinds[i] = (struct mu_agent_kind){
            .name = "deep", .parent = i > 0 ? &kinds[i - 1] : &parent, .handlers = handlers};
    }
    set_up(MU_KIND_AGENT, &kinds[199], false);
    take(mail(4, "greet"));
    expect_heard("parent greet; ");
    expect_answer("inform", "hello");
}

/* @return how the process ends in which an agent is of a kind with the last of so many as parent */
static int status_of_ring(size_t count)
{
    static struct mu_agent_kind kinds[8];
    for (size_t i = 0; i < count; i++) {
        kinds[i] = (struct mu_agent_kind){.name = "ring", .parent = &kinds[(i + 1) % count]};
    }
    capture_begin();
    pid_t pid = fork();
    if (pid == 0) {
        alarm(20); /* rather than go round for ever */
        mu_agent_be(red, &(struct mu_agent_kind){.name = "child", .parent = &kinds[0]});
        _exit(0);
    }
    int status = 0;
    CU_ASSERT_EQUAL(waitpid(pid, &status, 0), pid);
    capture_end();
    return status;
}

static void test_a_kind_that_is_its_own_ancestor(void)
{
    set_up(MU_KIND_AGENT, &child, false);
    for (size_t count = 1; count <= 8; count++) {
        int status = status_of_ring(count);
        CU_ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the nearest kind takes it", test_the_nearest_kind_takes_it},
        {"a layer is a number", test_a_layer_is_a_number},
        {"on_mail has what no kind takes", test_on_mail_has_what_no_kind_takes},
        {"what nobody takes is not understood", test_what_nobody_takes_is_not_understood},
        {"no answer to an answer or to many", test_no_answer_to_an_answer_or_to_many},
        {"declining answers refuse", test_declining_answers_refuse},
        {"a reply goes where the mail came from", test_a_reply_goes_where_the_mail_came_from},
        {"every field goes out and comes in", test_every_field_goes_out_and_comes_in},
        {"answers do not ping-pong", test_answers_do_not_ping_pong},
        {"an answer that comes too late", test_an_answer_that_comes_too_late},
        {"parents outside of handlers", test_parents_outside_of_handlers},
        {"requests to the base kind", test_requests_to_the_base_kind},
        {"special agents obey nobody's request", test_special_agents_obey_nobody_s_request},
        {"a child overrides the base kind", test_a_child_overrides_the_base_kind},
        {"hooks of a robot", test_hooks_of_a_robot},
        {"hooks of an agent that runs at once", test_hooks_of_an_agent_that_runs_at_once},
        {"who was never accepted has no hooks", test_who_was_never_accepted_has_no_hooks},
        {"many ancestors", test_kinds_with_many_ancestors},
        {"its own ancestor", test_a_kind_that_is_its_own_ancestor},
        {"events of mobility", test_events_of_mobility_go_through_the_chain},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/kind", tests);
}
