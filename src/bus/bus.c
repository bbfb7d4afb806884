/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/bus.h"

#include "bus/bus_arrivals.h"
#include "bus/config.h"
#include "bus/loopback.h"
#include "bus/topics.h"
#include "core/clock.h"
#include "core/network.h"
#include "muster/limits.h"
#include "muster/memory.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static mu_result dds_fault(const char *what, dds_return_t code)
{
    fprintf(stderr, "DDS: %s: %s\n", what, dds_strretcode(code));
    return MU_FAULT_DDS;
}

/* A taken index makes Cyclone print an error; the next one is tried, so the line stays unprinted.
 */
static void log_nothing(void *arg, const dds_log_data_t *data)
{
    (void)arg;
    (void)data;
}

static dds_return_t domain_create(const struct bus_options *options, int index)
{
    static char buffer[CONFIG_XML_MAX];
    struct mu_text xml = mu_text_in(buffer, sizeof buffer);
    config_write(&xml, options, index);
    MU_ASSERT(!xml.cut);

    struct in_addr address;
    const char *interface = options->interface ? options->interface : "127.0.0.1";
    bool is_loopback =
        inet_pton(AF_INET, interface, &address) == 1 && (ntohl(address.s_addr) >> 24) == 127;
    static struct loopback before;
    loopback_note(&before);
    dds_entity_t domain = dds_create_domain((dds_domainid_t)options->domain, buffer);
    if (domain >= 0 && is_loopback && !loopback_hold(&before)) {
        dds_delete(domain);
        return DDS_RETCODE_NOT_ALLOWED_BY_SECURITY;
    }
    return domain;
}

static bool is_address(const char *text)
{
    struct in_addr address;
    return inet_pton(AF_INET, text, &address) == 1;
}

/* Tries to bind a socket.  @return 0, or errno; 0 too when the text is no IPv4 address */
static int bind_try(const char *text, int port)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    if (!text || inet_pton(AF_INET, text, &address.sin_addr) != 1) {
        return 0;
    }
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0) {
        return 0;
    }
    int result = bind(fd, (const struct sockaddr *)&address, sizeof address) == 0 ? 0 : errno;
    close(fd);
    return result;
}

/* @return whether no interface of this machine has that address */
static bool is_elsewhere(const char *text)
{
    return text && (!is_address(text) || bind_try(text, 0) == EADDRNOTAVAIL);
}

/* A domain that fails for its index costs a hundred times as much as this: where many processes
 * start, most indices are taken.  @return whether a process has that index; false may be wrong */
static bool is_taken(const struct bus_options *options, int index)
{
    const char *interface = options->interface ? options->interface : "127.0.0.1";
    return bind_try(interface, bus_port(options->domain, index)) == EADDRINUSE;
}

/* Processes that share their indices begin to look at different ones: of a hundred that start
 * together, the last one would try a hundred, and two would often want the same.
 * @return as config_index */
static int index_try(enum bus_place place, int n)
{
    enum { SHARED = CONFIG_INDEX_LAST - CONFIG_INDEX_FIRST + 1 };
    bool shares = place == BUS_AGENT || place == BUS_OBSERVER;
    return config_index(place, shares && n < SHARED ? (getpid() + n) % SHARED : n);
}

/* Never goes on after a failure: the participant would come up on all interfaces. */
static mu_result domain_open(struct bus *bus, const struct bus_options *options)
{
    if (is_elsewhere(options->interface)) {
        fprintf(stderr,
                "--interface %s: this machine has no such IPv4 address; `ip -4 -brief address` "
                "lists those that it has\n",
                options->interface);
        return MU_FAULT_DDS;
    }
    dds_return_t code = DDS_RETCODE_ERROR;
    dds_set_log_sink(log_nothing, NULL);
    int index = 0;
    for (int i = 0;
         code < 0 && code != DDS_RETCODE_PRECONDITION_NOT_MET &&
         code != DDS_RETCODE_NOT_ALLOWED_BY_SECURITY && (index = index_try(options->place, i)) >= 0;
         i++) {
        code = is_taken(options, index) ? DDS_RETCODE_ERROR : domain_create(options, index);
    }
    dds_set_log_sink(NULL, NULL);
    if (code >= 0) {
        bus->domain = code;
        bus->index = index;
        return MU_OK;
    }
    if (code == DDS_RETCODE_PRECONDITION_NOT_MET) {
        fprintf(stderr, "this program is in domain %d already\n", options->domain);
        return MU_FAULT_USAGE;
    }
    if (code == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY) {
        return MU_FAULT_DDS;
    }
    bool is_hub = options->place == BUS_BROKER || options->place == BUS_SIMULATOR;
    return is_hub ? MU_BUSY : dds_fault("no participant index is free from 10 to 118", code);
}

