/* SPDX-License-Identifier: Apache-2.0 */
/* The other sides of an endpoint, as DDS has found them. */
#include "bus/bus.h"
#include "bus/local.h"
#include "bus/local_shared.h"
#include "bus/local_token.h"
#include "bus/topics.h"
#include "wire.h"

#include <dds/dds.h>
#include <stdio.h>
#include <string.h>

/* @return whether it is open, and not by its own writer on DDS */
static bool bus_writer_is_shared(const struct bus_writer *writer)
{
    return writer->local && !writer->writer && writer->bus->participant > 0;
}

/* Finds the process that reads a partition by its name.  @return whether there is one */
static bool reader_find(const struct bus_writer *writer, const char *partition, dds_guid_t *process)
{
    if (bus_writer_is_shared(writer)) {
        return local_process_find(writer->local, partition, process);
    }
    dds_instance_handle_t readers[BUS_ENDPOINTS_MAX];
    dds_return_t count = dds_get_matched_subscriptions(writer->writer, readers, BUS_ENDPOINTS_MAX);
    bool found = false;
    for (dds_return_t i = 0; i < count && i < BUS_ENDPOINTS_MAX && !found; i++) {
        dds_builtintopic_endpoint_t *endpoint =
            dds_get_matched_subscription_data(writer->writer, readers[i]);
        if (endpoint) {
            found = local_endpoint_names(endpoint, partition);
            *process = endpoint->participant_key;
            dds_builtintopic_free_endpoint(endpoint);
        }
    }
    return found;
}

bool bus_writer_reaches(const struct bus_writer *writer, const char *partition)
{
    dds_guid_t process;
    return reader_find(writer, partition, &process);
}

/* How DDS gives the other sides of an endpoint, and tells of one. */
typedef dds_return_t others_of(dds_entity_t endpoint, dds_instance_handle_t *others, size_t most);
typedef dds_builtintopic_endpoint_t *other_of(dds_entity_t endpoint, dds_instance_handle_t other);

/* @return whether one of the other sides of an endpoint is in that process */
static bool process_is_among(const dds_guid_t *process, dds_entity_t endpoint, others_of *matched,
                             other_of *about)
{
    dds_instance_handle_t others[BUS_ENDPOINTS_MAX];
    dds_return_t count = matched(endpoint, others, BUS_ENDPOINTS_MAX);
    bool found = false;
    for (dds_return_t i = 0; i < count && i < BUS_ENDPOINTS_MAX && !found; i++) {
        dds_builtintopic_endpoint_t *other = about(endpoint, others[i]);
        if (other) {
            found = memcmp(&other->participant_key, process, sizeof *process) == 0;
            dds_builtintopic_free_endpoint(other);
        }
    }
    return found;
}

bool bus_writer_shares(const struct bus_writer *writer, const char *partition,
                       const struct bus_writer *other)
{
    dds_guid_t process;
    return reader_find(writer, partition, &process) &&
           process_is_among(&process, other->writer, dds_get_matched_subscriptions,
                            dds_get_matched_subscription_data);
}

bool bus_reader_hears(const struct bus_reader *reader, const struct bus_writer *writer,
                      const char *partition)
{
    dds_guid_t process;
    return reader_find(writer, partition, &process) &&
           process_is_among(&process, reader->reader, dds_get_matched_publications,
                            dds_get_matched_publication_data);
}

bool bus_writer_identify(const struct bus_reader *r, dds_instance_handle_t writer,
                         dds_guid_t who[2])
{
    dds_builtintopic_endpoint_t *about = dds_get_matched_publication_data(r->reader, writer);
    bool writes = about && !local_endpoint_names(about, LOCAL_SHARED_PARTITION);
    if (about) {
        who[0] = about->key;
        who[1] = about->participant_key;
        dds_builtintopic_free_endpoint(about);
    }
    return writes;
}

uint32_t bus_writer_matches(const struct bus_writer *writer)
{
    if (writer->local && writer->bus->participant > 0) {
        return local_matches(writer->local);
    }
    dds_publication_matched_status_t status;
    dds_return_t code = dds_get_publication_matched_status(writer->writer, &status);
    return code < 0 ? 0 : status.current_count;
}

