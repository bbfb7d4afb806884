/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sockets between processes of one host: a writer here, and a reader in another process, which says
 * through a pipe what it gets.  A reader of our own process is one that stays with DDS, as a tool's
 * or another host's would.
 */
#include "bus/bus.h"
#include "bus/local_frame.h"
#include "bus/local_shared.h"
#include "bus/local_token.h"
#include "bus/topics.h"
#include "core/clock.h"
#include "hush.h"
#include "muster/limits.h"
#include "samples.h"
#include "suite.h"
#include "wire.h"

#include <CUnit/Basic.h>
#include <fcntl.h>
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

static const uint64_t PATIENCE_NS = 10000000000u;
static const int64_t WAIT_NS = 2000000, PAIR_NS = 50000000;

/* What the reader got. */
struct word {
    int64_t step;
    int life;
    bool whole; /* the content is what it was */
};

/* A process that reads. */
struct side {
    pid_t pid;
    int orders, words; /* pipes: 'g' go on, 's' stand still, to it; struct word, from it */
};

struct scene {
    const char *local;     /* of the reader: "on" or "off" */
    const char *partition; /* of the reader; NULL: "p1" */
    enum bus_topic topic;
    rlim_t files; /* 0: as many as there are */
    bool stands;  /* it stands still at first */
    bool late;    /* it begins when it is told to go on */
    bool pairs;   /* it waits for two samples at once, and longer */
    bool echoes;  /* it writes steps, too, to "p2" */
};

static struct bus bus;
static struct bus_writer writer, to_all;
static bool shares; /* the writer has one on DDS when a reader needs it (local_shared.h) */
static struct bus_reader own;
static int next_domain;
static char content[MU_CONTENT_MAX + 1];

/* --- the other process ------------------------------------------------------------------------ */

static bool content_is_whole(const muster_Delivery *d)
{
    bool whole = true;
    for (uint32_t i = 0; i < d->parcels._length; i++) {
        whole = whole && strcmp(d->parcels._buffer[i].letter.content, content) == 0;
    }
    return whole;
}

static void words_say(struct bus_reader *reader, int words)
{
    enum bus_life life;
    const void *sample;
    while ((sample = bus_next(reader, &life))) {
        bool is_step = reader->topic == BUS_SENSE;
        struct word w = {.life = life, .whole = true};
        if (life == BUS_DATA) {
            const muster_Delivery *d = sample;
            w.step = is_step ? ((const muster_Sense *)sample)->step : d->step;
            w.whole = is_step || content_is_whole(d);
        }
        ssize_t written = write(words, &w, sizeof w);
        (void)written;
    }
}

static void side_live(int domain, const struct scene *scene, int orders, int words)
{
    static struct bus there;
    static struct bus_reader reader;
    static struct bus_writer echo;
    struct bus_options options = {
        .domain = domain, .place = BUS_BROKER, .name = "reader", .local = scene->local};
    const char *partition = scene->partition ? scene->partition : "p1";
    char go;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if ((scene->late && read(orders, &go, 1) != 1) || bus_open(&there, &options) != MU_OK ||
        bus_reader_open(&there, scene->topic, partition, &reader) != MU_OK ||
        (scene->echoes && bus_writer_open(&there, BUS_SENSE, "p2", NULL, &echo) != MU_OK)) {
        _exit(1);
    }
    const struct word up = {.whole = true};
    ssize_t said = write(words, &up, sizeof up);
    (void)said;
    if (scene->files > 0) { /* all that it has are in use */
        struct rlimit limit = {scene->files, scene->files};
        while (open("/dev/null", O_RDONLY) < (int)scene->files - 1) {
        }
        setrlimit(RLIMIT_NOFILE, &limit);
    }
    for (char order = scene->stands ? 's' : 'g';;) {
        struct pollfd told = {.fd = orders, .events = POLLIN};
        if (poll(&told, 1, order == 's' ? 100 : 0) == 1 && read(orders, &order, 1) != 1) {
            _exit(0);
        }
        if (order == 'g') {
            bus_wait(&there, scene->pairs ? 2 : 1, scene->pairs ? PAIR_NS : WAIT_NS);
            words_say(&reader, words);
        }
        if (scene->echoes) {
            muster_Sense sense = {.process = (char[]){"p2"}};
            mu_result echoed = bus_write(&echo, &sense);
            (void)echoed;
        }
    }
}

