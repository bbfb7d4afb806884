/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The network, on loopback: readers and writers of one participant, and another process that holds
 * the simulator's place.
 */
#include "bus/bus.h"
#include "bus/raw/raw.h"
#include "core/clock.h"
#include "hush.h"
#include "muster/limits.h"
#include "samples.h"
#include "suite.h"
#include "wire.h"

#include <arpa/inet.h>
#include <CUnit/Basic.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;
static const int64_t WAIT_NS = 5000000;

static struct bus bus; /* static: DDS keeps pointers into it */
static pid_t holder;   /* of the simulator's place */

static int domain(void)
{
    return 100 + (int)(getpid() % 100);
}

/* Starts before this process touches DDS, which does not survive a fork. */
static int begin(void)
{
    int ends[2];
    char up = 0;
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    struct bus_options options = {.domain = domain(), .place = BUS_SIMULATOR, .name = "holder"};
    if (pipe(ends) != 0) {
        return 1;
    }
    holder = fork();
    if (holder == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        up = bus_open(&bus, &options) == MU_OK;
        ssize_t written = write(ends[1], &up, 1);
        (void)written;
        pause();
        _exit(0);
    }
    close(ends[1]);
    ssize_t got = read(ends[0], &up, 1);
    close(ends[0]);
    return got != 1 || !up;
}

static int end(void)
{
    kill(holder, SIGKILL);
    return waitpid(holder, NULL, 0) != holder;
}

/* Takes the port of an index.  @return a socket, or -1: somebody has it */
static int index_hold(int index)
{
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_port = htons((uint16_t)bus_port(domain(), index)),
                                  .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (bind(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        close(fd);
        return -1;
    }
    return fd;
}

static void test_a_place_is_taken_once(void)
{
    struct bus_options options = {.domain = domain(), .place = BUS_SIMULATOR, .name = "test"};
    CU_ASSERT_EQUAL(bus_open(&bus, &options), MU_BUSY);
    /* Of the 109 for agents this process begins to look at one of its own. */
    int begin = getpid() % 109;
    int first = index_hold(10 + begin), second = index_hold(10 + (begin + 1) % 109);
    CU_ASSERT_TRUE_FATAL(first >= 0 && second >= 0);
    options.place = BUS_AGENT;
    CU_ASSERT_EQUAL_FATAL(bus_open(&bus, &options), MU_OK);
    CU_ASSERT_EQUAL(bus.index, 10 + (begin + 2) % 109); /* the first that was free */
    close(first);
    close(second);
}

static bool await(struct bus_reader *reader, const void **sample, enum bus_life *life)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (!(*sample = bus_next(reader, life)) && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, WAIT_NS);
    }
    return *sample != NULL;
}

static muster_Delivery delivery(int64_t step)
{
    return (muster_Delivery){.process = words("p1"), .step = step};
}

/* Expects deliveries of these steps, in this order. */
static void expect_steps(struct bus_reader *reader, int64_t first, int64_t last)
{
    for (int64_t step = first; step <= last; step++) {
        const void *sample;
        enum bus_life life;
        CU_ASSERT_TRUE_FATAL(await(reader, &sample, &life));
        CU_ASSERT_EQUAL_FATAL(life, BUS_DATA);
        CU_ASSERT_EQUAL_FATAL(((const muster_Delivery *)sample)->step, step);
    }
}

static void expect_nothing(struct bus_reader *reader)
{
    enum bus_life life;
    bus_wait(&bus, 1, 30000000);
    CU_ASSERT_PTR_NULL(bus_next(reader, &life));
}

static struct bus_reader to_p1, to_p2;
static struct bus_writer writer;

static void test_partitions_are_apart(void)
{
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_DELIVERY, "p1", &to_p1), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_DELIVERY, "p2", &to_p2), MU_OK);
    CU_ASSERT_EQUAL(bus_reader_matches(&to_p1), 0);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, "p1", NULL, &writer), MU_OK);
    CU_ASSERT_EQUAL(bus_writer_matches(&writer), 1);
    CU_ASSERT_EQUAL(bus_reader_matches(&to_p1), 1);
    CU_ASSERT_EQUAL(bus_reader_matches(&to_p2), 0);
    muster_Delivery d = delivery(1);
    CU_ASSERT_EQUAL(bus_write(&writer, &d), MU_OK);
    expect_steps(&to_p1, 1, 1);
    expect_nothing(&to_p2);
}