static void domain_close(struct bus *bus)
{
    if (bus->domain > 0) {
        dds_delete(bus->domain);
    }
    bus->domain = 0;
}

/* @return whether an address can go into the configuration as it stands */
static bool is_host(const char *text)
{
    return !text || (!strchr(text, ',') && config_hosts_valid(text));
}

/* A peer without an address would be no process's peer, without a word. */
static mu_result peers_find(const char *hosts)
{
    size_t len;
    const char *host;
    for (const char *at = hosts; at && (host = config_host(&at, &len));) {
        char name[256];
        struct addrinfo *found = NULL;
        const struct addrinfo wanted = {.ai_family = AF_INET, .ai_socktype = SOCK_DGRAM};
        snprintf(name, sizeof name, "%.*s", (int)len, host);
        int failed = is_address(name) ? 0 : getaddrinfo(name, NULL, &wanted, &found);
        if (failed) {
            fprintf(stderr, "--peer %s: no IPv4 address: %s\n", name, gai_strerror(failed));
            return MU_FAULT_DDS;
        }
        if (found) {
            freeaddrinfo(found);
        }
    }
    return MU_OK;
}

mu_result bus_open(struct bus *bus, const struct bus_options *options)
{
    *bus = (struct bus){.place = options->place, .index = -1};
    if (!is_host(options->interface) || (options->hub && !config_hosts_valid(options->hub))) {
        fprintf(stderr,
                "expected --interface with one address, and --peer with names or addresses of at "
                "most %d hosts\n",
                MU_PEERS_MAX);
        return MU_FAULT_USAGE;
    }
    if (options->domain < 0 || options->domain > MU_DOMAIN_MAX) {
        fprintf(stderr, "there is no domain %d: they are 0 to %d\n", options->domain,
                MU_DOMAIN_MAX);
        return MU_FAULT_USAGE;
    }
    const char *uri = getenv("CYCLONEDDS_URI");
    if (!uri || !uri[0]) {
        mu_result opened = peers_find(options->hub);
        opened = opened == MU_OK ? domain_open(bus, options) : opened;
        if (opened != MU_OK) {
            return opened;
        }
    }
    dds_qos_t *qos = dds_create_qos();
    dds_qset_entity_name(qos, options->name);
    bus->participant = dds_create_participant((dds_domainid_t)options->domain, qos, NULL);
    dds_delete_qos(qos);
    if (bus->participant < 0) {
        domain_close(bus);
        return dds_fault("participant", bus->participant);
    }
    bus_arrivals_init(bus);
    return MU_OK;
}

mu_result bus_join(struct bus *bus, const struct mu_network *network, enum bus_place place,
                   const char *name)
{
    struct bus_options options = {.domain = (int)network->domain,
                                  .place = place,
                                  .name = name,
                                  .interface = network->interface,
                                  .hub = mu_network_peers(network)};
    return bus_open(bus, &options);
}

void bus_close(struct bus *bus)
{
    dds_delete(bus->participant);
    bus->participant = 0;
    domain_close(bus);
    if (bus->wakes) {
        close(bus->wake_fd);
        bus->wakes = false;
    }
}

bool bus_is_lone_broker(const struct bus *bus, int domain)
{
    bool alone = bus->index >= 0;
    for (size_t i = 0; i < CONFIG_BROKERS_MAX && alone; i++) {
        if (config_broker_indices[i] == bus->index) {
            continue;
        }
        alone = bind_try("0.0.0.0", bus_port(domain, config_broker_indices[i])) == 0;
    }
    return alone;
}

/* The same without what a tool can learn the type from. */
static dds_topic_descriptor_t descriptor_untyped(const dds_topic_descriptor_t *d)
{
    return (dds_topic_descriptor_t){.m_size = d->m_size,
                                    .m_align = d->m_align,
                                    .m_flagset = d->m_flagset & ~DDS_TOPIC_XTYPES_METADATA,
                                    .m_nkeys = d->m_nkeys,
                                    .m_typename = d->m_typename,
                                    .m_keys = d->m_keys,
                                    .m_nops = d->m_nops,
                                    .m_ops = d->m_ops,
                                    .m_meta = d->m_meta};
}

static bool is_described(const struct bus *bus, const struct topic *t, const char *partition)
{
    if (bus->place == BUS_OBSERVER) {
        return true;
    }
    bool is_agent = bus->place == BUS_AGENT;
    return t->describer == DESCRIBED_TO_ALL
               ? !is_agent && partition && strcmp(partition, BUS_TO_ALL) == 0
               : is_agent == (t->describer == DESCRIBED_BY_AGENTS);
}

