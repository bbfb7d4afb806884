/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A process on a real network, loopback alone.  This test is the broker and the simulator: its
 * readers and writers share the participant of the process under test.
 */
#include "runtime/process.h"
#include "core/clock.h"
#include "core/text.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;

/* Both processes of this test, each in a domain of its own. */
static struct peer {
    mu_process *process;
    struct bus_reader registrations, to_broker, to_simulator;
    struct bus_writer delivery, sense, beacon;
} mind, body;

/* What the last registration and the last answer said. */
static struct {
    unsigned registrations, ups, registrations_lost;
    char name[MU_NAME_MAX + 1], broker[MU_NAME_MAX + 1];
    uint64_t incarnation;
    muster_State state;
    bool ready, no_broadcasts;
    muster_BoxPolicy full;
    uint32_t box_mails;
    uint64_t box_bytes;
    int64_t step;
    uint32_t mails;
    uint64_t seq, ack;
    char content[64];
    bool drives;
    double forward_m_s;
    char reason[MU_FIELD_MAX + 1];
    char glances[512];
} seen;

static char heard_buffer[4096];
static struct mu_text heard;
static bool idle; /* who acts sets no speed */
static bool slow; /* who acts takes long, and says so */

static void look(struct peer *p);

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    mu_text_format(&heard, "%s %s%s; ", mu_agent_name(a), accepted ? "welcome" : "no ", reason);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    mu_text_format(&heard, "%s#%llu %s %s; ", mu_agent_name(a), (unsigned long long)mail->number,
                   mail->src, mail->content);
}

/* Looks at the network in the middle of a handler: the word must be out by then. */
static void work_long(void)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (strncmp(seen.reason, "busy since ", 11) != 0 && mu_clock_ns() < until_ns) {
        process_work(body.process);
        look(&body);
    }
    mu_text_format(&heard, "%.10s; ", seen.reason);
}

static void on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    if (slow) {
        work_long();
    }
    mu_text_format(&heard, "%s acts in %lld; ", mu_agent_name(a), (long long)percept->step);
    if (!idle) {
        CU_ASSERT_EQUAL(mu_agent_drive(a, 0.25, 0.0), MU_OK);
    }
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)self;
    mu_text_format(&heard, "%s %llu-%llu %s; ", mu_agent_name(a), (unsigned long long)first_seq,
                   (unsigned long long)last_seq, mu_outcome_text(outcome));
}

static const struct mu_handlers handlers = {
    .on_registered = on_registered, .on_mail = on_mail, .on_act = on_act, .on_receipt = on_receipt};

static void look_at_glances(const muster_Up *up)
{
    size_t len = strlen(seen.glances);
    for (uint32_t i = 0; i < up->glances._length && len < sizeof seen.glances; i++) {
        const muster_Glance *g = &up->glances._buffer[i];
        len += (size_t)snprintf(seen.glances + len, sizeof seen.glances - len, "%s/%llu %s %s %s; ",
                                g->asker, (unsigned long long)g->number, g->agent,
                                glance_word(g->word), g->text);
    }
}

static void look_at_up(struct bus_reader *reader)
{
    enum bus_life life;
    for (const muster_Up *up; (up = bus_next(reader, &life)) != NULL;) {
        if (life != BUS_DATA) {
            continue;
        }
        seen.ups++;
        seen.step = up->step;
        seen.ack = up->acks._length > 0 ? up->acks._buffer[0].number : seen.ack;
        const muster_Act *act = up->acts._buffer;
        look_at_glances(up);
        if (up->acts._length == 0) {
            continue;
        }
        seen.mails += act->mails._length;
        seen.drives = act->drives;
        seen.forward_m_s = act->forward_m_s;
        if (act->mails._length > 0) {
            const muster_Mail *last = &act->mails._buffer[act->mails._length - 1];
            seen.seq = last->seq;
            mu_text_copy(seen.content, sizeof seen.content, last->content);
        }
    }
}

