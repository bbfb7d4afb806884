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

/* A star: everyone finds the hubs, the hubs find everyone, nobody else finds anybody. */
static void host_write(struct mu_text *xml, const struct bus_options *options, const char *host,
                       size_t len)
{
    if (options->place == BUS_OBSERVER) { /* the whole index range of the host */
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
        own_named = own_named || (strlen(own) == len && memcmp(own, host, len) == 0);
        host_write(xml, options, host, len);
    }
    if (!options->hub || (options->place == BUS_BROKER && !own_named)) {
        host_write(xml, options, own, strlen(own));
    }
}

/* On loopback a packet costs much the same whatever is in it, and may have 64 kB; elsewhere the
 * network would cut it, and lose all of it with one piece.  By default a Delivery of 200 mails is
 * two dozen fragments or more in a few packets, and what goes out again goes 1,456 bytes at a time.
 */
static void sizes_write(struct mu_text *xml, const char *interface)
{
    if (strncmp(interface, "127.", strlen("127.")) == 0) {
        mu_text_add(xml, "<MaxMessageSize>65000B</MaxMessageSize>"
                         "<MaxRexmitMessageSize>64000B</MaxRexmitMessageSize>"
                         "<FragmentSize>64000B</FragmentSize>");
    }
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
                   index, CONFIG_INDEX_LAST);
    peers_write(xml, options, interface);
    /* SPDPInterval: with the default of 30 s a process that starts before its hub waits for 8 s. A
     * broker waits for nobody, is answered when it starts, and wakes all whom it knows each time.
     * Watermarks: the windows of mailbox.h and of the lock step bound what is under way; the
     * default of 500 kB would refuse writes long before.  It begins at 30 kB: writers to a broker
     * that was killed and is back would stop for 10 s, until the lease of the killed one ends.
     * HeartbeatInterval: who waits for what it wrote to arrive, as at the end, waits so long;
     * shorter ones make readers acknowledge more.
     * ReceiveBufferSize: one packet that waits for those before it holds a whole buffer, as of a
     * process that was killed until its lease ends; the default is 1 MiB. */
    mu_text_format(
        xml,
        "</Peers><SPDPInterval>%s</SPDPInterval></Discovery>"
        "<Internal><WriterLingerDuration>0s</WriterLingerDuration>"
        "<HeartbeatInterval min=\"20ms\" minsched=\"20ms\">20ms</HeartbeatInterval>"
        "<Watermarks><WhcHigh>8MB</WhcHigh><WhcHighInit>8MB</WhcHighInit></Watermarks></Internal>"
        "<Sizing><ReceiveBufferSize>256KiB</ReceiveBufferSize></Sizing>"
        "</Domain></CycloneDDS>",
        options->place == BUS_BROKER ? "2s" : "200ms");
}