/* @return the topic as an endpoint in that partition has it, or the fault of DDS */
static dds_entity_t topic_open(struct bus *bus, enum bus_topic topic, const char *partition)
{
    const struct topic *t = &topic_table[topic];
    bool described = is_described(bus, t, partition);
    int32_t *made = &bus->topics[topic][described];
    if (*made <= 0) {
        const dds_topic_descriptor_t bare = descriptor_untyped(t->descriptor);
        *made = dds_create_topic(bus->participant, described ? t->descriptor : &bare, t->name, NULL,
                                 NULL);
    }
    return *made;
}

mu_result bus_reader_open(struct bus *bus, enum bus_topic topic, const char *partition,
                          struct bus_reader *reader)
{
    return bus_reader_open_deep(bus, topic, partition, 0, reader);
}

mu_result bus_reader_open_deep(struct bus *bus, enum bus_topic topic, const char *partition,
                               int32_t depth, struct bus_reader *reader)
{
    *reader = (struct bus_reader){.bus = bus, .topic = topic};
    dds_entity_t about = topic_open(bus, topic, partition);
    if (about < 0) {
        return dds_fault(topic_table[topic].name, about);
    }
    for (int i = 0; i < BUS_BATCH; i++) {
        reader->samples[i] = bus_sample(topic);
    }
    dds_qos_t *group = dds_create_qos();
    dds_qset_partition1(group, partition ? partition : "");
    dds_entity_t subscriber = dds_create_subscriber(bus->participant, group, NULL);
    dds_delete_qos(group);
    if (subscriber < 0) {
        return dds_fault("subscriber", subscriber);
    }
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    if (depth > 0) {
        dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
    }
    dds_listener_t *listener = dds_create_listener(reader);
    dds_lset_data_available(listener, bus_arrivals_note);
    reader->reader = dds_create_reader(subscriber, about, qos, listener);
    dds_delete_listener(listener);
    dds_delete_qos(qos);
    if (reader->reader < 0) {
        dds_delete(subscriber);
        return dds_fault("reader", reader->reader);
    }
    return MU_OK;
}