static void look(struct peer *p)
{
    enum bus_life life;
    for (const muster_Registration *r; (r = bus_next(&p->registrations, &life)) != NULL;) {
        seen.registrations += life == BUS_DATA;
        seen.registrations_lost += life == BUS_DISPOSED;
        if (life == BUS_DATA) {
            const muster_Entry *e = r->agents._buffer;
            CU_ASSERT_EQUAL_FATAL(r->agents._length, 1);
            mu_text_copy(seen.name, sizeof seen.name, e->name);
            mu_text_copy(seen.broker, sizeof seen.broker, r->broker);
            seen.incarnation = r->incarnation;
            seen.state = e->state;
            mu_text_copy(seen.reason, sizeof seen.reason, e->reason);
            seen.no_broadcasts = e->no_broadcasts;
            seen.full = e->full;
            seen.box_mails = e->box_mails;
            seen.box_bytes = e->box_bytes;
            seen.ready = r->ready;
        }
    }
    struct bus_reader *const readers[] = {&p->to_broker, &p->to_simulator};
    for (size_t i = 0; i < 2; i++) {
        if (readers[i]->bus) { /* it is open */
            look_at_up(readers[i]);
        }
    }
}

/* Spins and looks for so long. */
static void spin_for(struct peer *p, uint64_t ns)
{
    uint64_t until_ns = mu_clock_ns() + ns;
    do {
        CU_ASSERT_EQUAL_FATAL(mu_process_spin(p->process, 2000000), MU_OK);
        look(p);
    } while (mu_clock_ns() < until_ns);
}

#define SPIN_UNTIL(p, condition)                           \
    do {                                                   \
        uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;   \
        while (!(condition) && mu_clock_ns() < until_ns) { \
            spin_for(p, 0);                                \
        }                                                  \
        CU_ASSERT_TRUE_FATAL(condition);                   \
    } while (0)

static bool has(const char *text, const char *part)
{
    return strstr(text, part) != NULL;
}

static void forget(void)
{
    memset(&seen, 0, sizeof seen);
    mu_text_clear(&heard);
}

static muster_Delivery delivery_to(const struct peer *p, int64_t step)
{
    return (muster_Delivery){.process = words(p->process->name),
                             .broker = words("main"),
                             .broker_incarnation = p->process->link.incarnation,
                             .step = step};
}

static void deliver(struct peer *p, const muster_Delivery *d)
{
    CU_ASSERT_EQUAL_FATAL(bus_write(&p->delivery, d), MU_OK);
}

static void deliver_verdict(struct peer *p, const char *agent)
{
    muster_Verdict v = {.agent = words(agent),
                        .accepted = true,
                        .broker_incarnation = p->process->link.incarnation,
                        .reason = words("")};
    muster_Delivery d = delivery_to(p, muster_STEP_NOW);
    d.verdicts._buffer = &v;
    d.verdicts._length = d.verdicts._maximum = 1;
    deliver(p, &d);
}

static void deliver_mail(struct peer *p, int64_t step, const char *agent, uint64_t number)
{
    muster_Parcel item = {
        .box = words(agent), .number = number, .letter = letter("blue", number, agent, "hi")};
    muster_Delivery d = delivery_to(p, step);
    d.parcels._buffer = &item;
    d.parcels._length = d.parcels._maximum = 1;
    deliver(p, &d);
}

static void deliver_glance(struct peer *p, muster_GlanceWord word, const char *asker,
                           uint64_t number, const char *text)
{
    muster_Glance g = {.word = word,
                       .asker = words(asker),
                       .number = number,
                       .agent = words("robot"),
                       .text = words(text)};
    muster_Delivery d = delivery_to(p, muster_STEP_NOW);
    d.glances._buffer = &g;
    d.glances._length = d.glances._maximum = 1;
    deliver(p, &d);
}

static void sense(struct peer *p, int64_t step, bool lockstep, bool last)
{
    muster_Percept percept = {.robot = words("robot")};
    muster_Sense s = {
        .process = words(p->process->name), .step = step, .lockstep = lockstep, .last = last};
    s.robots._buffer = &percept;
    s.robots._length = s.robots._maximum = 1;
    CU_ASSERT_EQUAL_FATAL(bus_write(&p->sense, &s), MU_OK);
}

static void open_process(struct peer *p, int domain)
{
    struct mu_process_options options = {.domain = domain, .name = "test", .with_body = p == &body};
    CU_ASSERT_EQUAL_FATAL(mu_process_open(&p->process, &options), MU_OK);
    CU_ASSERT_EQUAL(bus_reader_open(&p->process->bus, BUS_REGISTRATION, NULL, &p->registrations),
                    MU_OK);
}

static void shine(struct peer *p, const char *broker, uint64_t incarnation, uint32_t index)
{
    muster_Beacon b = {.broker = words(broker),
                       .incarnation = incarnation,
                       .host = words("elsewhere"),
                       .index = index,
                       .takes_agents = true};
    CU_ASSERT_EQUAL_FATAL(bus_write(&p->beacon, &b), MU_OK);
}

