/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/config.h"

#include "muster/limits.h"

#include <string.h>

const int config_broker_indices[CONFIG_BROKERS_MAX] = {0, 2, 3, 4};

int config_index(enum bus_place place, int index)
{
    if (place == BUS_BROKER) {
        return index < CONFIG_BROKERS_MAX ? config_broker_indices[index] : -1;
    }
    if (place == BUS_SIMULATOR) {
        return index == 0 ? CONFIG_INDEX_SIMULATOR : -1;
    }
    return CONFIG_INDEX_FIRST + index <= CONFIG_INDEX_LAST ? CONFIG_INDEX_FIRST + index : -1;
}

int bus_port(int domain, int index)
{
    return 7400 + 250 * domain + 10 + 2 * index;
}

const char *config_host(const char **at, size_t *len)
{
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.:-_";
    const char *host = *at;
    if (!host) {
        return NULL;
    }
    *len = strspn(host, allowed);
    bool good = *len > 0 && *len < 256 && (host[*len] == ',' || host[*len] == '\0');
    *at = good && host[*len] == ',' ? host + *len + 1 : NULL;
    return good ? host : NULL;
}

bool config_hosts_valid(const char *hosts)
{
    size_t count = 0;
    size_t len;
    for (const char *at = hosts; at; count++) {
        if (!config_host(&at, &len)) {
            return false;
        }
    }
    return count > 0 && count <= MU_PEERS_MAX;
}

static bool is_hub(const struct bus_options *options)
{
    return options->place == BUS_BROKER || options->place == BUS_SIMULATOR;
}

bool config_is_loopback(const char *interface)
{
    return !interface || strncmp(interface, "127.", strlen("127.")) == 0;
}

/* A star: hubs and members find each other, and members do not find members. On its own host a hub
 * calls on all processes itself; elsewhere it knows none, and is called. */
static void host_write(struct mu_text *xml, const struct bus_options *options, const char *host,
                       size_t len, bool own)
{
    if (options->place == BUS_OBSERVER || (own && is_hub(options))) { /* its whole index range */
        mu_text_format(xml, "<Peer address=\"%.*s\"/>", (int)len, host);
        return;
    }
    mu_text_format(xml, "<Peer address=\"%.*s:%d\"/>", (int)len, host,
                   bus_port(options->domain, CONFIG_INDEX_SIMULATOR));
    for (size_t i = 0; i < CONFIG_BROKERS_MAX; i++) {
        mu_text_format(xml, "<Peer address=\"%.*s:%d\"/>", (int)len, host,
                       bus_port(options->domain, config_broker_indices[i]));
    }
}

static void peers_write(struct mu_text *xml, const struct bus_options *options, const char *own)
{
    bool own_named = false;
    size_t len;
    const char *host;
    for (const char *at = options->hub; (host = config_host(&at, &len));) {
        bool is_own = strlen(own) == len && memcmp(own, host, len) == 0;
        own_named = own_named || is_own;
        host_write(xml, options, host, len, is_own);
    }
    if (!options->hub || (is_hub(options) && !own_named)) {
        host_write(xml, options, own, strlen(own), true);
    }
}

/* On loopback a packet costs much the same whatever is in it, and may have 64 kB; elsewhere the
 * network would cut it, and lose all of it with one piece.  By default a Delivery of 200 mails is
 * two dozen fragments or more in a few packets, and what goes out again goes 1,456 bytes at a time.
 */
static void sizes_write(struct mu_text *xml, const char *interface)
{
    if (config_is_loopback(interface)) {
        mu_text_add(xml, "<MaxMessageSize>65000B</MaxMessageSize>"
                         "<MaxRexmitMessageSize>64000B</MaxRexmitMessageSize>"
                         "<FragmentSize>64000B</FragmentSize>");
    }
}

/* How often a process says to its peers that it is there (SPDP). On one host members call on the
 * hubs when they start, and hubs on all processes when they do; what they say later, which wakes
 * each hearer, is for packets that were lost.  A hub's are 120, at once.  A hub on another host
 * does not call, and is found by asking: with the default of 30 s that took 8 s. */
