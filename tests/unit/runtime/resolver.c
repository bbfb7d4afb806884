/* SPDX-License-Identifier: Apache-2.0 */
/* An agent that resolves addresses, and a process that watches, without a network. */
#include "capture.h"
#include "core/text.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <string.h>

static mu_process process;
static mu_agent *rita;
static char heard_buffer[1024];
static struct mu_text heard;
static uint32_t mails_read;
static const char *name_added = "green";
static unsigned times_added = 1;

static bool resolve(void *self, mu_agent *a, const char *rest, const char *sender, mu_resolution *r)
{
    mu_text_format(&heard, "%s of %s for %s by %s; ", rest, sender, mu_agent_name(a),
                   (const char *)self);
    for (unsigned i = 0; i < times_added; i++) {
        mu_text_add(&heard, mu_resolution_add(r, name_added) == MU_OK ? "" : "no ");
    }
    return strcmp(rest, "wrong") != 0;
}

static void on_world(void *self, mu_agent *a, const struct mu_percept *bodies, size_t count)
{
    (void)self;
    (void)a;
    for (size_t i = 0; i < count; i++) {
        mu_text_format(&heard, "%s at %g %g; ", bodies[i].robot, bodies[i].x_m, bodies[i].y_m);
    }
}

static void on_step(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    (void)percept;
    mu_text_format(&heard, "%s steps; ", mu_agent_name(a));
}

static void set_up(void)
{
    memset(&process, 0, sizeof process);
    process.role = PROCESS_WATCH;
    process_take_memory(&process, 0, 0);
    mails_read = 0;
    name_added = "green";
    times_added = 1;
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    struct mu_handlers handlers = {.on_world = on_world, .on_step = on_step};
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(&process, &rita, "rita", MU_KIND_AGENT, 0, &handlers),
                          MU_OK);
}

/* @return the next mail in the outbox; NULL: there is none */
static const muster_Mail *mail(void)
{
    static muster_Mail mails[16];
    uint32_t count = outbox_unsent(&rita->outbox, mails, 16);
    return mails_read < count ? &mails[mails_read++] : NULL;
}

static void accept(uint64_t incarnation)
{
    muster_Verdict yes = {
        .agent = words("rita"), .accepted = true, .broker_incarnation = incarnation};
    yes.reason = words("");
    capture_begin(); /* there is no network, which is said */
    agent_verdict(rita, &yes);
    capture_end();
}

static void test_the_broker_is_told(void)
{
    set_up();
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "no scheme", resolve, NULL), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "near", NULL, NULL), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "near", resolve, NULL), MU_OK);
    CU_ASSERT_PTR_NULL(mail());
    accept(5);
    const muster_Mail *m = mail();
    CU_ASSERT_PTR_NOT_NULL_FATAL(m);
    CU_ASSERT_STRING_EQUAL(m->dst, "broker");
    CU_ASSERT_STRING_EQUAL(m->performative, "advertise");
    CU_ASSERT_STRING_EQUAL(m->content, "resolver \"scheme=near\" 0.000000000");
    accept(5);
    CU_ASSERT_PTR_NULL(mail());
    accept(6); /* another broker has never heard of it */
    m = mail();
    CU_ASSERT_PTR_NOT_NULL_FATAL(m);
    CU_ASSERT_STRING_EQUAL(m->performative, "advertise");
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "far", resolve, NULL), MU_OK);
    m = mail();
    CU_ASSERT_PTR_NOT_NULL_FATAL(m);
    CU_ASSERT_STRING_EQUAL(m->content, "resolver \"scheme=far\" 0.000000000");
}

/* What the agent has said before there was a broker leaves no room. */
static void test_a_full_outbox_is_waited_for(void)
{
    set_up();
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "near", resolve, NULL), MU_OK);
    while (mu_agent_broadcast(rita, "hello") == MU_OK) {
    }
    uint64_t end = rita->outbox.next_seq;
    accept(5);
    CU_ASSERT_EQUAL(rita->outbox.next_seq, end);
    muster_Receipt r = {.agent = words("rita"), .first_seq = 1, .last_seq = 2};
    muster_Delivery d = {.process = words("p1"), .step = muster_STEP_NOW};
    d.receipts._buffer = &r;
    d.receipts._length = 1;
    outbox_sent(&rita->outbox, 2);
    for (int i = 0; i < 2; i++) { /* said twice, the offer goes once */
        step_take_delivery(&process, &d, NULL);
        CU_ASSERT_EQUAL(rita->outbox.next_seq, end + 1);
    }
}

/* What is answered, "PERFORMATIVE IN-REPLY-TO CONTENT"; "": nothing. */
static const char *ask(const char *src, const char *content)
{
    static char text[MU_CONTENT_MAX + 128];
    struct mu_text t;
    struct mu_mail question = {.src = src,
                               .dst = "rita",
                               .seq = 3,
                               .number = 1,
                               .layer = MU_LAYER_QUERY,
                               .performative = "resolve",
                               .language = "",
                               .ontology = "",
                               .reply_with = "resolve-7",
                               .in_reply_to = "",
                               .conversation = "",
                               .content = content};
    mu_text_init(&t, text, sizeof text);
    mu_text_clear(&heard);
    kind_mail(rita, &question);
    const muster_Mail *m = mail();
    if (m) {
        CU_ASSERT_STRING_EQUAL(m->dst, src);
        mu_text_format(&t, "%s %s %s", m->performative, m->in_reply_to, m->content);
    }
    return text;
}