/* Broker and simulator come up. */
static void open_peers(struct peer *p)
{
    struct bus *bus = &p->process->bus;
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(bus, BUS_UP, "broker.alpha", &p->to_broker), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_BEACON, NULL, NULL, &p->beacon), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_DELIVERY, p->process->name, NULL, &p->delivery),
                          MU_OK);
    if (p == &body) {
        CU_ASSERT_EQUAL_FATAL(bus_reader_open(bus, BUS_UP, "simulator", &p->to_simulator), MU_OK);
        CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_SENSE, p->process->name, NULL, &p->sense),
                              MU_OK);
    }
}

static void test_no_broker_answers(void)
{
    open_process(&mind, 100 + (int)(getpid() % 50));
    CU_ASSERT_FALSE(mu_process_has_broker(mind.process));
    CU_ASSERT_EQUAL(mu_process_await_broker(mind.process, 20000000), MU_TIMEOUT);
}

static void test_joining(void)
{
    mu_agent *a = NULL;
    forget();
    CU_ASSERT_EQUAL(mu_agent_join(mind.process, &a, "red", MU_KIND_AGENT, 0, &handlers), MU_OK);
    open_peers(&mind);
    spin_for(&mind, 50000000);
    CU_ASSERT_EQUAL(seen.registrations, 0); /* there is nobody to tell */
    CU_ASSERT_FALSE(mu_process_has_broker(mind.process));
    shine(&mind, "beta", 6, 3);
    shine(&mind, "alpha", 5, 2);
    SPIN_UNTIL(&mind, seen.registrations >= 1);
    CU_ASSERT_TRUE(mu_process_has_broker(mind.process));
    CU_ASSERT_PTR_NULL(mu_process_broker(mind.process)); /* has not answered */
    CU_ASSERT_STRING_EQUAL(seen.broker, "alpha");
    CU_ASSERT_STRING_EQUAL(seen.name, "red");
    CU_ASSERT_EQUAL(seen.state, muster_STATE_RUNNING);
    CU_ASSERT(!seen.ready && !seen.no_broadcasts);
    mu_agent_decline_broadcasts(a);
    SPIN_UNTIL(&mind, seen.no_broadcasts);
    mu_agent_limit_box(a, MU_BOX_DROP_LOWEST, 7, 9000);
    SPIN_UNTIL(&mind, seen.box_mails == 7);
    CU_ASSERT_EQUAL(seen.box_bytes, 9000);
    CU_ASSERT_EQUAL(seen.full, muster_BOX_DROP_LOWEST);
    unsigned before = seen.registrations;
    SPIN_UNTIL(&mind, seen.registrations > before); /* a heartbeat */

    deliver_verdict(&mind, "red");
    CU_ASSERT_EQUAL(mu_process_await_broker(mind.process, PATIENCE_NS), MU_OK);
    CU_ASSERT_STRING_EQUAL(heard.at, "red welcome; ");
    CU_ASSERT_STRING_EQUAL(mu_process_broker(mind.process), "alpha");
}

static void test_mail_out_and_in(void)
{
    mu_agent *red = agent_find(mind.process, "red");
    uint64_t seq = 0;
    forget();
    CU_ASSERT_EQUAL(mu_agent_send(red, &(struct mu_mail){.dst = "blue", .content = "hello"}, &seq),
                    MU_OK);
    CU_ASSERT_EQUAL(seq, 1);
    SPIN_UNTIL(&mind, seen.mails == 1);
    CU_ASSERT_EQUAL(seen.step, muster_STEP_NOW);
    CU_ASSERT_EQUAL(seen.seq, 1);
    CU_ASSERT_STRING_EQUAL(seen.content, "hello");
    spin_for(&mind, 50000000);
    CU_ASSERT_EQUAL(seen.mails, 1);

    deliver_mail(&mind, muster_STEP_NOW, "red", 1);
    SPIN_UNTIL(&mind, seen.ack == 1);
    CU_ASSERT_STRING_EQUAL(heard.at, "red#1 blue hi; ");
}

