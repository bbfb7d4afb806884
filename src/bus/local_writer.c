/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local.h"

#include "bus/local_frame.h"
#include "bus/local_token.h"
#include "bus/topics.h"
#include "core/clock.h"

#include <errno.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>

/* What a reader does not take is kept, up to so much: then it is the writer that waits.
 * As what DDS keeps of a process (config.c). */
enum { WAITING_MAX = 8 << 20 };

/* So long a sample waits for the answer of a reader; then the pair stays with DDS.  A reader that
 * runs answers between two samples. */
static const uint64_t ANSWER_NS = 500000000;

enum pair_state {
    PAIR_ASKED, /* it is connected, and has no answer yet */
    PAIR_OPEN,  /* samples go by the socket */
    PAIR_ENDED, /* the reader has closed it, and DDS will miss it soon */
    PAIR_ON_DDS,
};

/* A writer and one of its readers. */
struct local_pair {
    struct local_source source;
    struct local_pair *next;
    struct local_writer *writer;
    dds_instance_handle_t reader; /* on DDS */
    enum pair_state state;
    bool last;             /* behind all those that are not */
    bool matched;          /* DDS still has it */
    uint64_t asked_ns;     /* since when a sample waits for the answer; 0: none does */
    char *waiting;         /* what the kernel did not take */
    size_t size, from, to; /* of waiting, and what is in it */
    size_t begun;          /* up to here it is the rest of one whose beginning is out */
};

struct local_writer {
    struct bus *bus;
    struct local_writer *next; /* of the bus */
    enum bus_topic topic;
    const char *last; /* the partition of readers that are last; NULL: none */
    dds_entity_t writer;
    uint32_t seen; /* of bus->matches, when it last looked */
    dds_time_t stamp;
    struct local_pair *pairs;
};

/* --- one pair --------------------------------------------------------------------------------- */

static void pair_close(struct local_pair *p, enum pair_state state)
{
    local_unwatch(p->writer->bus, &p->source);
    dds_free(p->waiting);
    p->waiting = NULL;
    p->size = p->from = p->to = p->begun = 0;
    p->state = state;
}

/* @return whether a reader of another process has a socket */
static bool token_find(const struct bus *bus, const dds_builtintopic_endpoint_t *reader,
                       struct local_token *token)
{
    dds_guid_t own;
    return dds_get_guid(bus->participant, &own) == DDS_RETCODE_OK &&
           memcmp(&own, &reader->participant_key, sizeof own) != 0 &&
           local_token_find(reader, token);
}

/* A reader without a socket, of another host or another user stays with DDS. */
static void pair_ask(struct local_pair *p)
{
    struct local_writer *o = p->writer;
    dds_builtintopic_endpoint_t *reader = dds_get_matched_subscription_data(o->writer, p->reader);
    struct local_token token;
    struct local_hello hello = {.mark = LOCAL_HELLO_MARK};
    bool has_socket = reader && token_find(o->bus, reader, &token);
    p->source.fd = has_socket ? local_connect(&token, WAITING_MAX) : -1;
    if (p->source.fd >= 0 && local_is_ours(p->source.fd) &&
        dds_get_guid(o->writer, &hello.writer) == DDS_RETCODE_OK &&
        send(p->source.fd, &hello, LOCAL_HELLO_FIRST, MSG_NOSIGNAL) == LOCAL_HELLO_FIRST) {
        p->state = PAIR_ASKED;
        local_watch(o->bus, &p->source, EPOLLIN);
    } else {
        o->bus->local_refused += p->source.fd >= 0;
        pair_close(p, PAIR_ON_DDS);
    }
    if (reader) {
        p->last = o->last && local_endpoint_names(reader, o->last);
        dds_builtintopic_free_endpoint(reader);
    }
}

static void answer_take(struct local_pair *p)
{
    char answer;
    dds_time_t since_ns = p->writer->stamp;
    if (recv(p->source.fd, &answer, 1, MSG_DONTWAIT) == 1 &&
        send(p->source.fd, &since_ns, sizeof since_ns, MSG_NOSIGNAL) == (ssize_t)sizeof since_ns) {
        p->state = PAIR_OPEN;
        local_change(p->writer->bus, &p->source, 0); /* its end is told all the same */
    } else {
        p->writer->bus->local_refused++;
        pair_close(p, PAIR_ON_DDS);
    }
}

/* @return how many bytes the kernel took, all of them if the reader is gone; what is left waits */
static size_t bytes_send(struct local_pair *p, const char *data, size_t size)
{
    ssize_t sent = send(p->source.fd, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) {
        pair_close(p, PAIR_ENDED);
        return size;
    }
    return sent > 0 ? (size_t)sent : 0;
}

static void waiting_send(struct local_pair *p)
{
    size_t sent = bytes_send(p, p->waiting + p->from, p->to - p->from);
    if (p->state != PAIR_OPEN) {
        return;
    }
    p->from += sent;
    if (p->from == p->to) {
        dds_free(p->waiting);
        p->waiting = NULL;
        p->size = p->from = p->to = p->begun = 0;
        local_change(p->writer->bus, &p->source, 0);
    }
}

/* Makes the free room one piece. */
static void waiting_close_up(struct local_pair *p)
{
    memmove(p->waiting, p->waiting + p->from, p->to - p->from);
    p->to -= p->from;
    p->begun -= p->begun < p->from ? p->begun : p->from;
    p->from = 0;
}

static void waiting_add(struct local_pair *p, const char *data, size_t size)
{
    if (p->from == p->to) {
        local_change(p->writer->bus, &p->source, EPOLLOUT);
    }
    if (p->from > 0 && p->to + size > p->size) {
        waiting_close_up(p);
    }
    if (p->to + size > p->size) {
        p->size = 2 * (p->to + size);
        p->waiting = dds_realloc(p->waiting, p->size);
    }
    memcpy(p->waiting + p->to, data, size);
    p->to += size;
}

/* Where the last sample alone counts, those that wait are let go, but for one that has begun. */
static void waiting_trim(struct local_pair *p)
{
    p->begun = p->begun < p->from ? p->to : p->begun;
    p->to = p->begun;
}

static void pair_write(struct local_pair *p, const char *frame, size_t size)
{
    if (p->from < p->to && !topic_table[p->writer->topic].keeps_all) {
        waiting_trim(p);
    }
    size_t sent = p->from == p->to ? bytes_send(p, frame, size) : 0;
    if (sent < size) {
        waiting_add(p, frame + sent, size - sent);
        p->begun = sent > 0 ? p->to : p->begun;
    }
}

void local_writer_ready(struct local_source *source, uint32_t events)
{
    struct local_pair *p = (struct local_pair *)source;
    if (p->state == PAIR_ASKED) {
        answer_take(p);
    } else if (events & (EPOLLHUP | EPOLLERR)) {
        pair_close(p, PAIR_ENDED);
    } else {
        waiting_send(p);
    }
}

/* --- the pairs of a writer -------------------------------------------------------------------- */

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
    pair_close(p, PAIR_ENDED);
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
        pair_ask(p);
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
            pair_close(p, PAIR_ON_DDS);
        }
    }
    return p->state != PAIR_ASKED;
}

bool local_has_room(struct local_writer *o)
{
    bool room = true;
    writer_match(o);
    for (struct local_pair *p = o->pairs; p; p = p->next) {
        if (p->to - p->from > WAITING_MAX) {
            waiting_send(p);
        }
        room = pair_settle(p) && p->to - p->from <= WAITING_MAX && room;
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
            pair_write(p, frame, size);
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
