/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local_frame.h"
#include "bus/local_pair.h"
#include "bus/local_shared.h"
#include "bus/topics.h"
#include "core/clock.h"

#include <linux/sockios.h>
#include <sys/ioctl.h>

/* So long a sample waits for the answer of a reader; then the pair stays with DDS.  A reader that
 * runs answers between two samples. */
static const uint64_t ANSWER_NS = 500000000;

static void writer_note(struct bus_writer *w, const char *last, const char *partition)
{
    struct bus *bus = w->bus;
    struct local_writer *o = local_memory(sizeof *o);
    *o = (struct local_writer){.bus = bus,
                               .next = bus->locals,
                               .topic = w->topic,
                               .last = last,
                               .partition = partition ? dds_string_dup(partition) : NULL,
                               .writer = w->writer,
                               .stale = true,
                               .seen = atomic_load(&bus->matches) - 1};
    bus->locals = w->local = o;
}

void local_writer_open(struct bus_writer *w, const char *first, const char *last)
{
    if (!w->bus->local || !topic_table[w->topic].local) {
        return;
    }
    writer_note(w, last, NULL);
    if (!w->bus->shared && first && strcmp(first, BUS_TO_ALL) == 0) {
        local_shared_open(w->bus, w->topic);
    }
}

bool local_writer_share(struct bus_writer *w, const char *partition)
{
    bool shares = w->bus->shared && w->bus->shared->topic == w->topic && partition;
    if (shares) {
        writer_note(w, NULL, partition);
    }
    return shares;
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
    dds_free(o->partition);
    dds_free(o);
}

void local_writer_close(struct bus_writer *w)
{
    struct local_writer *o = w->local;
    if (o) {
        struct local_writer **at = &w->bus->locals;
        while (*at != o) {
            at = &(*at)->next;
        }
        *at = o->next;
        topics_writer_delete(o->writer);
        writer_free(o);
        *w = (struct bus_writer){0};
    }
}

void local_writers_close(struct bus *bus)
{
    for (struct local_writer *o; (o = bus->locals);) {
        bus->locals = o->next;
        writer_free(o);
    }
    local_shared_close(bus);
}

/* --- the pairs of a writer -------------------------------------------------------------------- */

/* @return a pair with a reader that a writer has found; NULL: it misses it already */
static struct local_pair *pair_add(struct local_writer *o, dds_entity_t finder,
                                   dds_instance_handle_t reader, enum pair_match match)
{
    dds_builtintopic_endpoint_t *about = dds_get_matched_subscription_data(finder, reader);
    if (!about) {
        return NULL;
    }
    struct local_pair *p = local_memory(sizeof *p);
    *p = (struct local_pair){
        .source = {LOCAL_OUTPUT, -1}, .writer = o, .reader = reader, .match = match};
    local_pair_ask(p, about);
    dds_builtintopic_free_endpoint(about);
    struct local_pair **at = &o->pairs;
    while (*at && p->last) {
        at = &(*at)->next;
    }
    p->next = *at;
    *at = p;
    o->ever++;
    return p;
}

static void pair_keep(struct local_writer *o, dds_entity_t finder, dds_instance_handle_t reader,
                      enum pair_match match)
{
    struct local_pair *p = o->pairs;
    while (p && p->reader != reader) {
        p = p->next;
    }
    p = p ? p : pair_add(o, finder, reader, match);
    if (!p) {
        o->stale = true; /* DDS has not matched it yet */
        return;
    }
    if (match > p->match) {
        p->match = match;
        p->state = p->state == PAIR_LEAVES ? PAIR_ON_DDS : p->state;
        o->ever++;
    }
    p->met = o->seen;
}

static void pairs_drop(struct local_writer *o)
{
    struct local_pair *p;
    for (struct local_pair **at = &o->pairs; (p = *at);) {
        if (p->met == o->seen) {
            at = &p->next;
        } else {
            *at = p->next;
            pair_free(p);
        }
    }
}

/* @return whether a reader gets its samples by DDS, or is to get them so */
static bool is_wanted_on_dds(const struct local_writer *o)
{
    bool is_wanted = false;
    for (const struct local_pair *p = o->pairs; p; p = p->next) {
        is_wanted = is_wanted || p->state == PAIR_ON_DDS || p->state == PAIR_LEAVES;
    }
    return is_wanted;
}

