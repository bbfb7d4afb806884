/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/local_shared.h"

#include "bus/local_frame.h"
#include "bus/local_pair.h"
#include "bus/topics.h"

/* A reader of the topic, of any process. */
struct local_found {
    struct local_found *next;
    dds_guid_t key;
    dds_instance_handle_t reader;
    uint32_t count; /* of partitions */
    char **partitions;
};

static void news_count(dds_entity_t news, void *bus)
{
    (void)news;
    atomic_fetch_add(&((struct bus *)bus)->matches, 1);
}

void local_shared_open(struct bus *bus, enum bus_topic topic)
{
    dds_entity_t writer = topics_writer(bus, topic, LOCAL_SHARED_PARTITION, NULL);
    dds_listener_t *listener = dds_create_listener(bus);
    dds_lset_data_available(listener, news_count);
    dds_entity_t news =
        dds_create_reader(bus->participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, NULL, listener);
    dds_delete_listener(listener);
    if (writer < 0 || news < 0) {
        topics_writer_delete(writer);
        (void)dds_delete(news);
        return;
    }
    bus->shared = local_memory(sizeof *bus->shared);
    *bus->shared = (struct local_shared){.bus = bus,
                                         .topic = topic,
                                         .writer = writer,
                                         .news = news,
                                         .seen = atomic_load(&bus->matches) - 1};
}

/* --- what is found ---------------------------------------------------------------------------- */

static void found_free(struct local_found *f)
{
    for (uint32_t i = 0; i < f->count; i++) {
        dds_free(f->partitions[i]);
    }
    dds_free(f->partitions);
    dds_free(f);
}

void local_shared_close(struct bus *bus)
{
    for (struct local_found *f = bus->shared ? bus->shared->found : NULL, *next; f; f = next) {
        next = f->next;
        found_free(f);
    }
    dds_free(bus->shared);
    bus->shared = NULL;
}

static bool names(const struct local_found *f, const char *partition)
{
    bool found = false;
    for (uint32_t i = 0; i < f->count; i++) {
        found = found || strcmp(f->partitions[i], partition) == 0;
    }
    return found;
}

/* What is written to its partitions has another reader now, or one less. */
static void writers_mark(struct local_shared *s, const struct local_found *f)
{
    for (struct local_writer *o = s->bus->locals; o; o = o->next) {
        o->stale = o->stale || (o->partition && names(f, o->partition));
    }
}

static void found_drop(struct local_shared *s, const dds_guid_t *key)
{
    struct local_found **at = &s->found, *f;
    while ((f = *at) && memcmp(&f->key, key, sizeof *key) != 0) {
        at = &f->next;
    }
    if (f) {
        *at = f->next;
        writers_mark(s, f);
        found_free(f);
    }
}

static uint32_t patterns_count(const struct local_shared *s)
{
    uint32_t patterns = 0;
    for (const struct local_found *f = s->found; f; f = f->next) {
        for (uint32_t i = 0; i < f->count; i++) {
            patterns += strpbrk(f->partitions[i], "*?") != NULL;
        }
    }
    return patterns;
}

static void news_take(struct local_shared *s, const dds_builtintopic_endpoint_t *reader,
                      const dds_sample_info_t *info)
{
    found_drop(s, &reader->key);
    if (!info->valid_data || info->instance_state != DDS_IST_ALIVE ||
        strcmp(reader->topic_name, topic_table[s->topic].name) != 0) {
        return;
    }
    struct local_found *f = local_memory(sizeof *f);
    *f =
        (struct local_found){.next = s->found, .key = reader->key, .reader = info->instance_handle};
    (void)dds_qget_partition(reader->qos, &f->count, &f->partitions);
    s->found = f;
    writers_mark(s, f);
}

void local_shared_look(struct local_shared *s)
{
    uint32_t matches = atomic_load(&s->bus->matches);
    if (s->seen == matches) {
        return;
    }
    s->seen = matches;
    void *news[BUS_BATCH] = {NULL};
    dds_sample_info_t infos[BUS_BATCH];
    int32_t count;
    while ((count = dds_take(s->news, news, infos, BUS_BATCH, BUS_BATCH)) > 0) {
        for (int32_t i = 0; i < count; i++) {
            news_take(s, news[i], &infos[i]);
        }
        (void)dds_return_loan(s->news, news, count);
        s->patterns = patterns_count(s);
    }
}

/* --- who reads what --------------------------------------------------------------------------- */

uint32_t local_shared_readers(const struct local_shared *s, const char *partition,
                              dds_instance_handle_t *readers, uint32_t most)
{
    uint32_t count = 0;
    for (const struct local_found *f = s->found; f && count < most; f = f->next) {
        if (names(f, partition)) {
            readers[count++] = f->reader;
        }
    }
    return count;
}
