/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/bus.h"

#include "bus/bus_arrivals.h"
#include "bus/bus_fault.h"
#include "bus/cdr.h"
#include "bus/local.h"
#include "bus/topics.h"
#include "core/clock.h"
#include "muster/memory.h"

#include <string.h>

mu_result bus_reader_open(struct bus *bus, enum bus_topic topic, const char *partition,
                          struct bus_reader *reader)
{
    return bus_reader_open_deep(bus, topic, partition, 0, reader);
}

mu_result bus_reader_open_deep(struct bus *bus, enum bus_topic topic, const char *partition,
                               int32_t depth, struct bus_reader *reader)
{
    *reader = (struct bus_reader){.bus = bus, .topic = topic};
    dds_entity_t about = topics_open(bus, topic, partition);
    if (about < 0) {
        return bus_fault(topic_table[topic].name, about);
    }
    for (int i = 0; i < BUS_BATCH; i++) {
        reader->samples[i] = bus_sample(topic);
    }
    dds_qos_t *group = dds_create_qos();
    dds_qset_partition1(group, partition ? partition : "");
    dds_entity_t subscriber = dds_create_subscriber(bus->participant, group, NULL);
    dds_delete_qos(group);
    if (subscriber < 0) {
        return bus_fault("subscriber", subscriber);
    }
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    if (depth > 0) {
        dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
    }
    dds_listener_t *listener = dds_create_listener(reader);
    dds_lset_data_available(listener, bus_arrivals_note);
    dds_lset_subscription_matched(listener, bus_arrivals_meet);
    local_reader_open(reader, qos);
    reader->reader = dds_create_reader(subscriber, about, qos, listener);
    dds_delete_listener(listener);
    dds_delete_qos(qos);
    if (reader->reader < 0) {
        local_reader_close(reader);
        dds_delete(subscriber);
        return bus_fault("reader", reader->reader);
    }
    return MU_OK;
}

mu_result bus_writer_open(struct bus *bus, enum bus_topic topic, const char *first,
                          const char *second, struct bus_writer *writer)
{
    *writer = (struct bus_writer){.bus = bus, .topic = topic};
    if (!second && local_writer_share(writer, first)) {
        return MU_OK;
    }
    dds_entity_t made = topics_writer(bus, topic, first, second);
    if (made < 0) {
        *writer = (struct bus_writer){0}; /* the caller tries again, each round if need be */
        return bus_fault(topic_table[topic].name, made);
    }
    writer->writer = made;
    local_writer_open(writer, first, second);
    return MU_OK;
}

void bus_writer_close(struct bus_writer *writer)
{
    local_writer_close(writer);
    topics_writer_delete(writer->writer);
    *writer = (struct bus_writer){0};
}

/* @return the writer on DDS, 0: there is none, as no reader needs it */
static dds_entity_t bus_writer_on_dds(const struct bus_writer *w)
{
    return w->local ? local_on_dds(w->local) : w->writer;
}

static mu_result written(dds_return_t code)
{
    return code == DDS_RETCODE_OK        ? MU_OK
           : code == DDS_RETCODE_TIMEOUT ? MU_BUSY
                                         : bus_fault("write", code);
}

mu_result bus_write(const struct bus_writer *writer, const void *sample)
{
    const struct topic *topic = &topic_table[writer->topic];
    struct local_writer *local = writer->local;
    if (!topic->local) {
        return written(dds_write(writer->writer, sample));
    }
    if (local && !local_has_room(local)) {
        return MU_BUSY;
    }
    writer->bus->wrote = true;
    struct cdr_room *room = &writer->bus->room;
    size_t end = cdr_frame(room, sample, topic->descriptor->m_ops);
    mu_result result = MU_OK;
    if (!local || local_needs_dds(local)) {
        dds_time_t now = local ? local_stamp(local) : dds_time();
        result = written(cdr_frame_write(bus_writer_on_dds(writer), room->at, end, now));
    }
    if (local && result == MU_OK) {
        local_write(local, room->at);
    }
    return result;
}

void bus_dispose(const struct bus_writer *writer, const void *sample)
{
    dds_return_t code = dds_dispose(writer->writer, sample);
    if (code < 0 && code != DDS_RETCODE_TIMEOUT) {
        (void)bus_fault("dispose", code);
    }
}

enum { BATCHES_TO_EMPTY = 4096 };

/* The samples are ours: DDS writes the next ones over them and takes memory only for what is larger
 * than what was there.  Now and then they are emptied, or each would be as large as the largest. */
static void samples_empty(struct bus_reader *r)
{
    const dds_topic_descriptor_t *d = topic_table[r->topic].descriptor;
    for (int i = 0; i < BUS_BATCH; i++) {
        dds_sample_free(r->samples[i], d, DDS_FREE_CONTENTS);
        memset(r->samples[i], 0, d->m_size);
    }
}