/* @return whether it said something within the patience */
static bool word_get(const struct side *s, struct word *w, int timeout_ms)
{
    struct pollfd said = {.fd = s->words, .events = POLLIN};
    return poll(&said, 1, timeout_ms) == 1 && read(s->words, w, sizeof *w) == (ssize_t)sizeof *w;
}

static struct side side_start(const struct scene *scene)
{
    struct side s;
    int to[2], from[2];
    bool piped = pipe2(to, O_CLOEXEC) == 0 && pipe2(from, O_CLOEXEC) == 0;
    CU_ASSERT_TRUE_FATAL(piped);
    s.pid = fork();
    if (s.pid == 0) {
        close(to[1]);
        close(from[0]);
        side_live(next_domain, scene, to[0], from[1]);
    }
    close(to[0]);
    close(from[1]);
    s.orders = to[1];
    s.words = from[0];
    struct word up;
    CU_ASSERT_TRUE_FATAL(scene->late || word_get(&s, &up, 10000));
    return s;
}

static void order(const struct side *s, char what)
{
    ssize_t written = write(s->orders, &what, 1);
    CU_ASSERT_EQUAL(written, 1);
}

static void side_end(struct side *s)
{
    kill(s->pid, SIGKILL);
    waitpid(s->pid, NULL, 0);
    close(s->orders);
    close(s->words);
}

/* Meanwhile what the kernel did not take yet goes out. */
static bool word_await(const struct side *s, struct word *w)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    bool said = false;
    while (!said && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, 0);
        said = word_get(s, w, 1);
    }
    return said;
}

static void expect_steps(const struct side *s, int64_t first, int64_t last)
{
    for (int64_t step = first; step <= last; step++) {
        struct word w = {0};
        CU_ASSERT_TRUE_FATAL(word_await(s, &w));
        CU_ASSERT_EQUAL_FATAL(w.life, BUS_DATA);
        CU_ASSERT_EQUAL_FATAL(w.step, step);
        CU_ASSERT_TRUE_FATAL(w.whole);
    }
}

static void expect_no_word(const struct side *s)
{
    CU_ASSERT_FALSE(word_get(s, &(struct word){0}, 60));
}

/* --- here ------------------------------------------------------------------------------------- */

/* To whom the last two packets went, the last one first. */
static pid_t sent_to[2];

/* Stands before the C library's. */
ssize_t send(int fd, const void *data, size_t size, int flags)
{
    struct ucred peer = {0};
    socklen_t len = sizeof peer;
    (void)getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &len);
    sent_to[1] = sent_to[0];
    sent_to[0] = peer.pid;
    return sendto(fd, data, size, flags, NULL, 0);
}

static void matches_await(const struct bus_writer *w, uint32_t readers)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (bus_writer_matches(w) != readers && mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, WAIT_NS);
    }
    CU_ASSERT_EQUAL_FATAL(bus_writer_matches(w), readers);
}

/* A scene: the process is forked before this one touches DDS, which does not survive it. */
static struct side scene_begin(const struct scene *scene, uint32_t readers)
{
    struct side s = side_start(scene);
    struct bus_options options = {
        .domain = next_domain, .place = BUS_AGENT, .name = "writer", .local = "on"};
    CU_ASSERT_EQUAL_FATAL(bus_open(&bus, &options), MU_OK);
    if (shares) {
        CU_ASSERT(bus_writer_open(&bus, BUS_DELIVERY, BUS_TO_ALL, NULL, &to_all) == MU_OK);
    }
    const char *second = shares ? NULL : "last";
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, scene->topic, "p1", second, &writer), MU_OK);
    if (readers > 1) {
        CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, scene->topic, "p1", &own), MU_OK);
    }
    matches_await(&writer, readers);
    return s;
}

static void scene_end(struct side *s)
{
    bus_writer_close(&writer);
    bus_reader_close(&own);
    bus_close(&bus);
    side_end(s);
    next_domain++;
}

/* @return the writer of ours that has found the reader on DDS */
static dds_entity_t finder(void)
{
    return shares ? bus.shared->writer : writer.writer;
}

