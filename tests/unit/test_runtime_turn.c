/* SPDX-License-Identifier: Apache-2.0 */
/* A process that turns from one life of its broker to the next, with the samples of both unread:
 * this test is the broker, in the participant of the process. */
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
static struct bus_writer beacons, deliveries;

static void shine(uint64_t incarnation)
{
    muster_Beacon b = {.broker = words("alpha"),
                       .incarnation = incarnation,
                       .host = words("elsewhere"),
                       .takes_agents = true};
    CU_ASSERT_EQUAL_FATAL(bus_write(&beacons, &b), MU_OK);
}

static void deliver(uint64_t incarnation, muster_Verdict *v, muster_Parcel *parcel)
{
    muster_Delivery d = {.process = words(process->name),
                         .broker = words("alpha"),
                         .broker_incarnation = incarnation,
                         .step = muster_STEP_NOW};
    d.verdicts._buffer = v;
    d.verdicts._length = d.verdicts._maximum = v != NULL;
    d.parcels._buffer = parcel;
    d.parcels._length = d.parcels._maximum = parcel != NULL;
    CU_ASSERT_EQUAL_FATAL(bus_write(&deliveries, &d), MU_OK);
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
    (void)mail;
    shine(5);
    answer(10);
    usleep(20000);
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
    struct mu_process_options options = {.domain = 100 + (int)(getpid() % 100), .name = "turning"};
    CU_ASSERT_EQUAL_FATAL(mu_process_open(&process, &options), MU_OK);
    struct mu_handlers handlers = {.on_mail = on_mail};
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &red, "red", MU_KIND_AGENT, 0, &handlers), MU_OK);
    struct bus *bus = &process->bus;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_BEACON, NULL, NULL, &beacons), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(bus, BUS_DELIVERY, process->name, NULL, &deliveries),
                          MU_OK);
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
    for (int i = 0; i < 20; i++) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
    shine(10);
    CU_ASSERT_TRUE(spin_until_it_follows(10));
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (!red->registered && process->incarnation == asked && mu_clock_ns() < until_ns) {
        CU_ASSERT_EQUAL(mu_process_spin(process, 10000000), MU_OK);
    }
    CU_ASSERT_TRUE(red->registered || process->incarnation > asked);
    mu_process_close(process);
}

int main(void)
{
    unsetenv("CYCLONEDDS_URI");
    CU_TestInfo tests[] = {
        {"a late heartbeat", test_a_late_heartbeat_of_the_earlier_life},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/turn", tests);
}