static void test_mail_without_an_answer_goes_out_again(void)
{
    SPIN_UNTIL(&mind, seen.mails == 2); /* after a second */
    CU_ASSERT_EQUAL(seen.seq, 1);
    forget();
    muster_Receipt r = {
        .agent = words("red"), .first_seq = 1, .last_seq = 1, .result = muster_OUTCOME_DELIVERED};
    muster_Delivery d = delivery_to(&mind, muster_STEP_NOW);
    d.receipts._buffer = &r;
    d.receipts._length = d.receipts._maximum = 1;
    deliver(&mind, &d);
    SPIN_UNTIL(&mind, heard.len > 0);
    CU_ASSERT_STRING_EQUAL(heard.at, "red 1-1 delivered; ");
    const struct outbox *box = &agent_find(mind.process, "red")->outbox;
    CU_ASSERT_EQUAL(box->first_seq, box->next_seq);
}

static void on_end(void *self, uint64_t number, enum probe_end end, const char *text)
{
    (void)self;
    mu_text_format(&heard, "%llu %s %s; ", (unsigned long long)number,
                   glance_word((muster_GlanceWord)end), text);
}

static void test_glances_out_and_answers_in(void)
{
    mu_agent *red = agent_find(mind.process, "red");
    uint64_t number = 0;
    forget();
    probes_hear(red, on_end, NULL);
    CU_ASSERT_EQUAL(probes_ask(red, "robot", "(assert (a))", &number), MU_REFUSED);
    CU_ASSERT_EQUAL(probes_ask(red, "group:scouts", "(facts)", &number), MU_REFUSED);
    CU_ASSERT_EQUAL(probes_ask(red, "robot", "(facts)", &number), MU_OK);
    CU_ASSERT_EQUAL(number, 1);
    CU_ASSERT_EQUAL(probes_ask(red, "robot", "?*mate*", &number), MU_OK);
    SPIN_UNTIL(&mind, has(seen.glances, "red/2"));
    CU_ASSERT_STRING_EQUAL(seen.glances, "red/1 robot asks (facts); red/2 robot asks ?*mate*; ");
    deliver_glance(&mind, muster_GLANCE_DONE, "red", 1, "f-0");
    deliver_glance(&mind, muster_GLANCE_DONE, "red", 1, "f-0"); /* has its answer */
    deliver_glance(&mind, muster_GLANCE_FAILED, "red", 2, "no such");
    SPIN_UNTIL(&mind, has(heard.at, "2 failed"));
    CU_ASSERT_STRING_EQUAL(heard.at, "1 done f-0; 2 failed no such; ");
    CU_ASSERT_EQUAL(seen.mails, 0);
}

static void test_limit_glances_of_a_process(void)
{
    mu_agent *red = agent_find(mind.process, "red");
    uint64_t number = 0;
    forget();
    for (unsigned i = 0; i < MU_GLANCES_EACH; i++) {
        CU_ASSERT_EQUAL(probes_ask(red, "robot", "(facts)", &number), MU_OK);
    }
    CU_ASSERT_EQUAL(probes_ask(red, "robot", "(facts)", &number), MU_FULL);
    SPIN_UNTIL(&mind, has(seen.glances, "red/18"));
    deliver_glance(&mind, muster_GLANCE_DONE, "red", 5, "");
    SPIN_UNTIL(&mind, heard.len > 0);
    CU_ASSERT_EQUAL(probes_ask(red, "robot", "(facts)", &number), MU_OK);
    CU_ASSERT_EQUAL(number, 19);
    SPIN_UNTIL(&mind, has(seen.glances, "red/19"));
}

/* It knows nothing of them. */
static void probes_are_declined(void)
{
    CU_ASSERT_EQUAL(mind.process->probes.count, 0);
    CU_ASSERT_TRUE(has(heard.at, "19 declined ; "));
    mu_text_clear(&heard);
}