static mu_result step_try(const struct scene *scene, int64_t step, uint32_t parcels)
{
    static muster_Parcel many[64];
    muster_Delivery d = {.process = words("p1"), .step = step};
    for (uint32_t i = 0; i < parcels; i++) {
        many[i] = (muster_Parcel){
            .box = words("a"),
            .number = i + 1,
            .letter = {.src = words("b"), .seq = 1, .dst = words("a"), .content = content}};
    }
    d.parcels._buffer = many;
    d.parcels._length = d.parcels._maximum = parcels;
    muster_Sense sense = {.process = words("p1"), .step = step};
    return bus_write(&writer, scene->topic == BUS_SENSE ? (void *)&sense : (void *)&d);
}

static void scene_write(const struct scene *scene, int64_t first, int64_t last, uint32_t parcels)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    for (int64_t step = first; step <= last && mu_clock_ns() < until_ns;) {
        mu_result wrote = step_try(scene, step, parcels);
        step += wrote == MU_OK;
        CU_ASSERT_FATAL(wrote == MU_OK || wrote == MU_BUSY);
        if (wrote == MU_BUSY) {
            bus_wait(&bus, 1, WAIT_NS);
        }
    }
}

static const struct scene plain = {.local = "on", .topic = BUS_DELIVERY};

static void steps_write(int64_t first, int64_t last, uint32_t parcels)
{
    scene_write(&plain, first, last, parcels);
}

static void expect_ways(uint64_t sockets, uint64_t dds)
{
    struct bus_ways ways;
    bus_ways(&bus, &ways);
    CU_ASSERT_EQUAL(ways.sockets, sockets);
    CU_ASSERT_EQUAL(ways.dds, dds);
}

/* --- tests ------------------------------------------------------------------------------------ */

static void test_samples_of_any_size_come_whole_and_in_order(void)
{
    struct side s = scene_begin(&plain, 1);
    steps_write(1, 500, 0);
    steps_write(501, 520, 64); /* a megabyte each */
    steps_write(521, 600, 1);
    expect_ways(1, 0);
    CU_ASSERT_TRUE(bus_drain(&writer, (int64_t)PATIENCE_NS));
    expect_steps(&s, 1, 600);
    expect_no_word(&s);
    scene_end(&s);
}

static void test_who_has_no_socket_gets_all_by_dds_and_nobody_twice(void)
{
    struct side s = scene_begin(&plain, 2);
    steps_write(1, 300, 1);
    expect_ways(1, 1);
    expect_steps(&s, 1, 300);
    bus_reader_close(&own); /* a tool that goes and comes changes nothing */
    steps_write(301, 400, 1);
    expect_steps(&s, 301, 400);
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_DELIVERY, "p1", &own), MU_OK);
    steps_write(401, 500, 1);
    expect_ways(1, 1);
    expect_steps(&s, 401, 500);
    expect_no_word(&s);
    enum bus_life life;
    const muster_Delivery *d;
    int64_t step = 400;
    while ((d = bus_next(&own, &life))) {
        CU_ASSERT_EQUAL(d->step, ++step);
    }
    CU_ASSERT_EQUAL(step, 500);
    scene_end(&s);
}

static uint32_t samples_of(dds_entity_t reader)
{
    void *sample[1] = {NULL};
    dds_sample_info_t info;
    uint32_t count = 0;
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (count < 100 && mu_clock_ns() < until_ns) {
        if (dds_take(reader, sample, &info, 1, 1) == 1) {
            count += info.valid_data;
            dds_return_loan(reader, sample, 1);
        } else {
            bus_wait(&bus, 1, WAIT_NS);
        }
    }
    return count;
}

static dds_entity_t topic_of(dds_entity_t participant)
{
    return dds_create_topic(participant, &muster_Delivery_desc, topic_table[BUS_DELIVERY].name,
                            NULL, NULL);
}

/* @return a reader of Deliveries in a participant of its own */
static dds_entity_t tool_open(const dds_qos_t *qos)
{
    dds_entity_t tool = dds_create_participant((dds_domainid_t)next_domain, NULL, NULL);
    dds_entity_t reader =
        dds_create_reader(dds_create_subscriber(tool, qos, NULL), topic_of(tool), qos, NULL);
    CU_ASSERT_TRUE_FATAL(reader > 0);
    return reader;
}

/* A tool comes to a process that reads: both get all, each in its own way. */
static void expect_both_served(struct side *s, dds_entity_t tool)
{
    matches_await(&writer, 2);
    steps_write(1, 100, 1);
    expect_ways(1, 1);
    expect_steps(s, 1, 100);
    CU_ASSERT_EQUAL(samples_of(tool), 100);
    expect_no_word(s);
    dds_delete(dds_get_participant(tool));
}