mu_result bus_writer_open(struct bus *bus, enum bus_topic topic, const char *first,
                          const char *second, struct bus_writer *writer)
{
    *writer = (struct bus_writer){0};
    dds_entity_t about = topic_open(bus, topic, first);
    if (about < 0) {
        return dds_fault(topic_table[topic].name, about);
    }
    const char *partitions[] = {first ? first : "", second};
    dds_qos_t *group = dds_create_qos();
    dds_qset_partition(group, second ? 2 : 1, partitions);
    writer->publisher = dds_create_publisher(bus->participant, group, NULL);
    dds_delete_qos(group);
    if (writer->publisher < 0) {
        return dds_fault("publisher", writer->publisher);
    }
    dds_qos_t *qos = topics_qos(&topic_table[topic]);
    writer->writer = dds_create_writer(writer->publisher, about, qos, NULL);
    dds_delete_qos(qos);
    if (writer->writer < 0) {
        dds_return_t why = writer->writer;
        bus_writer_close(writer); /* the caller tries again, each round if need be */
        return dds_fault("writer", why);
    }
    return MU_OK;
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

/* The other sides of one endpoint that are looked at: all processes that a domain can have, and
 * their watchers. */
enum { ENDPOINTS_MAX = 1024 };

/* @return whether one of the partitions that an endpoint names is this one */
static bool endpoint_names(const dds_builtintopic_endpoint_t *endpoint, const char *partition)
{
    uint32_t count = 0;
    char **names = NULL;
    bool found = false;
    if (endpoint->qos && dds_qget_partition(endpoint->qos, &count, &names)) {
        for (uint32_t i = 0; i < count; i++) {
            found = found || strcmp(names[i], partition) == 0;
            dds_free(names[i]);
        }
        dds_free(names);
    }
    return found;
}

/* Finds the process that reads a partition by its name.  @return whether there is one */
static bool reader_find(const struct bus_writer *writer, const char *partition, dds_guid_t *process)
{
    dds_instance_handle_t readers[ENDPOINTS_MAX];
    dds_return_t count = dds_get_matched_subscriptions(writer->writer, readers, ENDPOINTS_MAX);
    bool found = false;
    for (dds_return_t i = 0; i < count && i < ENDPOINTS_MAX && !found; i++) {
        dds_builtintopic_endpoint_t *endpoint =
            dds_get_matched_subscription_data(writer->writer, readers[i]);
        if (endpoint) {
            found = endpoint_names(endpoint, partition);
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

bool bus_writer_shares(const struct bus_writer *writer, const char *partition,
                       const struct bus_writer *other)
{
    dds_instance_handle_t readers[ENDPOINTS_MAX];
    dds_guid_t process;
    if (!reader_find(writer, partition, &process)) {
        return false;
    }
    dds_return_t count = dds_get_matched_subscriptions(other->writer, readers, ENDPOINTS_MAX);
    bool found = false;
    for (dds_return_t i = 0; i < count && i < ENDPOINTS_MAX && !found; i++) {
        dds_builtintopic_endpoint_t *endpoint =
            dds_get_matched_subscription_data(other->writer, readers[i]);
        if (endpoint) {
            found = memcmp(&endpoint->participant_key, &process, sizeof process) == 0;
            dds_builtintopic_free_endpoint(endpoint);
        }
    }
    return found;
}

bool bus_reader_hears(const struct bus_reader *reader, const struct bus_writer *writer,
                      const char *partition)
{
    dds_guid_t process;
    if (!reader_find(writer, partition, &process)) {
        return false;
    }
    dds_instance_handle_t writers[ENDPOINTS_MAX];
    dds_return_t count = dds_get_matched_publications(reader->reader, writers, ENDPOINTS_MAX);
    bool found = false;
    for (dds_return_t i = 0; i < count && i < ENDPOINTS_MAX && !found; i++) {
        dds_builtintopic_endpoint_t *endpoint =
            dds_get_matched_publication_data(reader->reader, writers[i]);
        if (endpoint) {
            found = memcmp(&endpoint->participant_key, &process, sizeof process) == 0;
            dds_builtintopic_free_endpoint(endpoint);
        }
    }
    return found;
}

uint32_t bus_writer_matches(const struct bus_writer *writer)
{
    dds_publication_matched_status_t status;
    dds_return_t code = dds_get_publication_matched_status(writer->writer, &status);
    return code < 0 ? 0 : status.current_count;
}

uint32_t bus_writer_matched_ever(const struct bus_writer *writer)
{
    dds_publication_matched_status_t status;
    dds_return_t code = dds_get_publication_matched_status(writer->writer, &status);
    return code < 0 ? 0 : status.total_count;
}

uint32_t bus_reader_matches(const struct bus_reader *reader)
{
    dds_subscription_matched_status_t status;
    dds_return_t code = dds_get_subscription_matched_status(reader->reader, &status);
    return code < 0 ? 0 : status.current_count;
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
    bus_arrivals_taken(r, r->arrived); /* the samples that lie there are not looked at */
    samples_empty(r);
    r->count = r->next = 0;
}

/* What one sample of a batch says.  When its writer went while it lay unread, DDS has no other
 * sample to say so: then the last one of its instance is handed out once more, as its end. */
static void sample_judge(struct bus_reader *r, int32_t i, const dds_sample_info_t *info)
{
    enum bus_life fate = info->instance_state == DDS_IST_ALIVE                ? BUS_DATA
                         : info->instance_state == DDS_IST_NOT_ALIVE_DISPOSED ? BUS_DISPOSED
                                                                              : BUS_LOST;
    r->states[i] = info->valid_data ? BUS_DATA : fate;
    r->fates[i] = info->valid_data && info->sample_rank == 0 ? fate : BUS_DATA;
}

/* Takes the next batch.  @return whether there is anything in it */
static bool batch_take(struct bus_reader *r)
{
    r->count = r->next = 0;
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

bool bus_drain(const struct bus_writer *writer, int64_t timeout_ns)
{
    return dds_wait_for_acks(writer->writer, timeout_ns) == DDS_RETCODE_OK;
}

void bus_print_topics(void)
{
    printf("| topic | type | history | durability | partition | from, to | carries |\n"
           "|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < BUS_TOPICS; i++) {
        const struct topic *t = &topic_table[i];
        char history[32] = "keep all";
        if (!t->keeps_all) {
            snprintf(history, sizeof history, "keep last %d", (int)topics_depth(t));
        }
        printf("| `%s` | `%s` | %s | %s%s | %s | %s | %s |\n", t->name, t->descriptor->m_typename,
               history, t->for_late_comers ? "transient local" : "volatile",
               t->liveliness_ns ? ", liveliness automatic 1 s" : "", t->partition, t->from_to,
               t->carries);
    }
    printf("\nAll are reliable, with a maximum blocking time of 0.\n");
}
