/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"

#include "bus/topics.h"

#include <stdlib.h>
#include <string.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsc/dds_rhc.h>

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

bool feed_topic(const char *name, const char *type, enum bus_topic *topic)
{
    for (int i = 0; i < BUS_TOPICS; i++) {
        bool same_type = !type || strcmp(topic_table[i].descriptor->m_typename, type) == 0;
        if (same_type && strcmp(topic_table[i].name, name) == 0) {
            *topic = (enum bus_topic)i;
            return true;
        }
    }
    return false;
}

/* --- what DDS makes samples of bytes with ----------------------------------------------------- */

/* A history of a reader that keeps nothing: DDS tells it what the type is. */
struct witness {
    struct dds_rhc base;
    const struct ddsi_sertype *type; /* the topic holds it */
};

static dds_return_t witness_associate(struct dds_rhc *rhc, struct dds_reader *reader,
                                      const struct ddsi_sertype *type, struct ddsi_tkmap *map)
{
    (void)reader;
    (void)map;
    ((struct witness *)(void *)rhc)->type = type;
    return DDS_RETCODE_OK;
}

static bool witness_store(struct ddsi_rhc *rhc, const struct ddsi_writer_info *writer,
                          struct ddsi_serdata *sample, struct ddsi_tkmap_instance *instance)
{
    (void)rhc;
    (void)writer;
    (void)sample;
    (void)instance;
    return true;
}

static void witness_unregister(struct ddsi_rhc *rhc, const struct ddsi_writer_info *writer)
{
    (void)rhc;
    (void)writer;
}

static void witness_relinquish(struct ddsi_rhc *rhc, const uint64_t writer)
{
    (void)rhc;
    (void)writer;
}

static void witness_qos(struct ddsi_rhc *rhc, const dds_qos_t *qos)
{
    (void)rhc;
    (void)qos;
}

static void witness_free(struct ddsi_rhc *rhc)
{
    (void)rhc; /* it is ours */
}

static const struct dds_rhc_ops witness_ops = {
    .rhc_ops = {.store = witness_store,
                .unregister_wr = witness_unregister,
                .relinquish_ownership = witness_relinquish,
                .set_qos = witness_qos,
                .free = witness_free},
    .associate = witness_associate,
};

static dds_qos_t *group_qos(const char *const *partitions, size_t count)
{
    dds_qos_t *qos = dds_create_qos();
    MU_ASSERT(qos);
    dds_qset_partition(qos, (uint32_t)count, (const char **)(uintptr_t)partitions);
    return qos;
}

/* Opens a reader of the topic where no process writes, and closes it again. */
static const struct ddsi_sertype *type_find(const struct bus *bus, dds_entity_t topic)
{
    static struct witness witness; /* a reader that goes is done with it later */
    static const char *const nowhere[] = {"muster.feed.nowhere"};
    witness = (struct witness){.base.common.ops = &witness_ops};
    dds_qos_t *group = group_qos(nowhere, 1);
    dds_entity_t subscriber = dds_create_subscriber(bus->participant, group, NULL);
    (void)dds_create_reader_rhc(subscriber, topic, NULL, NULL, &witness.base);
    (void)dds_delete(subscriber);
    dds_delete_qos(group);
    return witness.type;
}

/* --- feeds ------------------------------------------------------------------------------------ */

static mu_result writer_open(struct feed *feed, const struct bus *bus, dds_entity_t topic,
                             const dds_qos_t *group, const dds_qos_t *qos)
{
    feed->type = topic > 0 ? type_find(bus, topic) : NULL;
    dds_entity_t publisher = dds_create_publisher(bus->participant, group, NULL);
    feed->out.writer = dds_create_writer(publisher, topic, qos, NULL);
    return feed->type && feed->out.writer > 0 ? MU_OK : MU_FAULT_DDS;
}