/* As `cyclonedds subscribe` does it. */
static void test_a_tool_that_copies_a_reader_s_qos_gets_all_by_dds(void)
{
    struct side s = scene_begin(&plain, 1);
    dds_instance_handle_t other = 0;
    CU_ASSERT_EQUAL_FATAL(dds_get_matched_subscriptions(finder(), &other, 1), 1);
    dds_builtintopic_endpoint_t *about = dds_get_matched_subscription_data(finder(), other);
    dds_entity_t tool = tool_open(about->qos);
    dds_builtintopic_free_endpoint(about);
    expect_both_served(&s, tool);
    scene_end(&s);
}

static void test_a_tool_of_a_pattern_gets_all_by_dds(void)
{
    struct side s = scene_begin(&plain, 1);
    dds_qos_t *qos = topics_qos(&topic_table[BUS_DELIVERY]);
    dds_qset_partition1(qos, "p?");
    dds_entity_t tool = tool_open(qos);
    dds_delete_qos(qos);
    expect_both_served(&s, tool);
    steps_write(101, 200, 1);
    expect_ways(1, 0); /* it is gone, and the process has its socket */
    expect_steps(&s, 101, 200);
    scene_end(&s);
}

static void test_off_is_dds_alone(void)
{
    struct scene off = {.local = "off", .topic = BUS_DELIVERY};
    struct side s = scene_begin(&off, 1);
    steps_write(1, 100, 1);
    expect_ways(0, 1);
    expect_steps(&s, 1, 100);
    scene_end(&s);
    struct bus_options wrong = {.domain = next_domain, .place = BUS_AGENT, .local = "perhaps"};
    int quiet = hush();
    CU_ASSERT_EQUAL(bus_open(&bus, &wrong), MU_FAULT_USAGE);
    unhush(quiet);
}

static void test_who_does_not_read_makes_the_writer_wait(void)
{
    struct side s = scene_begin(&plain, 1);
    steps_write(1, 1, 1);
    expect_steps(&s, 1, 1);
    order(&s, 's');
    usleep(150000);
    int64_t step = 2;
    while (step < 100 && step_try(&plain, step, 64) == MU_OK) {
        step++;
    }
    CU_ASSERT(step > 5 && step < 30); /* some 8 MB are kept */
    CU_ASSERT_FALSE(bus_drain(&writer, WAIT_NS));
    order(&s, 'g');
    steps_write(step, step + 10, 64);
    expect_steps(&s, 2, step + 10);
    scene_end(&s);
}

static void test_who_is_killed_leaves_no_half_sample(void)
{
    struct side s = scene_begin(&plain, 1);
    steps_write(1, 1, 64);
    order(&s, 's');
    usleep(150000);
    while (step_try(&plain, 2, 64) == MU_OK) {
    }
    kill(s.pid, SIGKILL);
    steps_write(3, 50, 64); /* as to a reader that DDS will miss */
    scene_end(&s);
}

/* The last sample alone counts: one that stood still goes on with the newest. */
static void test_steps_that_nobody_took_are_passed_over(void)
{
    struct scene steps = {.local = "on", .topic = BUS_SENSE};
    struct side s = scene_begin(&steps, 1);
    struct word w = {0};
    scene_write(&steps, 1, 1, 0);
    expect_steps(&s, 1, 1);
    order(&s, 's');
    usleep(150000);
    scene_write(&steps, 2, 20000, 0);
    order(&s, 'g');
    int handed = 0;
    for (int64_t before = 1; w.step < 20000; before = w.step, handed++) {
        CU_ASSERT_TRUE_FATAL(word_await(&s, &w));
        CU_ASSERT(w.step > before);
    }
    CU_ASSERT(handed < 50);
    scene_end(&s);
}

static void test_who_writes_and_never_waits_hears(void)
{
    static const struct scene scene = {.local = "on", .topic = BUS_DELIVERY, .echoes = true};
    struct side s = scene_begin(&scene, 1);
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_SENSE, "p2", &own), MU_OK);
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    unsigned heard = 0;
    enum bus_life life;
    struct word w;
    for (int64_t step = 1; heard < 100 && mu_clock_ns() < until_ns; step++) {
        (void)step_try(&scene, step, 0);
        bus_wait(&bus, 1, 0);
        heard += bus.local_frames > 0;
        while (bus_next(&own, &life)) {
        }
        (void)word_get(&s, &w, 0); /* or its pipe is full */
    }
    CU_ASSERT_EQUAL(heard, 100);
    scene_end(&s);
}