static void test_one_writer_into_two_partitions(void)
{
    struct bus_writer both;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, "p1", "p2", &both), MU_OK);
    CU_ASSERT_EQUAL(bus_writer_matches(&both), 2);
    muster_Delivery d = delivery(2);
    CU_ASSERT_EQUAL(bus_write(&both, &d), MU_OK);
    CU_ASSERT_TRUE(bus_drain(&both, (int64_t)PATIENCE_NS));
    expect_steps(&to_p1, 2, 2);
    expect_steps(&to_p2, 2, 2);
    bus_writer_close(&both);
    bus_writer_close(&both); /* closed already */
    CU_ASSERT_EQUAL(bus_reader_matches(&to_p2), 0);
    const void *sample;
    enum bus_life life;
    CU_ASSERT_TRUE(await(&to_p2, &sample, &life));
    CU_ASSERT_EQUAL(life, BUS_LOST);
}

static void partition_write(const struct bus_writer *to, int64_t step)
{
    muster_Delivery d = delivery(step);
    CU_ASSERT_EQUAL(bus_write(to, &d), MU_OK);
}

/* Takes what the ends of writers have left. */
static void reader_empty(struct bus_reader *reader)
{
    enum bus_life life;
    while (bus_next(reader, &life)) {
        CU_ASSERT_NOT_EQUAL(life, BUS_DATA);
    }
}

/* A process reads its own partition and everybody's. */
static void test_writers_share_a_process(void)
{
    static struct bus_reader own, everybodys;
    struct bus_writer to_all, to_p3, to_p4;
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_DELIVERY, "p3", &own), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, BUS_TO_ALL, NULL, &to_all), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, "p3", NULL, &to_p3), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, "p4", NULL, &to_p4), MU_OK);
    CU_ASSERT_FALSE(bus_writer_shares(&to_p3, "p3", &to_all));
    CU_ASSERT_EQUAL_FATAL(bus_reader_open_deep(&bus, BUS_DELIVERY, BUS_TO_ALL, 8, &everybodys),
                          MU_OK);
    CU_ASSERT_TRUE(bus_writer_shares(&to_p3, "p3", &to_all));
    CU_ASSERT_FALSE(bus_writer_shares(&to_p4, "p4", &to_all));
    CU_ASSERT_FALSE(bus_writer_shares(&to_p3, "p4", &to_all)); /* it reaches nobody there */
    CU_ASSERT_FALSE(bus_writer_shares(&to_p3, "p3", &to_p4));
    partition_write(&to_p3, 1);
    expect_steps(&own, 1, 1);
    partition_write(&to_all, 2);
    expect_steps(&everybodys, 2, 2);
    expect_nothing(&own);
    bus_writer_close(&to_all);
    CU_ASSERT_FALSE(bus_writer_shares(&to_p3, "p3", &to_all));
    bus_writer_close(&to_p3);
    bus_writer_close(&to_p4);
    reader_empty(&own);
    reader_empty(&everybodys);
}

/* More than one batch, all of them kept. */
static void test_batches_in_order(void)
{
    enum { COUNT = 5 * BUS_BATCH + 3 };
    for (int64_t step = 0; step < COUNT; step++) {
        muster_Delivery d = delivery(step);
        CU_ASSERT_EQUAL_FATAL(bus_write(&writer, &d), MU_OK);
    }
    expect_steps(&to_p1, 0, COUNT - 1);
    expect_nothing(&to_p1);
}

static void test_what_breaks_a_rule_is_dropped_and_counted(void)
{
    muster_Receipt receipt = {.agent = words("no name")};
    muster_Delivery bad = delivery(2);
    bad.receipts._buffer = &receipt;
    bad.receipts._length = bad.receipts._maximum = 1;
    CU_ASSERT_EQUAL(bus.malformed, 0);
    for (int64_t step = 1; step <= 3; step++) {
        muster_Delivery d = delivery(step);
        CU_ASSERT_EQUAL(bus_write(&writer, step == 2 ? &bad : &d), MU_OK);
    }
    expect_steps(&to_p1, 1, 1);
    expect_steps(&to_p1, 3, 3);
    CU_ASSERT_EQUAL(bus.malformed, 1);
}