static void test_another_life_of_the_broker(void)
{
    uint64_t before = mind.process->incarnation;
    forget();
    shine(&mind, "alpha", 7, 2);
    SPIN_UNTIL(&mind, seen.registrations >= 1);
    CU_ASSERT_EQUAL(seen.incarnation, before); /* it keeps what it has for the agents */
    probes_are_declined();
    CU_ASSERT_PTR_NULL(mu_process_broker(mind.process));
    SPIN_UNTIL(&mind, seen.incarnation > before); /* it is asked again, as it does not answer */

    /* Mail waits for the answer, and what the earlier life says is not heard any more. */
    CU_ASSERT_EQUAL(mu_agent_send(agent_find(mind.process, "red"),
                                  &(struct mu_mail){.dst = "blue", .content = "new"}, NULL),
                    MU_OK);
    mind.process->link.incarnation = 5;
    muster_Delivery late = delivery_to(&mind, muster_STEP_NOW);
    mind.process->link.incarnation = 7;
    muster_Verdict old = {.agent = words("red"), .broker_incarnation = 5, .reason = words("no")};
    late.verdicts._buffer = &old;
    late.verdicts._length = late.verdicts._maximum = 1;
    deliver(&mind, &late);
    spin_for(&mind, 50000000);
    CU_ASSERT_EQUAL(seen.mails, 0);
    CU_ASSERT_STRING_EQUAL(heard.at, "");

    deliver_verdict(&mind, "red");
    SPIN_UNTIL(&mind, seen.mails == 1);
    CU_ASSERT_STRING_EQUAL(seen.content, "new");
    CU_ASSERT_STRING_EQUAL(heard.at, ""); /* it is welcome only once */
}

/* It hears of the process at once, and may write to it before its heartbeat is there. */
static void test_another_life_is_known_by_what_it_delivers(void)
{
    forget();
    muster_Delivery d = delivery_to(&mind, muster_STEP_NOW);
    muster_Verdict v = {
        .agent = words("red"), .accepted = true, .broker_incarnation = 9, .reason = words("")};
    d.verdicts._buffer = &v;
    d.verdicts._length = d.verdicts._maximum = 1;
    d.broker_incarnation = 9;
    d.broker = words("stranger");
    deliver(&mind, &d);
    spin_for(&mind, 20000000);
    CU_ASSERT_EQUAL(mind.process->broker_incarnation, 7);
    d.broker = words("alpha");
    deliver(&mind, &d);
    SPIN_UNTIL(&mind, mind.process->broker_incarnation == 9);
    CU_ASSERT_STRING_EQUAL(mu_process_broker(mind.process), "alpha");
    SPIN_UNTIL(&mind, seen.mails == 1); /* what had no answer goes out again */
    spin_for(&mind, 50000000);          /* the last heartbeat is of the earlier life */
    CU_ASSERT_EQUAL(mind.process->link.incarnation, 9);
}

static void test_a_silent_broker_is_left(void)
{
    /* The clock on the wall has been set back by an hour. */
    uint64_t before = mind.process->incarnation += 3600000000000u;
    forget();
    muster_Beacon gone = {.broker = words("alpha"), .host = words("")};
    bus_dispose(&mind.beacon, &gone);
    SPIN_UNTIL(&mind, strcmp(seen.broker, "beta") == 0);
    CU_ASSERT(seen.incarnation > before); /* it must answer, even if it knows the name */
    CU_ASSERT_PTR_NULL(mu_process_broker(mind.process));
    deliver_verdict(&mind, "red");
    SPIN_UNTIL(&mind, mu_process_broker(mind.process) != NULL);
    CU_ASSERT_STRING_EQUAL(mu_process_broker(mind.process), "beta");
    shine(&mind, "alpha", 8, 0); /* it stays, though this one would have been the first choice */
    spin_for(&mind, 50000000);
    CU_ASSERT_STRING_EQUAL(mu_process_broker(mind.process), "beta");

    gone.broker = words("alpha");
    bus_dispose(&mind.beacon, &gone);
    spin_for(&mind, 50000000);
    gone.broker = words("beta");
    bus_dispose(&mind.beacon, &gone);
    SPIN_UNTIL(&mind, mu_process_broker(mind.process) == NULL);
    CU_ASSERT_FALSE(mu_process_has_broker(mind.process));
    shine(&mind, "beta", 6, 3); /* the same one is heard of again */
    SPIN_UNTIL(&mind, mu_process_broker(mind.process) != NULL);
    CU_ASSERT_STRING_EQUAL(heard.at, "");
}

/* Else the program would run for ever. */
static void round_end(void *self)
{
    mu_process_stop(self);
}

