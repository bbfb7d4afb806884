/* SPDX-License-Identifier: Apache-2.0 */
/* A process that turns from one life of its broker to the next, or from one lock step, with the
 * samples of both unread: this test is the others, in the participant of the process. */
#include "../support/samples.h"
#include "../support/suite.h"
#include "core/clock.h"
#include "runtime/process.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 10000000000u;

static mu_process *process;
static mu_agent *red;
static struct bus_writer beacons, deliveries, senses;
static int64_t lived;  /* the last step */
static uint64_t taken; /* the last mail, in lock step */

static void shine(uint64_t incarnation)
{
    muster_Beacon b = {.broker = words("alpha"),
                       .incarnation = incarnation,
                       .host = words("elsewhere"),
                       .takes_agents = true};
    CU_ASSERT_EQUAL_FATAL(bus_write(&beacons, &b), MU_OK);
}

static void deliver_at(int64_t step, uint64_t incarnation, muster_Verdict *v, muster_Parcel *parcel)
{
    muster_Delivery d = {.process = words(process->name),
                         .broker = words("alpha"),
                         .broker_incarnation = incarnation,
                         .step = step};
    d.verdicts._buffer = v;
    d.verdicts._length = d.verdicts._maximum = v != NULL;
    d.parcels._buffer = parcel;
    d.parcels._length = d.parcels._maximum = parcel != NULL;
    CU_ASSERT_EQUAL_FATAL(bus_write(&deliveries, &d), MU_OK);
}

static void deliver(uint64_t incarnation, muster_Verdict *v, muster_Parcel *parcel)
{
    deliver_at(muster_STEP_NOW, incarnation, v, parcel);
}

static void deliver_in_step(int64_t step, uint64_t number)
{
    muster_Parcel parcel = {
        .box = words("red"), .number = number, .letter = letter("blue", number, "red", "short")};
    deliver_at(step, 5, NULL, &parcel);
}

static void sense(int64_t step)
{
    muster_Percept percept = {.robot = words("red")};
    muster_Sense s = {.process = words(process->name), .step = step, .lockstep = true};
    s.robots._buffer = &percept;
    s.robots._length = s.robots._maximum = 1;
    CU_ASSERT_EQUAL_FATAL(bus_write(&senses, &s), MU_OK);
}

static void answer(uint64_t incarnation)
{
    muster_Verdict v = {.agent = words("red"),
                        .accepted = true,
                        .broker_incarnation = incarnation,
                        .reason = words("")};
    deliver(incarnation, &v, NULL);
}

/* While it runs the broker dies and comes back. */
static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    if (mu_process_in_lockstep(process)) {
        taken = mail->number;
        return;
    }
    shine(5);
    answer(10);
    usleep(20000);
}

static void on_step(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    (void)a;
    lived = percept->step;
}

static void spin(int rounds)
{
    for (int i = 0; i < rounds; i++) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
}

static bool spin_until_it_follows(uint64_t incarnation)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (process->link.incarnation != incarnation && mu_clock_ns() < until_ns) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
    return process->link.incarnation == incarnation;
}

static void begin(void)
{
    struct mu_process_options options = {
        .domain = 100 + (int)(getpid() % 100), .name = "turning", .with_body = true};
    CU_ASSERT_EQUAL_FATAL(mu_process_open(&process, &options), MU_OK);
    struct mu_handlers handlers = {.on_mail = on_mail, .on_step = on_step};
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &red, "red", MU_KIND_AGENT, 0, &handlers), MU_OK);
    struct bus *bus = &process->bus;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_BEACON, NULL, NULL, &beacons), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_DELIVERY, process->name, NULL, &deliveries),
                          MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_SENSE, process->name, NULL, &senses), MU_OK);
    shine(5);
    CU_ASSERT_TRUE_FATAL(spin_until_it_follows(5));
    answer(5);
    while (!red->registered) {
        CU_ASSERT_EQUAL_FATAL(mu_process_spin(process, 10000000), MU_OK);
    }
}

/* The last heartbeat of the earlier life is read behind the answer of the next one, which it gives
 * once: the process asks again, or mail would wait for ever. */
static void test_a_late_heartbeat_of_the_earlier_life(void)
{
    begin();
    uint64_t asked = process->incarnation;
    muster_Parcel parcel = {
        .box = words("red"), .number = 1, .letter = letter("blue", 1, "red", "long")};
    deliver(5, NULL, &parcel);
    spin(20);
    shine(10);
    CU_ASSERT_TRUE(spin_until_it_follows(10));
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (!red->registered && process->incarnation == asked && mu_clock_ns() < until_ns) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
    CU_ASSERT_TRUE(red->registered || process->incarnation > asked);
    mu_process_close(process);
}

static bool spin_until_it_lived(int64_t step)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (lived != step && mu_clock_ns() < until_ns) {
        spin(1);
    }
    return lived == step;
}

/* Simulator and broker died before the mail of the last step was out, and what comes next is of
 * another lock step: its mail first, or its step. */
static void test_a_step_whose_mail_never_comes(void)
{
    begin();
    sense(30);
    spin(3);
    deliver_in_step(3, 1);
    spin(3);
    CU_ASSERT_EQUAL(lived, 0);
    sense(4);
    CU_ASSERT_TRUE(spin_until_it_lived(4));
    CU_ASSERT_EQUAL(taken, 1);
    sense(30);
    spin(3);
    sense(5);
    deliver_in_step(4, 2);
    CU_ASSERT_TRUE(spin_until_it_lived(5));
    CU_ASSERT_EQUAL(taken, 2);
    mu_process_close(process);
}

int main(void)
{
    unsetenv("CYCLONEDDS_URI");
    CU_TestInfo tests[] = {
        {"a late heartbeat", test_a_late_heartbeat_of_the_earlier_life},
        {"a step without mail", test_a_step_whose_mail_never_comes},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/turn", tests);
}