static void test_who_has_no_descriptor_left_stays_with_dds(void)
{
    struct scene full = {.local = "on", .topic = BUS_DELIVERY, .files = 64};
    struct side s = scene_begin(&full, 1);
    steps_write(1, 100, 1);
    expect_ways(0, 1);
    struct bus_ways ways;
    bus_ways(&bus, &ways);
    CU_ASSERT_EQUAL(ways.refused, 1);
    expect_steps(&s, 1, 100);
    scene_end(&s);
}

/* One that does not answer in time stays with DDS, and nothing of that is dropped. */
static void test_who_answers_too_late_stays_with_dds(void)
{
    struct scene late = {.local = "on", .topic = BUS_DELIVERY, .stands = true};
    struct side s = scene_begin(&late, 1);
    steps_write(1, 50, 1);
    expect_ways(0, 1);
    order(&s, 'g');
    expect_steps(&s, 1, 50);
    steps_write(51, 100, 1);
    expect_steps(&s, 51, 100);
    expect_ways(0, 1);
    scene_end(&s);
}

/* @return a connection to the reader as any program of this user can have it; hello: says who it
 * is, which the reader answers */
static int stranger_connect(bool hello)
{
    dds_instance_handle_t reader = 0;
    struct local_token token;
    CU_ASSERT_EQUAL_FATAL(dds_get_matched_subscriptions(finder(), &reader, 1), 1);
    dds_builtintopic_endpoint_t *about = dds_get_matched_subscription_data(finder(), reader);
    CU_ASSERT_TRUE_FATAL(local_token_find(about, &token));
    dds_builtintopic_free_endpoint(about);
    int fd = local_connect(&token, 65536);
    CU_ASSERT_TRUE_FATAL(fd >= 0);
    fcntl(fd, F_SETFL, 0);
    if (hello) {
        struct local_hello who = {.mark = LOCAL_HELLO_MARK};
        char answer;
        CU_ASSERT_EQUAL(send(fd, &who, LOCAL_HELLO_FIRST, MSG_NOSIGNAL), LOCAL_HELLO_FIRST);
        CU_ASSERT_EQUAL(recv(fd, &answer, 1, 0), 1);
        CU_ASSERT_EQUAL(send(fd, &who.since_ns, sizeof who.since_ns, MSG_NOSIGNAL),
                        (ssize_t)sizeof who.since_ns);
    }
    return fd;
}

/* Sends, and closes once the reader has; told: it hears of an end, behind no sample. */
static void stranger_send(struct side *s, bool hello, const void *data, size_t size, bool told)
{
    int fd = stranger_connect(hello);
    struct word w = {.life = BUS_DATA};
    ssize_t sent = send(fd, data, size, MSG_NOSIGNAL);
    CU_ASSERT_EQUAL(sent, (ssize_t)size);
    shutdown(fd, SHUT_WR);
    char rest;
    CU_ASSERT(recv(fd, &rest, 1, 0) <= 0);
    close(fd);
    if (told) {
        CU_ASSERT_TRUE(word_get(s, &w, 5000));
        CU_ASSERT_EQUAL(w.life, BUS_LOST);
    }
    expect_no_word(s);
}

static void test_strangers_harm_nobody(void)
{
    struct side s = scene_begin(&plain, 1);
    uint32_t frame[16];
    steps_write(1, 10, 1);
    expect_steps(&s, 1, 10);
    memset(frame, 0xee, sizeof frame);
    stranger_send(&s, false, frame, sizeof frame, false); /* not who it should be */
    stranger_send(&s, false, frame, 5, false);            /* gone before it has said so */
    stranger_send(&s, true, frame, sizeof frame, true);   /* 4 GB that never come */
    frame[0] = 3;
    stranger_send(&s, true, frame, sizeof frame, true); /* no size */
    frame[0] = sizeof frame;
    stranger_send(&s, true, frame, sizeof frame, true); /* no sample */
    frame[0] = 2 * sizeof frame;
    stranger_send(&s, true, frame, sizeof frame, true); /* half of one */
    steps_write(11, 20, 1);
    expect_steps(&s, 11, 20);
    scene_end(&s);
}

