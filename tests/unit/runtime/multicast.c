/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A process that does not look for a while, and what of mail to many it finds then.  This test is
 * its broker: the writers share the participant of the process under test.
 */
#include "core/clock.h"
#include "runtime/process.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;
static const uint64_t INCARNATION = 5;

enum { SEAT = 7, STRANGER = 3 };

static mu_process *process;
static struct bus_writer delivery, multicasts, beacon;
static uint64_t serial; /* of the last Delivery to the process */

static struct {
    uint32_t mails;
    uint64_t last; /* number; */
    bool gap;      /* and whether one was missing before one of them */
    const mu_agent *by;
} heard;

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    heard.gap = heard.gap || (heard.mails > 0 && mail->number != heard.last + 1);
    heard.mails++;
    heard.last = mail->number;
    heard.by = a;
}

static const struct mu_handlers handlers = {.on_mail = on_mail};

static void spin_for(uint64_t ns)
{
    uint64_t until_ns = mu_clock_ns() + ns;
    do {
        CU_ASSERT_EQUAL_FATAL(mu_process_spin(process, 2000000), MU_OK);
    } while (mu_clock_ns() < until_ns);
}

#define SPIN_UNTIL(condition)                              \
    do {                                                   \
        uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;   \
        while (!(condition) && mu_clock_ns() < until_ns) { \
            spin_for(0);                                   \
        }                                                  \
        CU_ASSERT_TRUE_FATAL(condition);                   \
    } while (0)

static muster_Delivery delivery_begin(const char *partition)
{
    return (muster_Delivery){.process = words(partition),
                             .broker = words("alpha"),
                             .broker_incarnation = INCARNATION,
                             .step = muster_STEP_NOW};
}

/* A Delivery to the process alone. */
static void deliver(muster_Delivery *d)
{
    d->seat = SEAT;
    d->serial = ++serial;
    CU_ASSERT_EQUAL_FATAL(bus_write(&delivery, d), MU_OK);
}

static void deliver_verdict(const char *agent)
{
    muster_Verdict v = {.agent = words(agent),
                        .accepted = true,
                        .broker_incarnation = INCARNATION,
                        .reason = words("")};
    muster_Delivery d = delivery_begin(process->name);
    d.verdicts._buffer = &v;
    d.verdicts._length = d.verdicts._maximum = 1;
    deliver(&d);
}

static void deliver_mail(const char *agent, uint64_t number)
{
    muster_Parcel item = {
        .box = words(agent), .number = number, .letter = letter("blue", number, agent, "hi")};
    muster_Delivery d = delivery_begin(process->name);
    d.parcels._buffer = &item;
    d.parcels._length = d.parcels._maximum = 1;
    deliver(&d);
}

/* One letter to a stranger, and to the process's first agent. */
static void circulate(uint64_t at, uint64_t number)
{
    uint32_t seats[] = {STRANGER, SEAT}, slots[] = {0, 0};
    uint64_t serials[] = {9, at}, numbers[] = {4, number};
    muster_Mail mail = letter("blue", number, "all", "hi");
    muster_Delivery d = delivery_begin(BUS_TO_ALL);
    d.seats = (dds_sequence_unsigned_long){._length = 2, ._maximum = 2, ._buffer = seats};
    d.slots = (dds_sequence_unsigned_long){._length = 2, ._maximum = 2, ._buffer = slots};
    d.serials = (dds_sequence_unsigned_long_long){._length = 2, ._maximum = 2, ._buffer = serials};
    d.numbers = (dds_sequence_unsigned_long_long){._length = 2, ._maximum = 2, ._buffer = numbers};
    d.letters._buffer = &mail;
    d.letters._length = d.letters._maximum = 1;
    CU_ASSERT_EQUAL_FATAL(bus_write(&multicasts, &d), MU_OK);
}

