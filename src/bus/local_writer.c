/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local_frame.h"
#include "bus/local_pair.h"
#include "bus/local_token.h"
#include "bus/topics.h"
#include "core/clock.h"

#include <linux/sockios.h>
#include <sys/ioctl.h>

/* So long a sample waits for the answer of a reader; then the pair stays with DDS.  A reader that
 * runs answers between two samples. */
static const uint64_t ANSWER_NS = 500000000;

void local_writer_open(struct bus *bus, enum bus_topic topic, const char *last,
                       struct bus_writer *w)
{
    if (!bus->local || !topic_table[topic].local) {
        return;
    }
    struct local_writer *o = local_memory(sizeof *o);
    *o = (struct local_writer){.bus = bus,
                               .next = bus->locals,
                               .topic = topic,
                               .last = last,
                               .writer = w->writer,
                               .seen = atomic_load(&bus->matches) - 1};
    bus->locals = w->local = o;
}

static void pair_free(struct local_pair *p)
{
    local_pair_close(p, PAIR_ENDED);
    dds_free(p);
}

static void writer_free(struct local_writer *o)
{
    for (struct local_pair *p = o->pairs, *next; p; p = next) {
        next = p->next;
        pair_free(p);
    }
    dds_free(o);
}

void local_writer_close(struct bus_writer *w)
{
    if (w->local) {
        struct local_writer **at = &w->bus->locals;
        while (*at != w->local) {
            at = &(*at)->next;
        }
        *at = w->local->next;
        writer_free(w->local);
        w->local = NULL;
    }
}

void local_writers_close(struct bus *bus)
{
    for (struct local_writer *o; (o = bus->locals);) {
        bus->locals = o->next;
        writer_free(o);
    }
}

static void pair_keep(struct local_writer *o, dds_instance_handle_t reader)
{
    struct local_pair **at = &o->pairs;
    while (*at && (*at)->reader != reader) {
        at = &(*at)->next;
    }
    struct local_pair *p = *at;
    if (!p) {
        p = local_memory(sizeof *p);
        *p = (struct local_pair){.source = {LOCAL_OUTPUT, -1}, .writer = o, .reader = reader};
        local_pair_ask(p);
        at = p->last ? at : &o->pairs;
        p->next = *at;
        *at = p;
    }
    p->matched = true;
}

static void pairs_drop(struct local_writer *o)
{
    struct local_pair *p;
    for (struct local_pair **at = &o->pairs; (p = *at);) {
        if (p->matched) {
            p->matched = false;
            at = &p->next;
        } else {
            *at = p->next;
            pair_free(p);
        }
    }
}

static void writer_match(struct local_writer *o)
{
    uint32_t matches = atomic_load(&o->bus->matches);
    if (o->seen == matches) {
        return;
    }
    o->seen = matches;
    dds_instance_handle_t readers[BUS_ENDPOINTS_MAX];
    dds_return_t count = dds_get_matched_subscriptions(o->writer, readers, BUS_ENDPOINTS_MAX);
    for (dds_return_t i = 0; i < count && i < BUS_ENDPOINTS_MAX; i++) {
        pair_keep(o, readers[i]);
    }
    pairs_drop(o);
}

void local_match(struct bus *bus)
{
    for (struct local_writer *o = bus->locals; o; o = o->next) {
        writer_match(o);
    }
}

uint32_t local_matches(struct local_writer *o)
{
    uint32_t count = 0;
    writer_match(o);
    for (const struct local_pair *p = o->pairs; p; p = p->next) {
        count++;
    }
    return count;
}

/* --- writing ---------------------------------------------------------------------------------- */

/* @return whether the pair is settled: the reader has answered, or has had its time */
static bool pair_settle(struct local_pair *p)
{
    if (p->state == PAIR_ASKED) {
        uint64_t now_ns = mu_clock_ns();
        p->asked_ns = p->asked_ns ? p->asked_ns : now_ns;
        if (now_ns - p->asked_ns > ANSWER_NS) {
            local_pair_close(p, PAIR_ON_DDS);
        }
    }
    return p->state != PAIR_ASKED;
}

bool local_has_room(struct local_writer *o)
{
    bool room = true;
    writer_match(o);
    for (struct local_pair *p = o->pairs; p; p = p->next) {
        if (p->to - p->from > LOCAL_WAITING_MAX) {
            local_pair_send(p);
        }
        room = pair_settle(p) && p->to - p->from <= LOCAL_WAITING_MAX && room;
    }
    return room;
}

bool local_needs_dds(const struct local_writer *o)
{
    bool needs = false;
    for (const struct local_pair *p = o->pairs; p; p = p->next) {
        needs = needs || p->state == PAIR_ON_DDS;
    }
    return needs;
}

void local_write(struct local_writer *o, const char *frame)
{
    uint32_t size;
    memcpy(&size, frame, sizeof size);
    for (struct local_pair *p = o->pairs; p; p = p->next) {
        if (p->state == PAIR_OPEN) {
            local_pair_write(p, frame, size);
        }
    }
}

void bus_ways(const struct bus *bus, struct bus_ways *ways)
{
    *ways = (struct bus_ways){.refused = bus->local_refused};
    for (const struct local_writer *o = bus->locals; o; o = o->next) {
        for (const struct local_pair *p = o->pairs; p; p = p->next) {
            ways->sockets += p->state == PAIR_OPEN;
            ways->dds += p->state == PAIR_ON_DDS;
        }
    }
}

dds_time_t local_stamp(struct local_writer *o)
{
    dds_time_t now = dds_time();
    o->stamp = now > o->stamp ? now : o->stamp + 1;
    return o->stamp;
}

bool local_is_out(const struct local_writer *o)
{
    bool out = true;
    for (const struct local_pair *p = o->pairs; p; p = p->next) {
        int unread = 0;
        bool read =
            p->state != PAIR_OPEN || (ioctl(p->source.fd, SIOCOUTQ, &unread) == 0 && unread == 0);
        out = out && read && p->from == p->to;
    }
    return out;
}
