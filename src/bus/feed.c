/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/feed.h"

#include "bus/topics.h"
#include "core/clock.h"

#include <stdlib.h>
#include <string.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsi/ddsi_serdata.h>

static const uint64_t PATIENCE_NS = 1000000000;
static const dds_duration_t PAUSE_NS = 1000000;

bool feed_topic(const char *name, enum bus_topic *topic)
{
    for (int i = 0; i < BUS_TOPICS; i++) {
        if (strcmp(topic_table[i].name, name) == 0) {
            *topic = (enum bus_topic)i;
            return true;
        }
    }
    return false;
}

/* A publisher or subscriber whose only partitions are these. */
static dds_qos_t *group_qos(const char *first, const char *second)
{
    const char *partitions[] = {first ? first : "", second};
    dds_qos_t *qos = dds_create_qos();
    dds_qset_partition(qos, second ? 2 : 1, partitions);
    return qos;
}

static dds_qos_t *writer_qos(enum bus_topic topic)
{
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    if (!topic_table[topic].for_late_comers) { /* else old samples would stay for ever */
        dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    }
    return qos;
}

/* What DDS makes a sample of bytes with is in no interface, but in every sample that it has made.
 */
static const struct ddsi_sertype *type_read(dds_entity_t reader)
{
    const struct ddsi_sertype *type = NULL;
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (!type && mu_clock_ns() < until_ns) {
        struct ddsi_serdata *data[1];
        dds_sample_info_t info[1];
        if (dds_takecdr(reader, data, 1, info, DDS_ANY_STATE) == 1) {
            type = data[0]->type; /* the topic holds it */
            ddsi_serdata_unref(data[0]);
        } else {
            dds_sleepfor(PAUSE_NS);
        }
    }
    return type;
}

/* Writes an empty sample to ourselves alone, and looks at it.  A writer's partition with a wildcard
 * in it is passed over by readers of "*", such as taps. */
static const struct ddsi_sertype *type_find(struct bus *bus, enum bus_topic topic)
{
    static union {
        char bytes[4096];
        long double aligned;
    } empty;
    MU_ASSERT(topic_table[topic].descriptor->m_size <= sizeof empty);
    dds_qos_t *of_writer = group_qos("muster.feed.sel?", NULL);
    dds_qos_t *of_reader = group_qos("muster.feed.self", NULL);
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    dds_entity_t publisher = dds_create_publisher(bus->participant, of_writer, NULL);
    dds_entity_t subscriber = dds_create_subscriber(bus->participant, of_reader, NULL);
    dds_entity_t writer = dds_create_writer(publisher, bus->topics[topic], qos, NULL);
    dds_entity_t reader = dds_create_reader(subscriber, bus->topics[topic], qos, NULL);
    dds_delete_qos(of_writer);
    dds_delete_qos(of_reader);
    dds_delete_qos(qos);
    bool written = reader > 0 && dds_write(writer, empty.bytes) == DDS_RETCODE_OK;
    const struct ddsi_sertype *type = written ? type_read(reader) : NULL;
    (void)dds_delete(publisher);
    (void)dds_delete(subscriber);
    return type;
}

mu_result feed_open(struct feed *feed, struct bus *bus, enum bus_topic topic, const char *first,
                    const char *second)
{
    *feed = (struct feed){.topic = topic};
    if (!bus->topics[topic]) {
        bus->topics[topic] = dds_create_topic(bus->participant, topic_table[topic].descriptor,
                                              topic_table[topic].name, NULL, NULL);
    }
    feed->type = bus->topics[topic] > 0 ? type_find(bus, topic) : NULL;
    dds_qos_t *group = group_qos(first, second);
    dds_qos_t *qos = writer_qos(topic);
    feed->out.publisher = dds_create_publisher(bus->participant, group, NULL);
    feed->out.writer = dds_create_writer(feed->out.publisher, bus->topics[topic], qos, NULL);
    dds_delete_qos(group);
    dds_delete_qos(qos);
    return feed->type && feed->out.writer > 0 ? MU_OK : MU_FAULT_DDS;
}

mu_result feed_write(struct feed *feed, const void *bytes, size_t size)
{
    /* Nobody writes through it. */
    ddsrt_iovec_t all = {.iov_base = (void *)(uintptr_t)bytes, .iov_len = size};
    struct ddsi_serdata *data =
        size >= 4 ? ddsi_serdata_from_ser_iov(feed->type, SDK_DATA, 1, &all, size) : NULL;
    if (!data) {
        return MU_MALFORMED;
    }
    dds_return_t code = dds_writecdr(feed->out.writer, data); /* it takes the sample over */
    if (code == DDS_RETCODE_OK) {
        return MU_OK;
    }
    return code == DDS_RETCODE_TIMEOUT ? MU_BUSY : MU_FAULT_DDS;
}