uint32_t bus_writer_matched_ever(const struct bus_writer *writer)
{
    if (bus_writer_is_shared(writer)) {
        return local_matched_ever(writer->local);
    }
    dds_publication_matched_status_t status;
    dds_return_t code = dds_get_publication_matched_status(writer->writer, &status);
    return code < 0 ? 0 : status.total_count;
}

/* @return how many of its writers write on DDS: others find any reader, and write by sockets */
static uint32_t writes_count(const struct bus_reader *reader)
{
    dds_instance_handle_t writers[BUS_ENDPOINTS_MAX];
    dds_return_t count = dds_get_matched_publications(reader->reader, writers, BUS_ENDPOINTS_MAX);
    dds_guid_t who[2];
    uint32_t found = 0;
    for (dds_return_t i = 0; i < count && i < BUS_ENDPOINTS_MAX; i++) {
        found += bus_writer_identify(reader, writers[i], who);
    }
    return found;
}

uint32_t bus_reader_matches(const struct bus_reader *reader)
{
    bool is_open = reader->reader > 0 && reader->bus->participant > 0;
    uint32_t writers = is_open ? atomic_load(&reader->writers) : 0;
    bool all_write = writers == 0 || !topic_table[reader->topic].local || reader->connected > 0;
    return all_write ? writers : writes_count(reader);
}

/* --- of another version ----------------------------------------------------------------------- */

/* Writes the name of a participant, as DDS tools see it. */
static void participant_name(int32_t ours, dds_instance_handle_t participant, char *name,
                             size_t size)
{
    void *samples[1] = {NULL};
    dds_sample_info_t info[1];
    char *text = NULL;
    dds_entity_t reader = dds_create_reader(ours, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, NULL, NULL);
    int32_t count = dds_read_instance(reader, samples, info, 1, 1, participant);
    if (count == 1) {
        const dds_builtintopic_participant_t *about = samples[0];
        (void)dds_qget_entity_name(about->qos, &text);
    }
    snprintf(name, size, "%s", text ? text : "a program");
    dds_free(text);
    if (count == 1) {
        (void)dds_return_loan(reader, samples, count);
    }
    (void)dds_delete(reader);
}

/* @return whether a writer says that it is of our version, or of one with the same wire */
static bool is_kin(const dds_builtintopic_endpoint_t *writer, char *version, size_t size)
{
    void *data = NULL;
    size_t bytes = 0;
    (void)dds_qget_userdata(writer->qos, &data, &bytes);
    snprintf(version, size, "%.*s", (int)bytes, bytes ? (const char *)data : "");
    dds_free(data);
    const char *theirs = strstr(version, " wire "), *ours = strstr(TOPICS_VERSION, " wire ");
    if (!theirs) {
        snprintf(version, size, "a muster without a number of its wire");
    }
    return theirs && strcmp(theirs, ours) == 0;
}

bool bus_reader_is_stranger(const struct bus_reader *reader, uint64_t writer)
{
    bool known = false;
    for (uint32_t i = 0; i < reader->strangers && i < BUS_STRANGERS; i++) {
        known = known || reader->stranger[i] == writer;
    }
    return known;
}

bool bus_reader_meets(struct bus_reader *reader, char *who, size_t size)
{
    dds_instance_handle_t writers[BUS_ENDPOINTS_MAX];
    uint32_t ever = atomic_load(&reader->writers_ever);
    if (ever == reader->met) {
        return false;
    }
    dds_return_t count = dds_get_matched_publications(reader->reader, writers, BUS_ENDPOINTS_MAX);
    for (dds_return_t i = 0; i < count && i < BUS_ENDPOINTS_MAX; i++) {
        dds_builtintopic_endpoint_t *writer =
            bus_reader_is_stranger(reader, writers[i])
                ? NULL
                : dds_get_matched_publication_data(reader->reader, writers[i]);
        char version[64], name[64];
        bool strange = writer && !is_kin(writer, version, sizeof version);
        if (strange) {
            participant_name(reader->bus->participant, writer->participant_instance_handle, name,
                             sizeof name);
            snprintf(who, size, "%s: %s", name, version);
            reader->stranger[reader->strangers++ % BUS_STRANGERS] = writers[i];
        }
        if (writer) {
            dds_builtintopic_free_endpoint(writer);
        }
        if (strange) {
            return true;
        }
    }
    reader->met = ever;
    return false;
}