static void test_waiting(void)
{
    expect_nothing(&to_p1);
    expect_nothing(&to_p2);
    uint64_t began_ns = mu_clock_ns();
    bus_wait(&bus, 1, -1);
    bus_wait(&bus, 1, 0);
    CU_ASSERT(mu_clock_ns() - began_ns < PATIENCE_NS);
    began_ns = mu_clock_ns();
    bus_wait(&bus, 1, 20000000);
    CU_ASSERT(mu_clock_ns() - began_ns >= 20000000);
    /* Two samples that are there end a wait for two, and not one for three. */
    for (int64_t step = 1; step <= 2; step++) {
        muster_Delivery d = delivery(step);
        CU_ASSERT_EQUAL(bus_write(&writer, &d), MU_OK);
    }
    began_ns = mu_clock_ns();
    bus_wait(&bus, 2, (int64_t)PATIENCE_NS);
    CU_ASSERT(mu_clock_ns() - began_ns < PATIENCE_NS);
    began_ns = mu_clock_ns();
    bus_wait(&bus, 3, 20000000);
    CU_ASSERT(mu_clock_ns() - began_ns >= 20000000);
    expect_steps(&to_p1, 1, 2);
}

static uint64_t thread_used_ns(void)
{
    struct timespec used;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return (uint64_t)used.tv_sec * 1000000000 + (uint64_t)used.tv_nsec;
}

/* @return the processor time of a wait that brings nothing */
static uint64_t vain_wait_used_ns(int64_t timeout_ns)
{
    uint64_t before_ns = thread_used_ns();
    CU_ASSERT_FALSE(bus_wait(&bus, 2, timeout_ns));
    return thread_used_ns() - before_ns;
}

/* @return in how many waits of 20 us, which bring nothing, this thread has left the processor */
static long sleeps_in_short_waits(int count)
{
    struct rusage before, after;
    getrusage(RUSAGE_THREAD, &before);
    for (int i = 0; i < count; i++) {
        bus.usual_ns = bus.rested_ns = 0; /* whatever else runs here */
        CU_ASSERT_FALSE(bus_wait(&bus, 2, 20000));
    }
    getrusage(RUSAGE_THREAD, &after);
    return after.ru_nvcsw - before.ru_nvcsw;
}

/* With a sample there a wait for one takes no time, and one for two is in vain. */
static void test_waits_that_are_short_stay_awake_for_a_moment(void)
{
    enum { MANY = 60 };
    static const uint64_t SOON_NS = 80000, REST_NS = 200000000;
    expect_nothing(&to_p1);
    muster_Delivery d = delivery(1);
    CU_ASSERT_EQUAL(bus_write(&writer, &d), MU_OK);
    CU_ASSERT_TRUE(bus_wait(&bus, 1, (int64_t)PATIENCE_NS));
    for (int i = 0; i < MANY; i++) { /* in vain, and asleep */
        CU_ASSERT_FALSE(bus_wait(&bus, 2, 1000000));
    }
    CU_ASSERT(bus.usual_ns > SOON_NS);
    for (int i = 0; i < MANY; i++) {
        CU_ASSERT_TRUE(bus_wait(&bus, 1, (int64_t)PATIENCE_NS));
    }
    CU_ASSERT(bus.usual_ns < SOON_NS);
    CU_ASSERT(sleeps_in_short_waits(MANY) < MANY / 2);
    CU_ASSERT(vain_wait_used_ns((int64_t)REST_NS) < REST_NS / 2); /* awake for a part of it */
    for (int i = 0; i < MANY; i++) {
        CU_ASSERT_FALSE(bus_wait(&bus, 2, 1000000));
    }
    CU_ASSERT(bus.usual_ns > SOON_NS);
    expect_steps(&to_p1, 1, 1);
}

static bool is_readable(int fd, int timeout_ms)
{
    struct pollfd wake = {.fd = fd, .events = POLLIN};
    return poll(&wake, 1, timeout_ms) == 1;
}