/* One that shares goes onto DDS. */
static void writer_go(struct local_writer *o)
{
    dds_entity_t writer = topics_writer(o->bus, o->topic, o->partition, NULL);
    o->writer = writer > 0 ? writer : 0;
    o->stale = !o->writer; /* the next look tries again */
}

static void pairs_keep(struct local_writer *o)
{
    dds_instance_handle_t readers[BUS_ENDPOINTS_MAX];
    struct local_shared *shared = o->partition ? o->bus->shared : NULL;
    uint32_t found =
        shared ? local_shared_readers(shared, o->partition, readers, BUS_ENDPOINTS_MAX) : 0;
    for (uint32_t i = 0; i < found; i++) {
        pair_keep(o, shared->writer, readers[i], PAIR_FOUND);
    }
    dds_return_t count =
        o->writer ? dds_get_matched_subscriptions(o->writer, readers, BUS_ENDPOINTS_MAX) : 0;
    for (dds_return_t i = 0; i < count && i < BUS_ENDPOINTS_MAX; i++) {
        pair_keep(o, o->writer, readers[i], PAIR_SERVED);
    }
}

static void writer_look(struct local_writer *o)
{
    o->stale = false;
    pairs_keep(o);
    pairs_drop(o);
    if (!o->writer && (is_wanted_on_dds(o) || o->bus->shared->patterns > 0)) {
        writer_go(o);
    }
}

/* One that shares is told which readers come and go, and asks DDS only while it is there itself. */
static void writer_match(struct local_writer *o)
{
    uint32_t matches = atomic_load(&o->bus->matches);
    if (o->seen == matches) {
        return;
    }
    o->seen = matches;
    if (o->partition) {
        local_shared_look(o->bus->shared);
    }
    if (o->writer || o->stale || o->bus->shared->patterns > 0) {
        writer_look(o);
    }
}

void local_match(struct bus *bus)
{
    for (struct local_writer *o = bus->locals; o; o = o->next) {
        writer_match(o);
    }
}

/* @return whether DDS has matched it with the writer that it gets its samples from */
static bool pair_counts(const struct local_pair *p)
{
    return p->match == PAIR_SERVED || p->state != PAIR_ON_DDS;
}

uint32_t local_matches(struct local_writer *o)
{
    uint32_t count = 0;
    writer_match(o);
    for (const struct local_pair *p = o->pairs; p; p = p->next) {
        count += pair_counts(p);
    }
    return count;
}

uint32_t local_matched_ever(struct local_writer *o)
{
    writer_match(o);
    return o->ever;
}

bool local_process_find(struct local_writer *o, const char *partition, dds_guid_t *process)
{
    bool found = false;
    writer_match(o);
    for (const struct local_pair *p = o->pairs; p; p = p->next) {
        bool is_its = p->named && pair_counts(p) && strcmp(o->partition, partition) == 0;
        if (is_its && (!found || p->state != PAIR_ON_DDS)) { /* or it may be a tool */
            *process = p->process;
            found = true;
        }
    }
    return found;
}

/* --- writing ---------------------------------------------------------------------------------- */

static bool pair_waits(const struct local_pair *p)
{
    return p->state == PAIR_ASKED || p->state == PAIR_LEAVES;
}

/* @return whether the pair is settled: the reader has answered, or has had its time */
static bool pair_settle(struct local_pair *p)
{
    uint64_t now_ns = pair_waits(p) ? mu_clock_ns() : 0;
    p->asked_ns = p->asked_ns ? p->asked_ns : now_ns;
    if (pair_waits(p) && now_ns - p->asked_ns > ANSWER_NS) {
        p->state == PAIR_ASKED ? local_pair_leave(p) : local_pair_close(p, PAIR_ON_DDS);
    }
    return !pair_waits(p);
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
    return o->writer && is_wanted_on_dds(o);
}

dds_entity_t local_on_dds(const struct local_writer *o)
{
    return o->writer;
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
            ways->dds += p->state == PAIR_ON_DDS || p->state == PAIR_LEAVES;
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
