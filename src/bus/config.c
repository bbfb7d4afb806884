/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/config.h"

static void peers_write(struct mu_text *xml, const struct bus_options *options, const char *hub)
{
    if (options->place == BUS_OBSERVER) {
        mu_text_format(xml, "<Peer address=\"%s\"/>", hub); /* the whole index range of the host */
        return;
    }
    /* A star: everyone finds the hubs, the hubs find everyone, nobody else finds anybody. */
    const int hubs[] = {CONFIG_INDEX_BROKER, CONFIG_INDEX_SIMULATOR};
    for (size_t i = 0; i < sizeof hubs / sizeof hubs[0]; i++) {
        mu_text_format(xml, "<Peer address=\"%s:%d\"/>", hub, bus_port(options->domain, hubs[i]));
    }
}

void config_write(struct mu_text *xml, const struct bus_options *options, int index)
{
    const char *interface = options->interface ? options->interface : "127.0.0.1";
    mu_text_format(xml,
                   "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"%s\"/>"
                   "</Interfaces><AllowMulticast>false</AllowMulticast></General>"
                   "<Discovery><ParticipantIndex>%d</ParticipantIndex>"
                   "<MaxAutoParticipantIndex>%d</MaxAutoParticipantIndex><Peers>",
                   interface, index, CONFIG_INDEX_LAST);
    peers_write(xml, options, options->hub ? options->hub : interface);
    /* SPDPInterval: with the default of 30 s a process that starts before its hub waits for 8 s.
     * Watermarks: the windows of mailbox.h and of the lock step bound what is under way; the
     * default of 500 kB would refuse writes long before. */
    mu_text_add(xml, "</Peers><SPDPInterval>200ms</SPDPInterval></Discovery>"
                     "<Internal><WriterLingerDuration>0s</WriterLingerDuration>"
                     "<Watermarks><WhcHigh>8MB</WhcHigh></Watermarks></Internal>"
                     "</Domain></CycloneDDS>");
}