static void test_a_descriptor_wakes_a_poll_loop(void)
{
    expect_nothing(&to_p1);
    int fd = bus_wake_fd(&bus);
    CU_ASSERT_FATAL(fd >= 0);
    CU_ASSERT_EQUAL(bus_wake_fd(&bus), fd);
    bus_wait(&bus, 1, 0);
    CU_ASSERT_FALSE(is_readable(fd, 0));
    muster_Delivery d = delivery(1);
    CU_ASSERT_EQUAL(bus_write(&writer, &d), MU_OK);
    CU_ASSERT_TRUE(is_readable(fd, 5000));
    bus_wait(&bus, 1, 0);
    CU_ASSERT_FALSE(is_readable(fd, 0)); /* told once, although the sample is still there */
    expect_steps(&to_p1, 1, 1);
}

/* Bytes as another program would read them: CDR by hand (RTPS 2.2, 10.2). */
static void test_samples_as_bytes(void)
{
    static const unsigned char wanted[] = {
        0,   1, 0, 0,                       /* CDR, little-endian, no options */
        3,   0, 0, 0, 'b', '1', 0,          /* a string has its zero, */
        0,                                  /* and the next length stands at a multiple of 4 */
        2,   0, 0, 0, 'k', 0,   0, 0,       /**/
        1,   0, 0, 0, 0,   0,   0, 0,       /**/
        2,   0, 0, 0, 's', 0,               /* ends at 30: 8 bytes stand at a multiple of 8 */
        0,   0, 7, 0, 0,   0,   0, 0, 0, 0, /**/
        255, 1, 0, 0, 0,   0,   0, 0};
    struct bus_bytes bytes = {0};
    muster_BrokerEvent event = {.broker = words("b1"),
                                .kind = words("k"),
                                .agent = words(""),
                                .sender = words("s"),
                                .count = 7,
                                .wall_ns = 511};
    static char longer[10000];
    memset(longer, 'x', sizeof longer - 1);
    for (unsigned round = 0; round < 2; round++) {
        CU_ASSERT_EQUAL(bus_encode(BUS_BROKER_EVENT, &event, &bytes), MU_OK);
        CU_ASSERT_EQUAL_FATAL(bytes.size, sizeof wanted);
        CU_ASSERT_EQUAL(memcmp(bytes.data, wanted, sizeof wanted), 0);
        event.kind = longer; /* the room grows, and the first sample is the same in it */
        CU_ASSERT_EQUAL(bus_encode(BUS_BROKER_EVENT, &event, &bytes), MU_OK);
        CU_ASSERT_EQUAL(bytes.size, sizeof wanted + 10000);
        event.kind = words("k");
    }
    muster_RunStatus unknown = {.simulator = words("s"), .state = (muster_RunState)99};
    CU_ASSERT_EQUAL(bus_encode(BUS_RUN_STATUS, &unknown, &bytes), MU_MALFORMED);
    bus_bytes_free(&bytes);
    CU_ASSERT_PTR_NULL(bytes.data);
}

static muster_BrokerEvent *event_decode(const void *bytes, size_t size)
{
    static uint64_t room[32];
    void *sample;
    CU_ASSERT_FATAL(size <= sizeof room);
    memcpy(room, bytes, size);
    mu_result read = bus_decode(BUS_BROKER_EVENT, room, size, &sample);
    CU_ASSERT_EQUAL(read == MU_OK, sample != NULL);
    CU_ASSERT(read == MU_OK || read == MU_MALFORMED);
    return sample;
}

/* Any byte of a recording may be wrong. */
static void test_bytes_as_samples(void)
{
    struct bus_bytes bytes = {0};
    muster_BrokerEvent event = {.broker = words("b1"),
                                .kind = words("box-full"),
                                .agent = words("red"),
                                .sender = words("blue"),
                                .count = 7,
                                .wall_ns = 511};
    CU_ASSERT_EQUAL_FATAL(bus_encode(BUS_BROKER_EVENT, &event, &bytes), MU_OK);
    muster_BrokerEvent *read = event_decode(bytes.data, bytes.size);
    CU_ASSERT_PTR_NOT_NULL_FATAL(read);
    CU_ASSERT_STRING_EQUAL(read->sender, "blue");
    CU_ASSERT_EQUAL(read->count, 7);
    CU_ASSERT_EQUAL(read->wall_ns, 511);
    bus_decode_free(BUS_BROKER_EVENT, read);
    for (size_t cut = 0; cut < bytes.size; cut++) {
        CU_ASSERT_PTR_NULL(event_decode(bytes.data, cut));
    }
    unsigned char wrong[256];
    for (size_t at = 0; at < bytes.size; at++) {
        for (unsigned value = 0; value < 256; value++) {
            memcpy(wrong, bytes.data, bytes.size);
            wrong[at] = (unsigned char)value;
            bus_decode_free(BUS_BROKER_EVENT, event_decode(wrong, bytes.size));
        }
    }
    bus_bytes_free(&bytes);
}

