/* SPDX-License-Identifier: Apache-2.0 */
/*
 * No broker at all: one writes and a crowd reads, with the type, the quality of service and the
 * configuration that mail has, which is the least that a broadcast over DDS can take.  WHERE is
 * DOMAIN:CROWD.
 *
 * Or the least that a star over DDS can take, where WHERE is DOMAIN alone: a hub that everybody is
 * matched with both ways, who is ready then.
 */
#include "peer.h"

#include "../micro/up.h"
#include "bus/bus.h"
#include "core/clock.h"
#include "core/text.h"
#include "load.h"
#include "wire.h"

#include <stdlib.h>
#include <string.h>

#define HUB "hub"

static const uint64_t PATIENCE_NS = 10000000000;

static struct {
    struct bus bus;
    struct bus_writer writer;
    struct bus_reader reader;
    void (*on_mail)(const char *text);
    uint64_t sent;
} peer;

static void reader_open(const char *partition)
{
    if (bus_reader_open(&peer.bus, BUS_UP, partition, &peer.reader) != MU_OK) {
        load_die("no reader");
    }
}

/* Returns when it has found so many readers, and its own reader a writer, if there is to be one. */
static void writer_open(const char *partition, uint32_t readers, bool is_heard)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    if (bus_writer_open(&peer.bus, BUS_UP, partition, NULL, &peer.writer) != MU_OK) {
        load_die("no writer");
    }
    while (bus_writer_matches(&peer.writer) < readers ||
           (is_heard && bus_reader_matches(&peer.reader) == 0)) {
        bus_wait(&peer.bus, 0, 1000000);
        if (mu_clock_ns() > until_ns) {
            load_die("%u of %u are there", bus_writer_matches(&peer.writer), readers);
        }
    }
}

void peer_open(const struct peer_options *options)
{
    char *crowd;
    bool writes = strncmp(options->name, "sender", strlen("sender")) == 0;
    bool is_hub = strcmp(options->name, HUB) == 0;
    struct bus_options bus = {.domain = (int)strtol(options->where, &crowd, 10),
                              .place = writes || is_hub ? BUS_BROKER : BUS_AGENT,
                              .name = options->name};
    bool is_star = *crowd != ':';
    bus.local = is_star ? "off" : NULL;
    peer.on_mail = options->on_mail;
    if (bus_open(&peer.bus, &bus) != MU_OK) {
        load_die("cannot join domain %s", options->where);
    }
    if (writes) {
        writer_open(BUS_TO_ALL, (uint32_t)strtoul(crowd + 1, NULL, 10), false);
    } else {
        reader_open(is_hub ? HUB : BUS_TO_ALL);
    }
    if (is_star) {
        writer_open(is_hub ? BUS_TO_ALL : HUB, is_hub ? 0 : 1, !is_hub);
    }
}

bool peer_send(const char *to, const char *text, enum mu_level level)
{
    char content[LOAD_BYTES + 1];
    struct bench_up sample;
    (void)to; /* whoever reads */
    (void)level;
    mu_text_copy(content, sizeof content, text);
    bench_up_fill(&sample, ++peer.sent, 0, content);
    return bus_write(&peer.writer, &sample.up) == MU_OK;
}

void peer_answer(const char *to, const char *text)
{
    (void)text;
    load_die("nobody carries an answer to %s", to);
}

void peer_spin(int64_t timeout_ns)
{
    enum bus_life life;
    const muster_Up *up;
    bus_wait(&peer.bus, 0, timeout_ns);
    while (peer.on_mail && peer.reader.bus && (up = bus_next(&peer.reader, &life))) {
        if (life == BUS_DATA) {
            peer.on_mail(up->acts._buffer[0].mails._buffer[0].content);
        }
    }
}

void peer_serve(void)
{
    load_spin_on();
}

uint64_t peer_answered(void)
{
    return peer.sent;
}

void peer_close(void)
{
    bus_close(&peer.bus);
}
