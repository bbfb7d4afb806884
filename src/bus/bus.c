/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/bus.h"

#include "bus/config.h"
#include "bus/loopback.h"
#include "bus/topics.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mu_result dds_fault(const char *what, dds_return_t code)
{
    fprintf(stderr, "DDS: %s: %s\n", what, dds_strretcode(code));
    return MU_FAULT_DDS;
}

int bus_port(int domain, int index)
{
    return 7400 + 250 * domain + 10 + 2 * index;
}

/* A taken index makes Cyclone print an error; we go on to the next one, so nobody should read it. */
static void log_nothing(void *arg, const dds_log_data_t *data)
{
    (void)arg;
    (void)data;
}

static dds_return_t domain_create(const struct bus_options *options, int index)
{
    char buffer[4096];
    struct mu_text xml;
    mu_text_init(&xml, buffer, sizeof buffer);
    config_write(&xml, options, index);
    MU_ASSERT(!xml.cut);

    struct in_addr address;
    const char *interface = options->interface ? options->interface : "127.0.0.1";
    bool is_loopback = inet_pton(AF_INET, interface, &address) == 1 &&
                       (ntohl(address.s_addr) >> 24) == 127;
    if (is_loopback) {
        loopback_begin(ntohl(address.s_addr));
    }
    dds_entity_t domain = dds_create_domain((dds_domainid_t)options->domain, buffer);
    loopback_end();
    return domain;
}

/* Never goes on after a failure: the participant would come up on all interfaces. */
static mu_result domain_open(const struct bus_options *options)
{
    bool is_hub = options->place == BUS_BROKER || options->place == BUS_SIMULATOR;
    int first = options->place == BUS_BROKER      ? CONFIG_INDEX_BROKER
                : options->place == BUS_SIMULATOR ? CONFIG_INDEX_SIMULATOR
                                                  : CONFIG_INDEX_FIRST;
    int last = is_hub ? first : CONFIG_INDEX_LAST;
    dds_return_t code = DDS_RETCODE_ERROR;
    dds_set_log_sink(log_nothing, NULL);
    for (int index = first; index <= last && code < 0; index++) {
        code = domain_create(options, index);
    }
    dds_set_log_sink(NULL, NULL);
    if (code >= 0) {
        return MU_OK;
    }
    return is_hub ? MU_BUSY : dds_fault("no participant index is free from 10 to 119", code);
}

mu_result bus_open(struct bus *bus, const struct bus_options *options)
{
    *bus = (struct bus){0};
    const char *uri = getenv("CYCLONEDDS_URI");
    if (!uri || !uri[0]) {
        mu_result opened = domain_open(options);
        if (opened != MU_OK) {
            return opened;
        }
    }
    dds_qos_t *qos = dds_create_qos();
    dds_qset_entity_name(qos, options->name);
    bus->participant = dds_create_participant((dds_domainid_t)options->domain, qos, NULL);
    dds_delete_qos(qos);
    if (bus->participant < 0) {
        return dds_fault("participant", bus->participant);
    }
    bus->waitset = dds_create_waitset(bus->participant);
    return bus->waitset < 0 ? dds_fault("waitset", bus->waitset) : MU_OK;
}

void bus_close(struct bus *bus)
{
    dds_delete(bus->participant);
    bus->participant = 0;
}

static mu_result topic_open(struct bus *bus, enum bus_topic topic)
{
    if (bus->topics[topic]) {
        return MU_OK;
    }
    const struct topic *t = &topic_table[topic];
    dds_entity_t made = dds_create_topic(bus->participant, t->descriptor, t->name, NULL, NULL);
    if (made < 0) {
        return dds_fault(t->name, made);
    }
    bus->topics[topic] = made;
    return MU_OK;
}

mu_result bus_reader_open(struct bus *bus, enum bus_topic topic, const char *partition,
                          struct bus_reader *reader)
{
    *reader = (struct bus_reader){.bus = bus, .topic = topic};
    MU_TRY(topic_open(bus, topic));
    dds_qos_t *group = dds_create_qos();
    dds_qset_partition1(group, partition ? partition : "");
    dds_entity_t subscriber = dds_create_subscriber(bus->participant, group, NULL);
    dds_delete_qos(group);
    if (subscriber < 0) {
        return dds_fault("subscriber", subscriber);
    }
    dds_qos_t *qos = topic_qos(&topic_table[topic]);
    reader->reader = dds_create_reader(subscriber, bus->topics[topic], qos, NULL);
    dds_delete_qos(qos);
    if (reader->reader < 0) {
        return dds_fault("reader", reader->reader);
    }
    dds_entity_t condition = dds_create_readcondition(reader->reader, DDS_ANY_STATE);
    dds_return_t attached = dds_waitset_attach(bus->waitset, condition, reader->reader);
    return attached < 0 ? dds_fault("waitset", attached) : MU_OK;
}

