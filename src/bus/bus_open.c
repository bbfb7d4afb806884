/* SPDX-License-Identifier: Apache-2.0 */
/* A process comes onto the network, and leaves it. */
#include "bus/bus.h"
#include "bus/bus_arrivals.h"
#include "bus/bus_fault.h"
#include "bus/config.h"
#include "bus/local.h"
#include "bus/loopback.h"
#include "core/network.h"
#include "muster/limits.h"

#include <arpa/inet.h>
#include <dds/dds.h>
#include <errno.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

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

    bool is_loopback = config_is_loopback(options->interface);
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

/* lo has no address before it is up. */
static bool device_has(const struct ifaddrs *device, const char *address)
{
    struct in_addr wanted;
    const struct sockaddr_in *its = (const void *)device->ifa_addr;
    if (config_is_loopback(address)) {
        return device->ifa_flags & IFF_LOOPBACK;
    }
    return its && its->sin_family == AF_INET && inet_pton(AF_INET, address, &wanted) == 1 &&
           its->sin_addr.s_addr == wanted.s_addr;
}

bool bus_device_is_down(const char *interface, char *name)
{
    struct ifaddrs *devices = NULL;
    bool looked = getifaddrs(&devices) == 0, is_down = false;
    for (const struct ifaddrs *d = looked ? devices : NULL; d; d = d->ifa_next) {
        if (device_has(d, interface)) {
            is_down = !(d->ifa_flags & IFF_UP);
            snprintf(name, IFNAMSIZ, "%s", d->ifa_name);
            break;
        }
    }
    if (looked) {
        freeifaddrs(devices);
    }
    return is_down;
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
    char device[IFNAMSIZ];
    if (bus_device_is_down(options->interface, device)) {
        fprintf(stderr, "the network device %s is down: sudo ip link set %s up\n", device, device);
        return MU_FAULT_DDS;
    }
    bool is_hub = options->place == BUS_BROKER || options->place == BUS_SIMULATOR;
    return is_hub ? MU_BUSY : bus_fault("no participant index is free from 10 to 118", code);
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
    const char *says = options->local ? options->local : getenv(LOCAL_ENVIRONMENT);
    bool local = !says || !says[0] || strcmp(says, "on") == 0;
    if (!local && strcmp(says, "off") != 0) {
        fprintf(stderr, "expected --local on or off, not '%s'\n", says);
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
        return bus_fault("participant", bus->participant);
    }
    bus->local = local;
    return bus_arrivals_open(bus);
}

mu_result bus_join(struct bus *bus, const struct mu_network *network, enum bus_place place,
                   const char *name)
{
    struct bus_options options = {.domain = (int)network->domain,
                                  .place = place,
                                  .name = name,
                                  .interface = network->interface,
                                  .hub = mu_network_peers(network),
                                  .local = network->local};
    return bus_open(bus, &options);
}

void bus_close(struct bus *bus)
{
    bool opened = bus->participant > 0;
    dds_delete(bus->participant);
    bus->participant = 0;
    domain_close(bus);
    if (opened) {
        local_readers_close(bus);
        local_writers_close(bus);
        dds_free(bus->room.at);
        bus_arrivals_close(bus);
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
