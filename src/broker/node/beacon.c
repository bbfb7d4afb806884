/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/control/parts.h"
#include "core/clock.h"
#include "core/log.h"

#include <stdio.h>
#include <unistd.h>

mu_result beacon_open(struct beacon *h, struct bus *bus, struct broker *b)
{
    static char host[MU_FIELD_MAX + 1];
    gethostname(host, sizeof host - 1);
    *h = (struct beacon){.beacons.own = {.broker = b->name,
                                         .incarnation = b->incarnation,
                                         .host = host,
                                         .pid = b->registry.agents[REGISTRY_BROKER].is.pid,
                                         .index = bus->index > 0 ? (uint32_t)bus->index : 0}};
    MU_TRY(bus_writer_open(bus, BUS_BEACON, NULL, NULL, &h->beacon));
    return bus_reader_open(bus, BUS_BEACON, NULL, &h->heard);
}

static void beacon_take(struct beacon *h, const muster_Beacon *beacon)
{
    switch (beacon_table_hear(&h->beacons, beacon)) {
    case BEACON_NOTHING: break;
    case BEACON_MET:
        mu_log(MU_LOG_INFO, "broker-met", "name=%s host=%s pid=%u index=%u", beacon->broker,
               beacon->host, beacon->pid, beacon->index);
        break;
    case BEACON_FULL:
        mu_log(MU_LOG_WARNING, "broker-passed-over", "name=%s host=%s pid=%u most=%d",
               beacon->broker, beacon->host, beacon->pid, MU_BROKERS_MAX);
        break;
    case BEACON_LATER:
        mu_log(MU_LOG_WARNING, "name-claimed", "name=%s host=%s pid=%u", beacon->broker,
               beacon->host, beacon->pid);
        break;
    case BEACON_EARLIER:
        fprintf(stderr,
                "muster broker: the network has a broker named %s already, on %s (process %u); "
                "give this one another name\n",
                beacon->broker, beacon->host, beacon->pid);
        h->yields = true;
        break;
    }
}

void beacon_hear(struct beacon *h)
{
    enum bus_life life;
    const muster_Beacon *beacon;
    while (!h->yields && (beacon = bus_next(&h->heard, &life))) {
        if (life == BUS_DATA) {
            beacon_take(h, beacon);
        } else if (beacons_lose(&h->beacons.others, beacon->broker)) {
            mu_log(MU_LOG_INFO, "broker-lost", "name=%s", beacon->broker);
        }
    }
}

void beacon_tell(struct beacon *h, struct broker *b, struct outlets *outlets, uint64_t now_ns)
{
    if (!heartbeat_looks(&h->pulse, now_ns) ||
        !heartbeat_beats(&h->pulse, outlets_spoke_ns(outlets), now_ns)) {
        return;
    }
    muster_Beacon *own = &h->beacons.own;
    own->agents = b->registry.present;
    own->takes_agents = h->sure && broker_takes_names(b);
    mu_result written = bus_write(&h->beacon, own);
    (void)written; /* the next heartbeat says it again */
}

void beacon_close(struct beacon *h)
{
    bus_dispose(&h->beacon, &h->beacons.own);
}