static void test_joining(void)
{
    struct mu_process_options options = {
        .domain = 150 + (int)(getpid() % 50), .name = "test", .agents = 1};
    mu_agent *red = NULL;
    CU_ASSERT_EQUAL_FATAL(mu_process_open(&process, &options), MU_OK);
    struct bus *bus = &process->bus;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_BEACON, NULL, NULL, &beacon), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_DELIVERY, BUS_TO_ALL, NULL, &multicasts), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &red, "red", MU_KIND_AGENT, 0, &handlers), MU_OK);
    muster_Beacon b = {.broker = words("alpha"),
                       .incarnation = INCARNATION,
                       .host = words("elsewhere"),
                       .takes_agents = true};
    CU_ASSERT_EQUAL_FATAL(bus_write(&beacon, &b), MU_OK);
    SPIN_UNTIL(process->link.broker[0]);
    CU_ASSERT_FALSE(mu_process_has_broker(process)); /* which writes to all, and not to it yet */
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_DELIVERY, process->name, NULL, &delivery),
                          MU_OK);
    deliver_verdict("red");
    deliver_mail("red", 1);
    SPIN_UNTIL(heard.mails == 1);
    CU_ASSERT_TRUE(mu_process_has_broker(process));
}

/* More of each way than wait at a time, and each behind some of the other. */
static void test_a_backlog_is_handled_in_order(void)
{
    uint64_t number = 1;
    uint32_t before = heard.mails;
    for (int part = 0; part < 3; part++) {
        for (int i = 0; i < 2 * INBOX_EACH; i++) {
            circulate(++serial, ++number);
        }
        deliver_mail("red", ++number);
    }
    SPIN_UNTIL(heard.last == number);
    CU_ASSERT_FALSE(heard.gap);
    CU_ASSERT_EQUAL(heard.mails - before, 3 * (2 * INBOX_EACH + 1));
}

static void test_limit_who_does_not_look_keeps_the_last_ones(void)
{
    enum { MORE = 200 };
    uint64_t number = heard.last;
    heard.mails = 0;
    for (int i = 0; i < INBOX_DEPTH + MORE; i++) {
        circulate(++serial, ++number);
    }
    deliver_mail("red", number + 1); /* which can only be the next one if none was lost */
    spin_for(300000000);
    CU_ASSERT_EQUAL(heard.mails, 0);
    for (uint64_t again = heard.last + 1; again <= number + 1; again++) {
        deliver_mail("red", again);
    }
    SPIN_UNTIL(heard.last == number + 1);
    CU_ASSERT_FALSE(heard.gap);
}

/* The process has one slot.  What was written while red had it is not green's. */
static void test_mail_for_an_earlier_tenant_of_a_slot(void)
{
    mu_agent *green = NULL;
    mu_agent_leave(agent_find(process, "red"));
    spin_for(20000000);
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &green, "green", MU_KIND_AGENT, 0, &handlers),
                          MU_OK);
    heard.mails = 0;
    circulate(++serial, heard.last + 1);
    spin_for(50000000);
    uint64_t late = ++serial;
    deliver_verdict("green");
    spin_for(200000000); /* it goes on without the one that is late */
    circulate(late, heard.last + 2);
    spin_for(50000000);
    CU_ASSERT_EQUAL(heard.mails, 0);
    CU_ASSERT_EQUAL(green->last_number, 0);
    deliver_mail("green", 1);
    circulate(++serial, 2);
    SPIN_UNTIL(heard.mails == 2);
    CU_ASSERT_PTR_EQUAL(heard.by, green);
    mu_process_close(process);
}

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    return 0;
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"joining", test_joining},
        {"a backlog is handled in order", test_a_backlog_is_handled_in_order},
        {"limit: who does not look keeps the last ones",
         test_limit_who_does_not_look_keeps_the_last_ones},
        {"mail for an earlier tenant of a slot", test_mail_for_an_earlier_tenant_of_a_slot},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/multicast", begin, NULL, NULL, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