static void test_running_ends_when_told(void)
{
    mu_process_stop(mind.process);
    CU_ASSERT_EQUAL(mu_process_run(mind.process), MU_OK);
    mind.process->stopped = false;
    mu_process_each_round(mind.process, round_end, mind.process);
    CU_ASSERT_EQUAL(mu_process_run(mind.process), MU_OK);
    mu_process_each_round(mind.process, NULL, NULL);
    mind.process->stopped = false;
    struct itimerspec soon = {.it_value = {.tv_nsec = 50000000}};
    struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGTERM};
    timer_t timer;
    /* mu_process_run catches the signal as soon as it begins. */
    CU_ASSERT_EQUAL_FATAL(timer_create(CLOCK_MONOTONIC, &event, &timer), 0);
    CU_ASSERT_EQUAL_FATAL(timer_settime(timer, 0, &soon, NULL), 0);
    CU_ASSERT_EQUAL(mu_process_run(mind.process), MU_OK);
    timer_delete(timer);
}

static void test_closing_takes_the_agents_back(void)
{
    mu_agent *red = agent_find(mind.process, "red");
    forget();
    CU_ASSERT_EQUAL_FATAL(
        bus_reader_open(&mind.process->bus, BUS_UP, "broker.beta", &mind.to_broker), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_send(red, &(struct mu_mail){.dst = "blue", .content = "bye"}, NULL),
                    MU_OK);
    mu_agent_set_state(red, MU_GONE);
    look(&mind);
    CU_ASSERT_NOT_EQUAL(seen.state, muster_STATE_ABSENT);
    SPIN_UNTIL(&mind, seen.state == muster_STATE_ABSENT);
    CU_ASSERT_STRING_EQUAL(seen.content, "bye");
    CU_ASSERT_EQUAL(seen.registrations_lost, 0);
    mu_process_close(mind.process);
    mu_process_close(NULL);
}

static void test_a_body_is_ready_when_all_have_matched(void)
{
    mu_agent *a = NULL;
    open_process(&body, 150 + (int)(getpid() % 50));
    forget();
    CU_ASSERT_EQUAL(mu_agent_join(body.process, &a, "robot", MU_KIND_ROBOT, 0, &handlers), MU_OK);
    spin_for(&body, 20000000);
    CU_ASSERT_EQUAL(seen.registrations, 0);
    open_peers(&body);
    shine(&body, "alpha", 5, 2);
    SPIN_UNTIL(&body, seen.registrations >= 1);
    CU_ASSERT_EQUAL(seen.state, muster_STATE_STANDBY);
    spin_for(&body, 50000000);
    CU_ASSERT_FALSE(seen.ready); /* the broker has not said yes */
    deliver_verdict(&body, "robot");
    CU_ASSERT_EQUAL(mu_process_await_broker(body.process, PATIENCE_NS), MU_OK);
    spin_for(&body, 50000000);
    CU_ASSERT_FALSE(seen.ready); /* the simulator has not greeted it */
    sense(&body, muster_STEP_NOW, false, false);
    SPIN_UNTIL(&body, seen.ready);
    mu_agent_set_state(a, MU_RUNNING);
    SPIN_UNTIL(&body, seen.state == muster_STATE_RUNNING);
}

static void test_free_running(void)
{
    forget();
    sense(&body, 10, false, false);
    SPIN_UNTIL(&body, seen.step == 10);
    CU_ASSERT_STRING_EQUAL(heard.at, "robot acts in 10; ");
    CU_ASSERT(seen.drives && seen.forward_m_s > 0.24 && seen.forward_m_s < 0.26);
    CU_ASSERT_EQUAL(seen.ups, 2); /* one sample, read by broker and simulator */

    /* Mail waits for the next step, unless none comes. */
    forget();
    deliver_mail(&body, muster_STEP_NOW, "robot", 1);
    spin_for(&body, 20000000);
    CU_ASSERT_STRING_EQUAL(heard.at, "");
    sense(&body, 11, false, false);
    SPIN_UNTIL(&body, seen.step == 11);
    CU_ASSERT_STRING_EQUAL(heard.at, "robot#1 blue hi; robot acts in 11; ");
    CU_ASSERT_EQUAL(seen.ack, 1);
    forget();
    deliver_mail(&body, muster_STEP_NOW, "robot", 2);
    SPIN_UNTIL(&body, seen.ack == 2);
    CU_ASSERT_STRING_EQUAL(heard.at, "robot#2 blue hi; ");
}

static enum probe_end on_look(void *self, const char *line, const char **text)
{
    (void)self;
    mu_text_format(&heard, "looks %s; ", line);
    *text = "f-0";
    return line[0] == '(' ? PROBE_DONE : PROBE_FAILED;
}

