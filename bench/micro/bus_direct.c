/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The yardstick: two processes, one writer and one reader each, and Cyclone DDS as it comes, with
 * the type, the quality of service and the configuration that a mail on its way to the broker has.
 *   bus_direct echo DOMAIN
 *   bus_direct ping DOMAIN COUNT     prints the median round trip in microseconds
 *   bus_direct flood DOMAIN COUNT    prints samples a second, from first write to last read
 */
#include "bus/bus.h"
#include "bus/topics.h"
#include "core/clock.h"
#include "up.h"
#include "wire.h"

#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { COUNT_MAX = 1000000, TAKE_MAX = 256, WAIT_S = 10 };

struct ends {
    struct bus bus;
    dds_entity_t writer, reader, waitset;
    void *samples[TAKE_MAX]; /* on loan */
    dds_sample_info_t infos[TAKE_MAX];
};

static dds_entity_t or_die(dds_entity_t made, const char *what)
{
    if (made < 0) {
        fprintf(stderr, "bench: %s: %s\n", what, dds_strretcode(made));
        exit(4);
    }
    return made;
}

static void ends_open(struct ends *e, int domain, enum bus_place place)
{
    bool first = place == BUS_BROKER;
    struct bus_options options = {.domain = domain, .place = place, .name = "bench"};
    if (bus_open(&e->bus, &options) != MU_OK) {
        exit(4);
    }
    dds_entity_t at = e->bus.participant;
    const struct topic *up = &topic_table[BUS_UP];
    dds_entity_t topic =
        or_die(dds_create_topic(at, up->descriptor, up->name, NULL, NULL), "topic");
    dds_qos_t *qos = topics_qos(up);
    dds_qos_t *to = dds_create_qos();
    dds_qset_partition1(to, first ? "back" : "there");
    dds_entity_t publisher = or_die(dds_create_publisher(at, to, NULL), "publisher");
    dds_qset_partition1(to, first ? "there" : "back");
    dds_entity_t subscriber = or_die(dds_create_subscriber(at, to, NULL), "subscriber");
    e->writer = or_die(dds_create_writer(publisher, topic, qos, NULL), "writer");
    e->reader = or_die(dds_create_reader(subscriber, topic, qos, NULL), "reader");
    dds_delete_qos(to);
    dds_delete_qos(qos);
    dds_entity_t any = or_die(dds_create_readcondition(e->reader, DDS_ANY_STATE), "condition");
    e->waitset = or_die(dds_create_waitset(at), "waitset");
    or_die(dds_waitset_attach(e->waitset, any, 0), "attach");
}

static bool ends_matched(const struct ends *e)
{
    dds_publication_matched_status_t there;
    dds_subscription_matched_status_t back;
    return dds_get_publication_matched_status(e->writer, &there) == 0 &&
           dds_get_subscription_matched_status(e->reader, &back) == 0 && there.current_count > 0 &&
           back.current_count > 0;
}

static void ends_match(const struct ends *e)
{
    for (uint64_t until_ns = mu_clock_ns() + WAIT_S * 1000000000ull; !ends_matched(e);) {
        if (mu_clock_ns() > until_ns) {
            fputs("bench: the other side is not there\n", stderr);
            exit(4);
        }
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
}

/* Sample number step; < 0: one that wants no echo.  A full network is tried again. */
static void ends_write(const struct ends *e, int64_t step)
{
    static char content[] = "mate-pos red 1234.5678 -2345.6789";
    struct bench_up sample;
    bench_up_fill(&sample, 1, step, content);
    dds_return_t code;
    while ((code = dds_write(e->writer, &sample.up)) == DDS_RETCODE_TIMEOUT) {
        nanosleep(&(struct timespec){.tv_nsec = 20000}, NULL);
    }
    or_die(code, "write");
}

/* @return the highest step among the samples that came within WAIT_S; dies when none came */
static int64_t ends_take(struct ends *e)
{
    int64_t highest = INT64_MIN;
    while (highest == INT64_MIN) {
        if (dds_waitset_wait(e->waitset, NULL, 0, DDS_SECS(WAIT_S)) <= 0) {
            fputs("bench: nothing comes\n", stderr);
            exit(4);
        }
        int count = or_die(dds_take(e->reader, e->samples, e->infos, TAKE_MAX, TAKE_MAX), "take");
        for (int i = 0; i < count; i++) {
            const muster_Up *up = e->samples[i];
            if (e->infos[i].valid_data && up->step > highest) {
                highest = up->step;
            }
        }
        if (count > 0) {
            or_die(dds_return_loan(e->reader, e->samples, count), "loan");
        }
    }
    return highest;
}

/* Until it is ended; its reader outlives many partners. */
static void echo(struct ends *e)
{
    for (;;) {
        if (dds_waitset_wait(e->waitset, NULL, 0, DDS_SECS(1)) > 0) {
            int64_t step = ends_take(e);
            if (step >= 0) {
                ends_match(e); /* its partner may have found it first, and would hear nothing */
                ends_write(e, step);
            }
        }
    }
}

static int compare(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

static void ping(struct ends *e, int64_t count)
{
    static uint64_t took_ns[COUNT_MAX];
    for (int64_t i = 0; i < count; i++) {
        uint64_t began_ns = mu_clock_ns();
        ends_write(e, i);
        while (ends_take(e) != i) {
        }
        took_ns[i] = mu_clock_ns() - began_ns;
    }
    qsort(took_ns, (size_t)count, sizeof took_ns[0], compare);
    printf("%.3f\n", (double)took_ns[count / 2] * 1e-3);
}

static void flood(struct ends *e, int64_t count)
{
    uint64_t began_ns = mu_clock_ns();
    for (int64_t i = 1; i < count; i++) {
        ends_write(e, -1);
    }
    ends_write(e, count);
    while (ends_take(e) != count) {
    }
    printf("%.1f\n", (double)count * 1e9 / (double)(mu_clock_ns() - began_ns));
}

int main(int argc, char **argv)
{
    static struct ends ends;
    int64_t count = argc > 3 ? strtoll(argv[3], NULL, 10) : 0;
    bool echoes = argc == 3 && strcmp(argv[1], "echo") == 0;
    if (!echoes && (argc != 4 || count < 1 || count > COUNT_MAX)) {
        return 2;
    }
    ends_open(&ends, (int)strtol(argv[2], NULL, 10), echoes ? BUS_BROKER : BUS_SIMULATOR);
    if (echoes) {
        echo(&ends);
    }
    ends_match(&ends);
    if (strcmp(argv[1], "ping") == 0) {
        ping(&ends, count);
    } else {
        flood(&ends, count);
    }
    bus_close(&ends.bus);
    return 0;
}