/* Nothing is overwritten that a reader does not have; a late reader gets what it would have. */
static void history_widen(dds_qos_t *qos, dds_history_kind_t kind, int32_t depth)
{
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_durability_service(qos, 0, kind, depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
}

mu_result feed_open(struct feed *feed, struct bus *bus, enum bus_topic topic, const char *first,
                    const char *second)
{
    const char *partitions[] = {first ? first : "", second};
    *feed = (struct feed){0};
    int32_t *described = &bus->topics[topic][true];
    if (*described <= 0) {
        *described = dds_create_topic(bus->participant, topic_table[topic].descriptor,
                                      topic_table[topic].name, NULL, NULL);
    }
    dds_qos_t *group = group_qos(partitions, second ? 2 : 1);
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    history_widen(qos, DDS_HISTORY_KEEP_LAST, topics_depth(&topic_table[topic]));
    mu_result opened = writer_open(feed, bus, *described, group, qos);
    dds_delete_qos(group);
    dds_delete_qos(qos);
    return opened;
}

/* As the writer was, but that it is reliable, and that an instance goes only when it is said. */
static dds_qos_t *foreign_qos(const char *words)
{
    dds_history_kind_t kind = DDS_HISTORY_KEEP_LAST;
    int32_t depth = 1;
    dds_qos_t *qos = dds_create_qos();
    MU_ASSERT(qos);
    offer_read(words, qos);
    (void)dds_qget_history(qos, &kind, &depth);
    history_widen(qos, kind, depth);
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
    dds_qset_writer_data_lifecycle(qos, false);
    return qos;
}

mu_result feed_open_foreign(struct feed *feed, struct bus *bus, const struct feed_foreign *of)
{
    dds_entity_t topic = 0;
    *feed = (struct feed){0};
    mu_result made = type_bytes_topic(bus->participant, of->type_bytes, of->type_size, of->topic,
                                      of->type, &topic);
    if (made != MU_OK) {
        return made < 0 ? MU_REFUSED : made;
    }
    dds_qos_t *group = group_qos(of->partitions, of->partition_count);
    dds_qos_t *qos = foreign_qos(of->words);
    offer_read(of->words, group); /* of it, how samples are presented is the publisher's */
    mu_result opened = writer_open(feed, bus, topic, group, qos);
    dds_delete_qos(group);
    dds_delete_qos(qos);
    return opened == MU_OK ? MU_OK : MU_REFUSED;
}

/* --- samples ---------------------------------------------------------------------------------- */

static struct ddsi_serdata *sample_make(const struct feed *feed, enum ddsi_serdata_kind kind,
                                        const void *bytes, size_t size)
{
    /* Nothing is written through it. */
    ddsrt_iovec_t all = {.iov_base = (void *)(uintptr_t)bytes, .iov_len = size};
    return size >= 4 ? ddsi_serdata_from_ser_iov(feed->type, kind, 1, &all, size) : NULL;
}

static mu_result result_of(dds_return_t code)
{
    return code == DDS_RETCODE_OK ? MU_OK : code == DDS_RETCODE_TIMEOUT ? MU_BUSY : MU_FAULT_DDS;
}

mu_result feed_write(struct feed *feed, const void *bytes, size_t size)
{
    struct ddsi_serdata *data = sample_make(feed, SDK_DATA, bytes, size);
    if (!data) {
        return MU_MALFORMED;
    }
    return result_of(dds_writecdr(feed->out.writer, data)); /* it takes the sample over */
}

mu_result feed_gone(struct feed *feed, enum gone_what what, const void *key, size_t size)
{
    struct ddsi_serdata *data = sample_make(feed, SDK_KEY, key, size);
    if (!data) {
        return MU_MALFORMED;
    }
    void *sample = ddsi_sertype_alloc_sample(feed->type);
    mu_result told = MU_MALFORMED;
    if (ddsi_serdata_to_sample(data, sample, NULL, NULL)) {
        told = result_of(what == GONE_DISPOSED ? dds_dispose(feed->out.writer, sample)
                                               : dds_unregister_instance(feed->out.writer, sample));
    }
    ddsi_sertype_free_sample(feed->type, sample, DDS_FREE_ALL);
    ddsi_serdata_unref(data);
    return told;
}