/* A child has the descriptors, too: what is closed here is not waited for, whatever it does. */
static void test_a_child_disturbs_nothing(void)
{
    struct side s = scene_begin(&plain, 1);
    steps_write(1, 10, 1);
    expect_steps(&s, 1, 10);
    pid_t child = fork();
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        pause();
        _exit(0);
    }
    kill(s.pid, SIGKILL);
    steps_write(11, 50, 64);
    bus_writer_close(&writer);
    uint64_t began_ns = mu_clock_ns();
    bus_wait(&bus, 1, 20000000);
    CU_ASSERT(mu_clock_ns() - began_ns >= 20000000);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    scene_end(&s);
}

static void other_write(const struct bus_writer *other, int64_t step)
{
    const muster_Delivery d = {.process = words("p1"), .step = step};
    while (bus_write(other, &d) == MU_BUSY) {
        bus_wait(&bus, 1, WAIT_NS);
    }
}

/* Whichever sample of two comes later, and when its writer leaves: what comes is handed out. */
static void test_pairs_come_and_their_writers_go(void)
{
    const struct scene pairs = {.local = "on", .topic = BUS_DELIVERY, .pairs = true};
    struct side s = scene_begin(&pairs, 1);
    struct bus_writer other;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, "p1", NULL, &other), MU_OK);
    matches_await(&other, 1);
    for (int64_t step = 1; step < 80; step += 2) {
        struct word one = {0}, two = {0};
        bool first = step < 40;
        first ? steps_write(step, step, 0) : other_write(&other, step);
        first ? other_write(&other, step + 1) : steps_write(step + 1, step + 1, 0);
        CU_ASSERT_TRUE_FATAL(word_await(&s, &one) && word_await(&s, &two));
        CU_ASSERT_EQUAL(one.step + two.step, 2 * step + 1);
    }
    other_write(&other, 80);
    expect_steps(&s, 80, 80);
    bus_writer_close(&other);
    struct word end = {0};
    CU_ASSERT_TRUE_FATAL(word_await(&s, &end));
    CU_ASSERT_EQUAL(end.life, BUS_LOST);
    steps_write(81, 90, 0);
    expect_steps(&s, 81, 90);
    scene_end(&s);
}

static int delivery_writers_on_dds(void)
{
    dds_entity_t all =
        dds_create_reader(bus.participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL);
    void *sample[1] = {NULL};
    dds_sample_info_t info;
    int count = 0;
    while (dds_take(all, sample, &info, 1, 1) == 1) {
        const dds_builtintopic_endpoint_t *about = sample[0];
        count += strcmp(about->topic_name, topic_table[BUS_DELIVERY].name) == 0;
        dds_return_loan(all, sample, 1);
    }
    dds_delete(all);
    return count;
}

static void test_each_partition_has_its_own_samples_and_no_writer(void)
{
    const struct scene of_other = {.local = "on", .topic = BUS_DELIVERY, .partition = "p2"};
    struct side other = side_start(&of_other);
    struct side s = scene_begin(&plain, 1);
    struct bus_writer to_other;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, "p2", NULL, &to_other), MU_OK);
    matches_await(&to_other, 1);
    CU_ASSERT_TRUE(bus_writer_reaches(&to_other, "p2"));
    CU_ASSERT_FALSE(bus_writer_reaches(&to_other, "p1"));
    steps_write(1, 50, 1);
    other_write(&to_other, 51);
    expect_steps(&other, 51, 51);
    expect_steps(&s, 1, 50);
    expect_no_word(&s);
    CU_ASSERT_EQUAL(delivery_writers_on_dds(), 2); /* to all, and the one that is shared */
    CU_ASSERT_TRUE(bus_drain(&writer, (int64_t)PATIENCE_NS));
    bus_writer_close(&to_other);
    struct word end;
    CU_ASSERT_TRUE(word_await(&other, &end) && end.life == BUS_LOST);
    side_end(&other);
    matches_await(&writer, 1);
    steps_write(52, 60, 1);
    expect_steps(&s, 52, 60);
    scene_end(&s);
}