static void test_questions_are_answered(void)
{
    set_up();
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "near", resolve, words("me")), MU_OK);
    CU_ASSERT_STRING_EQUAL(ask("broker", "resolve \"near:2.5\" red"), "inform resolve-7 green");
    CU_ASSERT_STRING_EQUAL(heard.at, "2.5 of red for rita by me; ");
    CU_ASSERT_STRING_EQUAL(ask("broker", "resolve \"near:\\\"\\\\\" red"),
                           "inform resolve-7 green");
    CU_ASSERT_STRING_EQUAL(heard.at, "\"\\ of red for rita by me; ");
    CU_ASSERT_STRING_EQUAL(ask("broker", "resolve \"near:wrong\" red"),
                           "failure resolve-7 no-such-address");
    times_added = 3;
    CU_ASSERT_STRING_EQUAL(ask("broker", "resolve \"near:1\" red"),
                           "inform resolve-7 green green green");
    times_added = 0;
    CU_ASSERT_STRING_EQUAL(ask("broker", "resolve \"near:1\" red"), "inform resolve-7 ");
    times_added = 1;
    name_added = "no name";
    CU_ASSERT_STRING_EQUAL(ask("broker", "resolve \"near:1\" red"), "inform resolve-7 ");
    CU_ASSERT_STRING_EQUAL(heard.at, "1 of red for rita by me; no ");
}

static void test_garbage_is_no_question(void)
{
    static const char *const contents[] = {
        "",
        "resolve",
        "resolve near:2.5 red",
        "resolve \"near:2.5",
        "resolve \"near:2.5\\",
        "resolve \"near:2.5\"",
        "resolve \"near:2.5\" ",
        "resolve \"near:2.5\" two names",
        "resolve \"near\" red",
        "resolve \"role:2.5\" red",
        "resolve \"nearer:2.5\" red",
    };
    set_up();
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "near", resolve, NULL), MU_OK);
    for (size_t i = 0; i < sizeof contents / sizeof contents[0]; i++) {
        CU_ASSERT_STRING_EQUAL(ask("broker", contents[i]), "failure resolve-7 no-such-address");
        CU_ASSERT_STRING_EQUAL(heard.at, "");
    }
    CU_ASSERT_STRING_EQUAL(ask("blue", "resolve \"near:2.5\" red"),
                           "not-understood resolve-7 resolve");
    set_up(); /* who resolves nothing is not the one to ask */
    CU_ASSERT_STRING_EQUAL(ask("broker", "resolve \"near:2.5\" red"),
                           "not-understood resolve-7 resolve");
}

static void test_an_answer_is_one_mail(void)
{
    set_up();
    CU_ASSERT_EQUAL(mu_agent_resolve(rita, "near", resolve, words("me")), MU_OK);
    name_added = "a234567890123456789012345678901"; /* the longest */
    times_added = (MU_CONTENT_MAX + 1) / (MU_NAME_MAX + 1);
    (void)ask("broker", "resolve \"near:1\" red");
    CU_ASSERT_STRING_EQUAL(heard.at, "1 of red for rita by me; ");
    times_added++;
    const char *said_ = ask("broker", "resolve \"near:1\" red");
    CU_ASSERT_STRING_EQUAL(heard.at, "1 of red for rita by me; no ");
    CU_ASSERT_EQUAL(strlen(said_), strlen("inform resolve-7 ") + 512 * (MU_NAME_MAX + 1) - 1);
}

static void test_who_watches_sees_all_bodies(void)
{
    static muster_Percept percepts[MU_ROBOTS_MAX + 1];
    set_up();
    percepts[0] = (muster_Percept){.robot = words("red"), .x_m = 1.5, .y_m = -2};
    percepts[1] = (muster_Percept){.robot = words("rita"), .x_m = 9}; /* a body is not hers */
    muster_Sense sense = {.process = words("p1"), .step = 7};
    sense.robots._buffer = percepts;
    sense.robots._length = 2;
    muster_Delivery nothing = {.process = words("p1"), .step = 6};
    capture_begin();
    (void)process_step_on(&process, STEP_LOCKSTEP);
    step_live(&process, &sense, &nothing);
    capture_end();
    CU_ASSERT_STRING_EQUAL(heard.at, "red at 1.5 -2; rita at 9 0; ");
    CU_ASSERT_EQUAL(process.up_state, UP_PENDING);
    CU_ASSERT_EQUAL(process.out.step, 7);
    CU_ASSERT_EQUAL(process.out.acts._length, 1);
    for (uint32_t i = 0; i <= MU_ROBOTS_MAX; i++) {
        percepts[i] = (muster_Percept){.robot = words("r")};
    }
    process.up_state = UP_NONE;
    sense.robots._length = MU_ROBOTS_MAX + 1; /* more than a world has: the rest is not seen */
    static char many[32 * (MU_ROBOTS_MAX + 1)];
    mu_text_init(&heard, many, sizeof many);
    capture_begin();
    (void)process_step_on(&process, STEP_LOCKSTEP);
    step_live(&process, &sense, &nothing);
    capture_end();
    CU_ASSERT_EQUAL(heard.len, MU_ROBOTS_MAX * strlen("r at 0 0; "));
}

static void test_a_body_and_the_world_do_not_go_together(void)
{
    mu_process *p;
    struct mu_process_options options = {.with_body = true, .watches = true};
    CU_ASSERT_EQUAL(mu_process_open(&p, &options), MU_FAULT_USAGE);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the broker is told", test_the_broker_is_told},
        {"a full outbox is waited for", test_a_full_outbox_is_waited_for},
        {"questions are answered", test_questions_are_answered},
        {"garbage is no question", test_garbage_is_no_question},
        {"an answer is one mail", test_an_answer_is_one_mail},
        {"who watches sees all bodies", test_who_watches_sees_all_bodies},
        {"a body and the world do not go together", test_a_body_and_the_world_do_not_go_together},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime: resolver", tests);
}