static const char *presence_interval(const struct bus_options *options)
{
    const char *of_hub = config_is_loopback(options->interface) && !options->hub ? "8s" : "2s";
    if (options->place == BUS_BROKER) {
        return of_hub;
    }
    if (options->hub || options->place == BUS_OBSERVER) {
        return "200ms";
    }
    return is_hub(options) ? of_hub : "1s";
}

/* How much of what its readers have not acknowledged a writer keeps: beyond that it writes nothing.
 *
 * A broker keeps so much for each process, for it asks at half of that one that never pauses
 * (heartbeat_write): with 2 MB it had 130 MB for fifty busy pairs.  On loopback it begins at 16 kB,
 * and a flood raises that as it is acknowledged; each sample that is asked for again lowers it, to
 * 8 kB at least.  On a network, where more is under way and more is lost, it does not change.
 *
 * A process may write more to a broker that was killed, until DDS misses it 10 s later. */
static void watermarks_write(struct mu_text *xml, const struct bus_options *options)
{
    static const char *const of_loopback[] = {"8kB", "16kB", "2MB", "true"};
    static const char *const of_network[] = {"1kB", "512kB", "512kB", "false"};
    static const char *const of_others[] = {"1kB", "8MB", "8MB", "false"};
    const char *const *of_broker =
        config_is_loopback(options->interface) ? of_loopback : of_network;
    const char *const *is = options->place == BUS_BROKER ? of_broker : of_others;
    mu_text_format(xml,
                   "<Watermarks><WhcLow>%s</WhcLow><WhcHighInit>%s</WhcHighInit>"
                   "<WhcHigh>%s</WhcHigh><WhcAdaptive>%s</WhcAdaptive></Watermarks>",
                   is[0], is[1], is[2], is[3]);
}

/* When a writer asks its readers what they have, while they have not said it.
 *
 * With the sample behind a pause of four fifths of the interval; for want of one when half of the
 * watermark lies there, and once in the shortest interval at most.  The answer is a packet more: on
 * loopback, where few are lost, each of a hundred that get a mail in turn is not asked each time.
 * On a network 8 ms cost nothing; with 4 ms fifty pairs had 0.8 of their rate.
 *
 * Otherwise, as at the end or of a reader that is new, once in so long as minsched says. A broker
 * asks all readers, each time that a new one has not answered yet: of a hundred that start together
 * half of all packets were that. A reader that has missed the question waits for the next: at 100
 * ms a run begins 0.15 s later. */
static void heartbeat_write(struct mu_text *xml, const struct bus_options *options,
                            const char *interface)
{
    bool is_broker = options->place == BUS_BROKER;
    bool is_loopback = config_is_loopback(interface);
    const char *of_network = is_broker ? "10ms" : "20ms";
    mu_text_format(xml, "<HeartbeatInterval min=\"%s\" minsched=\"%s\">%s</HeartbeatInterval>",
                   is_broker ? "5ms" : "20ms", is_broker && is_loopback ? "50ms" : "20ms",
                   is_loopback ? "50ms" : of_network);
}

void config_write(struct mu_text *xml, const struct bus_options *options, int index)
{
    const char *interface = options->interface ? options->interface : "127.0.0.1";
    mu_text_format(xml,
                   "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"%s\"/>"
                   "</Interfaces><AllowMulticast>false</AllowMulticast>",
                   interface);
    sizes_write(xml, interface);
    mu_text_format(xml,
                   "</General><Discovery><ParticipantIndex>%d</ParticipantIndex>"
                   "<MaxAutoParticipantIndex>%d</MaxAutoParticipantIndex><Peers>",
                   index, CONFIG_INDEX_END);
    peers_write(xml, options, interface);
    /* ReceiveBufferSize: one packet that waits for those before it holds a whole buffer, as of a
     * process that was killed until its lease ends; the default is 1 MiB. */
    mu_text_format(xml,
                   "</Peers><SPDPInterval>%s</SPDPInterval></Discovery>"
                   "<Internal><WriterLingerDuration>0s</WriterLingerDuration>",
                   presence_interval(options));
    heartbeat_write(xml, options, interface);
    watermarks_write(xml, options);
    mu_text_format(xml, "</Internal>"
                        "<Sizing><ReceiveBufferSize>256KiB</ReceiveBufferSize></Sizing>"
                        "</Domain></CycloneDDS>");
}
