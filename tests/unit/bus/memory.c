/* SPDX-License-Identifier: Apache-2.0 */
/* What others leave behind: a thousand writers' instances come and go, and a reader's memory stays
 * what it was. */
#include "bus/bus.h"
#include "core/clock.h"
#include "suite.h"
#include "wire.h"

#include <CUnit/Basic.h>
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    BATCH = 50,   /* instances that are there at the same time */
    WARM_UP = 10, /* batches, until what DDS keeps for the next sample is there */
    BATCHES = 20,
    GROWTH_BYTES = 64 * 1024,   /* of the heap; to keep 1,000 instances takes several times that */
    BUFFERS_FROM_BYTES = 65536, /* DDS's buffers for packets are larger, and are not counted */
};

static const uint64_t PATIENCE_NS = 10000000000u;
static const int64_t WAIT_NS = 5000000;

static struct bus bus; /* static: DDS keeps pointers into it */
static struct bus_reader registrations;
static pid_t other;
static int go[2]; /* a byte each: the other process is to write a batch */

static int domain(void)
{
    return 100 + (int)(getpid() % 100);
}

/* Half of its instances are taken back, and half are left without a word. */
static bool batch_write(int batch)
{
    struct bus_writer writer;
    bool written = bus_writer_open(&bus, BUS_REGISTRATION, NULL, NULL, &writer) == MU_OK;
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (written && bus_writer_matches(&writer) == 0 && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, WAIT_NS);
    }
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < BATCH; i++) {
            char process[32], broker[] = "b1", host[] = "here";
            snprintf(process, sizeof process, "p%d-%d", batch, i);
            muster_Registration r = {
                .wire = muster_WIRE, .process = process, .broker = broker, .host = host};
            if (pass == 0) {
                written = bus_write(&writer, &r) == MU_OK && written;
            } else if (i % 2 == 0) {
                bus_dispose(&writer, &r);
            }
        }
        written = bus_drain(&writer, (int64_t)PATIENCE_NS) && written;
    }
    bus_writer_close(&writer);
    return written;
}

static void other_run(int parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    struct bus_options options = {.domain = parent, .place = BUS_SIMULATOR, .name = "other"};
    char next;
    bool written = bus_open(&bus, &options) == MU_OK;
    for (int batch = 0; written && read(go[0], &next, 1) == 1; batch++) {
        written = batch_write(batch);
    }
    _exit(!written);
}

/* Starts before this process touches DDS, which does not survive a fork. */
static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    mallopt(M_MMAP_THRESHOLD, BUFFERS_FROM_BYTES);
    if (pipe(go) != 0) {
        return 1;
    }
    int own = domain();
    other = fork();
    if (other == 0) {
        close(go[1]);
        other_run(own);
    }
    close(go[0]);
    struct bus_options options = {.domain = own, .place = BUS_AGENT, .name = "test"};
    return bus_open(&bus, &options) != MU_OK ||
           bus_reader_open(&bus, BUS_REGISTRATION, NULL, &registrations) != MU_OK;
}

static int end(void)
{
    int status = 0;
    close(go[1]);
    bool ended = waitpid(other, &status, 0) == other && status == 0;
    bus_close(&bus);
    return !ended;
}

/* @return whether all instances of a batch came and went */
static bool batch_take(void)
{
    int ended = 0;
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (ended < BATCH && mu_clock_ns() < until_ns) {
        enum bus_life life;
        while (bus_next(&registrations, &life)) {
            ended += life != BUS_DATA;
        }
        bus_wait(&bus, 1, WAIT_NS);
    }
    return ended == BATCH;
}

/* The heap in use when that many batches more have come and gone. */
static int64_t batches_pass(int count)
{
    for (int i = 0; i < count; i++) {
        CU_ASSERT_EQUAL_FATAL(write(go[1], "", 1), 1);
        CU_ASSERT_TRUE_FATAL(batch_take());
    }
    bus_wait(&bus, 1, 100000000); /* what is freed is freed by a thread of DDS */
    return (int64_t)mallinfo2().uordblks;
}

static void test_instances_come_and_go(void)
{
    int64_t before = batches_pass(WARM_UP);
    int64_t grown = batches_pass(BATCHES) - before;
    CU_ASSERT(grown < GROWTH_BYTES);
    if (grown >= GROWTH_BYTES) {
        fprintf(stderr, "%lld bytes more after %d instances\n", (long long)grown, BATCHES * BATCH);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"instances come and go", test_instances_come_and_go},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"bus/memory", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