/* A Frame's reader that does not look has the last 64, and its writer never waits. */
static void test_frames_that_nobody_takes(void)
{
    enum { COUNT = 500, KEPT = 64, BEAMS = 1000 };
    struct bus_writer every;
    struct bus_reader reader;
    static float beams_m[BEAMS];
    muster_Percept percepts[64];
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_FRAME, "every", &reader), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_FRAME, "every", NULL, &every), MU_OK);
    for (size_t i = 0; i < 64; i++) { /* a Frame of 256 kB, and 128 MB of them */
        percepts[i] = (muster_Percept){.robot = words("red")};
        percepts[i].laser_m = (dds_sequence_float){._length = BEAMS, ._buffer = beams_m};
    }
    for (int64_t step = 0; step < COUNT; step++) {
        muster_Frame frame = {.simulator = words("sim"), .step = step};
        frame.percepts = (dds_sequence_muster_Percept){._length = 64, ._buffer = percepts};
        CU_ASSERT_EQUAL_FATAL(bus_write(&every, &frame), MU_OK);
    }
    for (int64_t step = COUNT - KEPT; step < COUNT; step++) {
        const void *sample;
        enum bus_life life;
        CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
        CU_ASSERT_EQUAL(((const muster_Frame *)sample)->step, step);
    }
    expect_nothing(&reader);
    bus_writer_close(&every);
}

/* What a watch on every step has that was away: as many Frames as it may be behind. */
static void test_frames_that_wait_in_a_deep_reader(void)
{
    enum { COUNT = MU_WATCH_BEHIND_MAX + 100 };
    struct bus_writer every;
    struct bus_reader reader;
    CU_ASSERT_EQUAL_FATAL(
        bus_reader_open_deep(&bus, BUS_FRAME, "every", MU_WATCH_BEHIND_MAX, &reader), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_FRAME, "every", NULL, &every), MU_OK);
    for (int64_t step = 0; step < COUNT; step++) {
        muster_Frame frame = {.simulator = words("deep"), .step = step};
        CU_ASSERT_EQUAL_FATAL(bus_write(&every, &frame), MU_OK);
    }
    for (int64_t step = COUNT - MU_WATCH_BEHIND_MAX; step < COUNT; step++) {
        const void *sample;
        enum bus_life life;
        CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
        CU_ASSERT_EQUAL_FATAL(((const muster_Frame *)sample)->step, step);
    }
    expect_nothing(&reader);
    bus_writer_close(&every);
}

static muster_Registration registration(const char *process, uint32_t pid)
{
    return (muster_Registration){.wire = muster_WIRE,
                                 .process = words(process),
                                 .broker = words("b1"),
                                 .host = words("here"),
                                 .pid = pid};
}

/* Late comers get the newest of each instance, and hear of its end. */
static void test_registrations(void)
{
    struct bus_writer one;
    struct bus_writer other;
    struct bus_reader reader;
    const void *sample;
    enum bus_life life;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_REGISTRATION, NULL, NULL, &one), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_REGISTRATION, NULL, NULL, &other), MU_OK);
    for (uint32_t pid = 1; pid <= 3; pid++) {
        muster_Registration r = registration("p1", pid);
        CU_ASSERT_EQUAL(bus_write(&one, &r), MU_OK);
    }
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_REGISTRATION, NULL, &reader), MU_OK);
    CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
    CU_ASSERT_EQUAL(life, BUS_DATA);
    CU_ASSERT_EQUAL(((const muster_Registration *)sample)->pid, 3);
    expect_nothing(&reader);

    muster_Registration second = registration("p2", 9); /* another instance */
    CU_ASSERT_EQUAL(bus_write(&other, &second), MU_OK);
    CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
    CU_ASSERT_EQUAL(((const muster_Registration *)sample)->pid, 9);

    muster_Registration key = registration("p1", 0);
    bus_dispose(&one, &key);
    CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
    CU_ASSERT_EQUAL(life, BUS_DISPOSED);
    CU_ASSERT_STRING_EQUAL(((const muster_Registration *)sample)->process, "p1");

    CU_ASSERT_EQUAL(bus_write(&one, &key), MU_OK); /* comes and goes while nobody looks */
    bus_dispose(&one, &key);
    CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
    CU_ASSERT_EQUAL(life, BUS_DATA);
    CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
    CU_ASSERT_EQUAL(life, BUS_DISPOSED);
    CU_ASSERT_STRING_EQUAL(((const muster_Registration *)sample)->process, "p1");
    expect_nothing(&reader);

    CU_ASSERT_EQUAL(bus_write(&other, &second), MU_OK);
    CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
    CU_ASSERT_EQUAL(life, BUS_DATA);
    expect_nothing(&reader);

    bus_writer_close(&other); /* without a word: as a crash */
    CU_ASSERT_TRUE_FATAL(await(&reader, &sample, &life));
    CU_ASSERT_EQUAL(life, BUS_LOST);
    CU_ASSERT_STRING_EQUAL(((const muster_Registration *)sample)->process, "p2");
    bus_writer_close(&one);
}