void bus_reader_close(struct bus_reader *r)
{
    if (r->reader <= 0) {
        return;
    }
    dds_delete(dds_get_parent(r->reader)); /* its subscriber, and it: nothing arrives any more */
    r->reader = 0;
    local_reader_close(r);
    bus_arrivals_taken(r, r->arrived); /* the samples that lie there are not looked at */
    samples_empty(r);
    r->count = r->next = 0;
}

/* Not handed out: it comes, or came, by a socket, too. */
static const uint32_t SAMPLE_SEEN = BUS_LOST + 1;

/* What one sample of a batch says.  When its writer went while it lay unread, DDS has no other
 * sample to say so: then the last one of its instance is handed out once more, as its end. */
static void sample_judge(struct bus_reader *r, int32_t i, const dds_sample_info_t *info)
{
    enum bus_life fate = info->instance_state == DDS_IST_ALIVE                ? BUS_DATA
                         : info->instance_state == DDS_IST_NOT_ALIVE_DISPOSED ? BUS_DISPOSED
                                                                              : BUS_LOST;
    r->states[i] = info->valid_data ? BUS_DATA : fate;
    r->fates[i] = info->valid_data && info->sample_rank == 0 ? fate : BUS_DATA;
    if (r->strangers > 0 && bus_reader_is_stranger(r, info->publication_handle)) {
        r->states[i] = SAMPLE_SEEN;
    }
    if (info->valid_data && local_has(r, info)) {
        r->states[i] = SAMPLE_SEEN;
    }
}

/* Takes the next batch.  What sockets have brought by the time that a sample of DDS is handed out
 * is read before: a process that leaves has written its last words there before.
 * @return whether there is anything in it */
static bool batch_take(struct bus_reader *r)
{
    r->next = 0;
    r->count = r->bus->local_frames > 0 ? local_take(r) : 0;
    if (r->count > 0) {
        return true;
    }
    uint64_t arrived;
    if (!bus_arrivals_are_news(r, &arrived)) {
        return false;
    }
    dds_sample_info_t infos[BUS_BATCH];
    if (++r->batches % BATCHES_TO_EMPTY == 0) {
        samples_empty(r);
    }
    int32_t count = dds_take(r->reader, r->samples, infos, BUS_BATCH, BUS_BATCH);
    r->count = count > 0 ? count : 0;
    if (r->count < BUS_BATCH) {
        bus_arrivals_taken(r, arrived);
    }
    if (r->count > 0 && r->bus->local) {
        bus_arrivals_poll(r->bus, 0);
    }
    for (int32_t i = 0; i < r->count; i++) {
        sample_judge(r, i, &infos[i]);
    }
    return r->count > 0;
}

/* @return whether the sample that was handed out last is to be said to have ended */
static bool end_is_due(const struct bus_reader *r)
{
    return r->next > 0 && r->states[r->next - 1] == BUS_DATA && r->fates[r->next - 1] != BUS_DATA;
}

const void *bus_next(struct bus_reader *r, enum bus_life *life)
{
    for (;;) {
        if (end_is_due(r)) {
            int32_t last = r->next - 1;
            *life = (enum bus_life)(r->states[last] = r->fates[last]);
            return r->samples[last];
        }
        if (r->next == r->count && !batch_take(r)) {
            return NULL;
        }
        int32_t i = r->next++;
        if (r->states[i] == SAMPLE_SEEN) {
            continue;
        }
        enum bus_life state = (enum bus_life)r->states[i];
        if (state != BUS_DATA || topic_table[r->topic].check(r->samples[i])) {
            *life = state;
            return r->samples[i];
        }
        r->bus->malformed++;
    }
}

void *bus_sample(enum bus_topic topic)
{
    return mu_startup_alloc(topic_table[topic].descriptor->m_size);
}

void *bus_keep(struct bus_reader *r, void *spare)
{
    void *kept = r->samples[r->next - 1];
    r->samples[r->next - 1] = spare;
    r->fates[r->next - 1] = BUS_DATA; /* there is nothing left to say it of */
    return kept;
}

/* That a reader has read is no news: it is looked for this often. */
static const int64_t DRAIN_LOOK_NS = 1000000;

bool bus_drain(const struct bus_writer *writer, int64_t timeout_ns)
{
    uint64_t until_ns = mu_clock_ns() + (timeout_ns > 0 ? (uint64_t)timeout_ns : 0);
    int64_t left_ns = timeout_ns;
    while (writer->local && !local_is_out(writer->local) && left_ns > 0) {
        bus_arrivals_poll(writer->bus, left_ns < DRAIN_LOOK_NS ? left_ns : DRAIN_LOOK_NS);
        left_ns = (int64_t)(until_ns - mu_clock_ns());
    }
    dds_entity_t on_dds = bus_writer_on_dds(writer);
    return (!writer->local || local_is_out(writer->local)) &&
           (on_dds == 0 || dds_wait_for_acks(on_dds, left_ns > 0 ? left_ns : 0) == DDS_RETCODE_OK);
}