mu_result bus_writer_open(struct bus *bus, enum bus_topic topic, const char *first,
                          const char *second, struct bus_writer *writer)
{
    *writer = (struct bus_writer){0};
    MU_TRY(topic_open(bus, topic));
    const char *partitions[] = {first ? first : "", second};
    dds_qos_t *group = dds_create_qos();
    dds_qset_partition(group, second ? 2 : 1, partitions);
    writer->publisher = dds_create_publisher(bus->participant, group, NULL);
    dds_delete_qos(group);
    if (writer->publisher < 0) {
        return dds_fault("publisher", writer->publisher);
    }
    dds_qos_t *qos = topic_qos(&topic_table[topic]);
    writer->writer = dds_create_writer(writer->publisher, bus->topics[topic], qos, NULL);
    dds_delete_qos(qos);
    return writer->writer < 0 ? dds_fault("writer", writer->writer) : MU_OK;
}

void bus_writer_close(struct bus_writer *writer)
{
    if (writer->publisher > 0) {
        dds_delete(writer->publisher); /* and its writer */
    }
    *writer = (struct bus_writer){0};
}

mu_result bus_write(const struct bus_writer *writer, const void *sample)
{
    dds_return_t code = dds_write(writer->writer, sample);
    if (code == DDS_RETCODE_OK) {
        return MU_OK;
    }
    return code == DDS_RETCODE_TIMEOUT ? MU_BUSY : dds_fault("write", code);
}

void bus_dispose(const struct bus_writer *writer, const void *sample)
{
    dds_return_t code = dds_dispose(writer->writer, sample);
    if (code < 0 && code != DDS_RETCODE_TIMEOUT) {
        (void)dds_fault("dispose", code);
    }
}

uint32_t bus_writer_matches(const struct bus_writer *writer)
{
    dds_publication_matched_status_t status;
    dds_return_t code = dds_get_publication_matched_status(writer->writer, &status);
    return code < 0 ? 0 : status.current_count;
}

uint32_t bus_reader_matches(const struct bus_reader *reader)
{
    dds_subscription_matched_status_t status;
    dds_return_t code = dds_get_subscription_matched_status(reader->reader, &status);
    return code < 0 ? 0 : status.current_count;
}

/* Gives the last batch back and takes the next one.  @return whether there is anything in it */
static bool batch_take(struct bus_reader *r)
{
    if (r->count > 0) {
        dds_return_loan(r->reader, r->samples, r->count);
    }
    dds_sample_info_t infos[BUS_BATCH];
    r->samples[0] = NULL; /* asks for a loan */
    r->next = 0;
    r->count = dds_take(r->reader, r->samples, infos, BUS_BATCH, BUS_BATCH);
    if (r->count <= 0) {
        r->count = 0;
        return false;
    }
    for (int32_t i = 0; i < r->count; i++) {
        r->states[i] = infos[i].valid_data                                       ? BUS_DATA
                       : infos[i].instance_state == DDS_IST_NOT_ALIVE_DISPOSED ? BUS_DISPOSED
                                                                               : BUS_LOST;
    }
    return true;
}

const void *bus_next(struct bus_reader *r, enum bus_life *life)
{
    for (;;) {
        if (r->next == r->count && !batch_take(r)) {
            return NULL;
        }
        int32_t i = r->next++;
        enum bus_life state = (enum bus_life)r->states[i];
        if (state != BUS_DATA || topic_table[r->topic].check(r->samples[i])) {
            *life = state;
            return r->samples[i];
        }
        r->bus->malformed++;
    }
}

void bus_wait(struct bus *bus, int64_t timeout_ns)
{
    dds_attach_t triggered[BUS_READERS_MAX];
    (void)dds_waitset_wait(bus->waitset, triggered, BUS_READERS_MAX, timeout_ns > 0 ? timeout_ns : 0);
}

bool bus_drain(const struct bus_writer *writer, int64_t timeout_ns)
{
    return dds_wait_for_acks(writer->writer, timeout_ns) == DDS_RETCODE_OK;
}