/* @return whether every UDP socket of this process is bound to the device lo */
static bool sockets_are_loopback(unsigned *count)
{
    bool all = true;
    *count = 0;
    for (int fd = 0; fd < 1024; fd++) {
        struct sockaddr_in address;
        char device[IFNAMSIZ] = "";
        int type = 0;
        socklen_t len = sizeof type, address_len = sizeof address, device_len = sizeof device;
        if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &len) == 0 && type == SOCK_DGRAM &&
            getsockname(fd, (struct sockaddr *)&address, &address_len) == 0 &&
            address.sin_family == AF_INET) {
            (*count)++;
            all = all && getsockopt(fd, SOL_SOCKET, SO_BINDTODEVICE, device, &device_len) == 0 &&
                  strcmp(device, "lo") == 0;
        }
    }
    return all;
}

static void test_sockets_stay_on_loopback(void)
{
    unsigned count;
    CU_ASSERT_TRUE(sockets_are_loopback(&count));
    CU_ASSERT(count >= 1);
}

static void test_a_program_is_in_a_domain_once(void)
{
    static struct bus other;
    struct bus_options options = {.domain = domain(), .place = BUS_AGENT, .name = "test"};
    int kept = hush();
    CU_ASSERT_EQUAL(bus_open(&other, &options), MU_FAULT_USAGE);
    unhush(kept);
    CU_ASSERT_TRUE(bus_reader_matches(&to_p1) > 0); /* the first goes on */
}

static void test_closing(void)
{
    bus_close(&bus);
    CU_ASSERT_EQUAL(bus.participant, 0);
    CU_ASSERT_EQUAL(bus_writer_matches(&writer), 0);
    CU_ASSERT_EQUAL(bus_reader_matches(&to_p1), 0);
    struct bus_options options = {.domain = domain(), .place = BUS_AGENT, .name = "test"};
    CU_ASSERT_EQUAL_FATAL(bus_open(&bus, &options), MU_OK); /* and again */
    bus_close(&bus);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a place is taken once", test_a_place_is_taken_once},
        {"partitions are apart", test_partitions_are_apart},
        {"one writer into two partitions", test_one_writer_into_two_partitions},
        {"writers share a process", test_writers_share_a_process},
        {"batches in order", test_batches_in_order},
        {"what breaks a rule is dropped and counted",
         test_what_breaks_a_rule_is_dropped_and_counted},
        {"waiting", test_waiting},
        {"waits that are short stay awake for a moment",
         test_waits_that_are_short_stay_awake_for_a_moment},
        {"a descriptor wakes a poll loop", test_a_descriptor_wakes_a_poll_loop},
        {"samples as bytes", test_samples_as_bytes},
        {"bytes as samples", test_bytes_as_samples},
        {"frames that nobody takes", test_frames_that_nobody_takes},
        {"frames that wait in a deep reader", test_frames_that_wait_in_a_deep_reader},
        {"registrations", test_registrations},
        {"sockets stay on loopback", test_sockets_stay_on_loopback},
        {"a program is in a domain once", test_a_program_is_in_a_domain_once},
        {"closing", test_closing},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"bus/bus", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