/* Who looks does not wait for the step that mail waits for. */
static void test_looks_pass_the_mail_that_waits(void)
{
    mu_agent *robot = agent_find(body.process, "robot");
    uint64_t number;
    forget();
    CU_ASSERT_EQUAL(probes_ask(robot, "robot", "(facts)", &number), MU_REFUSED);
    deliver_glance(&body, muster_GLANCE_ASK, "operator", 1, "(facts)");
    SPIN_UNTIL(&body, has(seen.glances, "operator/1 robot declined ; "));
    probes_answer(robot, on_look);
    sense(&body, 14, false, false);
    SPIN_UNTIL(&body, seen.step == 14);
    forget();
    for (uint64_t i = 3; i < 23; i++) {
        deliver_mail(&body, muster_STEP_NOW, "robot", i);
    }
    deliver_glance(&body, muster_GLANCE_ASK, "operator", 2, "(facts)");
    deliver_glance(&body, muster_GLANCE_ASK, "operator", 3, "?*mate*");
    SPIN_UNTIL(&body, has(seen.glances, "operator/3 robot failed f-0; "));
    CU_ASSERT_STRING_EQUAL(heard.at, "looks (facts); looks ?*mate*; ");
    sense(&body, 15, false, false);
    SPIN_UNTIL(&body, seen.step == 15);
    CU_ASSERT_EQUAL(seen.ack, 22);
    CU_ASSERT_TRUE(has(heard.at, "robot#3 blue hi; robot#4 blue hi; "));
    CU_ASSERT_TRUE(has(heard.at, "robot#22 blue hi; robot acts in 15; "));
    CU_ASSERT_EQUAL(seen.mails, 0);
}

/* The simulator counts the steps in which nobody has set a speed. */
static void test_a_speed_is_said_once(void)
{
    idle = true;
    forget();
    seen.drives = true;
    sense(&body, 16, false, false);
    SPIN_UNTIL(&body, seen.step == 16);
    CU_ASSERT_STRING_EQUAL(heard.at, "robot acts in 16; ");
    CU_ASSERT_FALSE(seen.drives);
    idle = false;
}

static void test_who_is_busy_says_so_meanwhile(void)
{
    forget();
    slow = true;
    sense(&body, 17, false, false);
    SPIN_UNTIL(&body, seen.step == 17);
    slow = false;
    CU_ASSERT_STRING_EQUAL(heard.at, "busy since; robot acts in 17; ");
    SPIN_UNTIL(&body, seen.reason[0] == '\0');
    process_work(body.process); /* no handler runs */
    CU_ASSERT_STRING_EQUAL(body.process->busy, "");
}

static void test_lock_step_waits_for_its_mail(void)
{
    forget();
    sense(&body, 21, true, false);
    spin_for(&body, 50000000);
    CU_ASSERT_EQUAL(seen.ups, 0);
    deliver_mail(&body, 20, "robot", 23);
    SPIN_UNTIL(&body, seen.ups == 2);
    CU_ASSERT_EQUAL(seen.step, 21);
    CU_ASSERT_STRING_EQUAL(heard.at, "robot#23 blue hi; robot acts in 21; ");
    CU_ASSERT_EQUAL(seen.ack, 23);

    forget(); /* the mail may come first */
    deliver_mail(&body, 21, "robot", 24);
    spin_for(&body, 20000000);
    CU_ASSERT_STRING_EQUAL(heard.at, "");
    sense(&body, 22, true, false);
    SPIN_UNTIL(&body, seen.ups == 2);
    CU_ASSERT_TRUE(mu_process_in_lockstep(body.process));
    CU_ASSERT_FALSE(mu_process_in_lockstep(mind.process));
    CU_ASSERT_EQUAL(seen.step, 22);
    CU_ASSERT_STRING_EQUAL(heard.at, "robot#24 blue hi; robot acts in 22; ");
    CU_ASSERT_EQUAL(mu_agent_broadcast(agent_find(body.process, "robot"), "later"), MU_OK);
    spin_for(&body, 20000000);
    CU_ASSERT_EQUAL(seen.mails, 0); /* goes out with the next step */
}