/* Each sample of two writers comes both ways. */
static void test_a_process_of_a_pattern_gets_nothing_twice(void)
{
    const struct scene of_all = {.local = "on", .topic = BUS_DELIVERY, .partition = "p?"};
    struct side s = scene_begin(&of_all, 1);
    struct bus_writer other;
    CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, BUS_DELIVERY, "p2", NULL, &other), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, BUS_DELIVERY, "p?", &own), MU_OK);
    matches_await(&writer, 2);
    matches_await(&other, 2);
    CU_ASSERT_FALSE(bus_writer_reaches(&other, "p2")); /* that is another process */
    for (int64_t step = 1; step < 40; step += 2) {
        steps_write(step, step, 0);
        expect_steps(&s, step, step);
        other_write(&other, step + 1);
        expect_steps(&s, step + 1, step + 1);
    }
    expect_no_word(&s);
    bus_writer_close(&other);
    scene_end(&s);
}

static void test_a_reader_of_the_last_partition_is_last(void)
{
    const struct scene of_last = {.local = "on", .topic = BUS_DELIVERY, .partition = "last"};
    const struct scene of_first = {.local = "on", .topic = BUS_DELIVERY, .late = true};
    struct side first = side_start(&of_first);
    struct side last = scene_begin(&of_last, 1);
    order(&first, 'g');
    matches_await(&writer, 2); /* the one that is last has come first */
    steps_write(1, 1, 0);
    CU_ASSERT_EQUAL(sent_to[1], first.pid);
    CU_ASSERT_EQUAL(sent_to[0], last.pid);
    side_end(&first);
    scene_end(&last);
}

/* A sample that breaks a rule of the wire is dropped, as one of DDS. */
static void test_the_border_is_the_same(void)
{
    struct side s = scene_begin(&plain, 1);
    muster_Receipt receipt = {.agent = words("no name")};
    muster_Delivery bad = {.process = words("p1"), .step = 2};
    bad.receipts._buffer = &receipt;
    bad.receipts._length = bad.receipts._maximum = 1;
    steps_write(1, 1, 0);
    CU_ASSERT_EQUAL(bus_write(&writer, &bad), MU_OK);
    steps_write(3, 3, 0);
    expect_steps(&s, 1, 1);
    expect_steps(&s, 3, 3);
    scene_end(&s);
}

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(120);
    memset(content, 'x', MU_CONTENT_MAX);
    next_domain = 20 + (int)(getpid() % 140);
    return 0;
}

static int begin_shared(void)
{
    shares = true;
    return 0;
}

int main(void)
{
    CU_TestInfo both[] = {
        {"samples of any size", test_samples_of_any_size_come_whole_and_in_order},
        {"tools beside", test_who_has_no_socket_gets_all_by_dds_and_nobody_twice},
        {"a tool's copy", test_a_tool_that_copies_a_reader_s_qos_gets_all_by_dds},
        {"a tool's pattern", test_a_tool_of_a_pattern_gets_all_by_dds},
        {"off", test_off_is_dds_alone},
        {"back pressure", test_who_does_not_read_makes_the_writer_wait},
        {"killed", test_who_is_killed_leaves_no_half_sample},
        {"newest step", test_steps_that_nobody_took_are_passed_over},
        {"one that writes and never waits hears", test_who_writes_and_never_waits_hears},
        {"no descriptor", test_who_has_no_descriptor_left_stays_with_dds},
        {"too late", test_who_answers_too_late_stays_with_dds},
        {"strangers", test_strangers_harm_nobody},
        {"child", test_a_child_disturbs_nothing},
        {"pairs", test_pairs_come_and_their_writers_go},
        {"border", test_the_border_is_the_same},
        CU_TEST_INFO_NULL};
    CU_TestInfo one[] = {{"last", test_a_reader_of_the_last_partition_is_last}, CU_TEST_INFO_NULL};
    CU_TestInfo shared[] = {{"partitions", test_each_partition_has_its_own_samples_and_no_writer},
                            {"a pattern", test_a_process_of_a_pattern_gets_nothing_twice},
                            CU_TEST_INFO_NULL};
    CU_SuiteInfo suites[] = {{"bus/local", begin, NULL, NULL, NULL, both},
                             {"bus/local: order", NULL, NULL, NULL, NULL, one},
                             {"bus/local: shared", begin_shared, NULL, NULL, NULL, both},
                             {"bus/local: partitions", NULL, NULL, NULL, NULL, shared},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