/* While the mail of a step is there, or its senses are, and the other is not. */
static void test_looks_fall_between_two_steps(void)
{
    forget();
    deliver_mail(&body, 22, "robot", 25);
    spin_for(&body, 20000000);
    deliver_glance(&body, muster_GLANCE_ASK, "operator", 4, "(facts)");
    SPIN_UNTIL(&body, has(seen.glances, "operator/4 robot done f-0; "));
    CU_ASSERT_STRING_EQUAL(heard.at, "looks (facts); ");
    CU_ASSERT_EQUAL(seen.mails, 0); /* what waits for the step still does */
    sense(&body, 23, true, false);
    SPIN_UNTIL(&body, seen.step == 23);
    CU_ASSERT_STRING_EQUAL(heard.at, "looks (facts); robot#25 blue hi; robot acts in 23; ");
    CU_ASSERT(seen.mails > 0);
    forget();
    sense(&body, 24, true, false);
    spin_for(&body, 20000000);
    deliver_glance(&body, muster_GLANCE_ASK, "operator", 5, "(facts)");
    SPIN_UNTIL(&body, has(seen.glances, "operator/5 robot done f-0; "));
    CU_ASSERT_STRING_EQUAL(heard.at, "looks (facts); ");
    deliver_glance(&body, muster_GLANCE_ASK, "operator", 6, "(rules)");
    deliver_mail(&body, 23, "robot", 26);
    deliver_glance(&body, muster_GLANCE_ASK, "operator", 7, "(agenda)");
    SPIN_UNTIL(&body, seen.step == 24 && has(seen.glances, "operator/7"));
    CU_ASSERT_TRUE(has(heard.at, "looks (rules); "));
    CU_ASSERT_TRUE(has(heard.at, "robot#26 blue hi; robot acts in 24; "));
}

/* Its simulator is gone, and nothing goes with it. */
static void test_mail_of_an_earlier_lock_step_is_dropped(void)
{
    forget();
    deliver_mail(&body, 5, "robot", 27);
    sense(&body, 25, true, false);
    spin_for(&body, 20000000);
    CU_ASSERT_STRING_EQUAL(heard.at, "");
    deliver_mail(&body, 24, "robot", 27);
    SPIN_UNTIL(&body, seen.ups == 2);
    CU_ASSERT_STRING_EQUAL(heard.at, "robot#27 blue hi; robot acts in 25; ");
}

static void test_who_watches_serves_the_next_run(void)
{
    body.process->role = PROCESS_WATCH;
    sense(&body, 26, true, true);
    SPIN_UNTIL(&body, !process_in_lockstep(body.process));
    CU_ASSERT_EQUAL(mu_process_spin(body.process, 0), MU_OK);
    body.process->role = PROCESS_BODY;
}

static void test_the_end_of_the_run(void)
{
    mu_result spun = MU_OK;
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    forget();
    sense(&body, 27, true, true);
    while (spun == MU_OK && mu_clock_ns() < until_ns) {
        spun = mu_process_spin(body.process, 2000000);
    }
    look(&body);
    CU_ASSERT_EQUAL(spun, MU_DONE);
    CU_ASSERT_STRING_EQUAL(heard.at, "");
    CU_ASSERT_EQUAL(mu_process_run(body.process), MU_OK);
    mu_process_close(body.process);
}

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    mu_text_init(&heard, heard_buffer, sizeof heard_buffer);
    alarm(60);
    return 0;
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"no broker answers", test_no_broker_answers},
        {"joining", test_joining},
        {"mail out and in", test_mail_out_and_in},
        {"mail without an answer goes out again", test_mail_without_an_answer_goes_out_again},
        {"glances out and answers in", test_glances_out_and_answers_in},
        {"limit: glances of a process", test_limit_glances_of_a_process},
        {"another life of the broker", test_another_life_of_the_broker},
        {"another life is known by what it delivers",
         test_another_life_is_known_by_what_it_delivers},
        {"a silent broker is left", test_a_silent_broker_is_left},
        {"running ends when told", test_running_ends_when_told},
        {"closing takes the agents back", test_closing_takes_the_agents_back},
        {"a body is ready when all have matched", test_a_body_is_ready_when_all_have_matched},
        {"free running", test_free_running},
        {"looks pass the mail that waits", test_looks_pass_the_mail_that_waits},
        {"a speed is said once", test_a_speed_is_said_once},
        {"who is busy says so meanwhile", test_who_is_busy_says_so_meanwhile},
        {"lock step waits for its mail", test_lock_step_waits_for_its_mail},
        {"looks fall between two steps", test_looks_fall_between_two_steps},
        {"mail of an earlier lock step", test_mail_of_an_earlier_lock_step_is_dropped},
        {"who watches serves the next run", test_who_watches_serves_the_next_run},
        {"the end of the run", test_the_end_of_the_run},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/process", begin, NULL, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
