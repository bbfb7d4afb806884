/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/control/parts.h"
#include "core/clock.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const int64_t LAST_PATIENCE_NS = 1000000000; /* for the counters of a report */

mu_result telemetry_open(struct telemetry *h, struct bus *bus)
{
    *h = (struct telemetry){.bus = bus};
    MU_TRY(bus_writer_open(bus, BUS_BROKER_STATUS, NULL, NULL, &h->status));
    return bus_writer_open(bus, BUS_PART_STATUS, NULL, NULL, &h->parts);
}

/* The second number of /proc/self/statm, in pages.  @return 0 where there is none */
static uint64_t resident_bytes(void)
{
    char text[128] = "";
    int fd = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    ssize_t len = fd < 0 ? 0 : read(fd, text, sizeof text - 1);
    if (fd >= 0) {
        close(fd);
    }
    unsigned long long pages = 0;
    bool read_well = len > 0 && sscanf(text, "%*u %llu", &pages) == 1;
    return read_well ? pages * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

static void status_tell(struct telemetry *h, struct broker *b, bool all)
{
    muster_BrokerStatus status = {0};
    broker_status(b, &status);
    status.malformed += h->bus->malformed;
    muster_BrokerStatus news = status;
    news.oldest_ns = 0;
    if (!all && memcmp(&news, &h->told, sizeof news) == 0) {
        return;
    }
    status.cpu_ns = mu_clock_read(CLOCK_PROCESS_CPUTIME_ID);
    status.resident_bytes = resident_bytes();
    if (bus_write(&h->status, &status) == MU_OK) {
        h->told = news;
    }
}

/* The counters of a part follow each other in the table, from first on.
 * @return whether one of them has changed, one that drifts only when all are told */
static bool part_is_news(const struct telemetry *h, uint32_t first, const muster_PartStatus *status,
                         bool all)
{
    bool news = false;
    for (uint32_t i = 0; i < status->counters._length && !news; i++) {
        news = status->counters._buffer[i].value != h->values[first + i] &&
               (all || !metrics_at(first + i)->drifts);
    }
    return news;
}

static void part_tell(struct telemetry *h, uint32_t first, const muster_PartStatus *status)
{
    bool written = bus_write(&h->parts, status) == MU_OK;
    for (uint32_t i = 0; i < status->counters._length && written; i++) {
        h->values[first + i] = status->counters._buffer[i].value;
    }
}

static void everything_tell(struct telemetry *h, struct broker *b, bool all)
{
    muster_PartStatus status;
    uint32_t first = 0;
    bus_ways(h->bus, &b->ways);
    status_tell(h, b, all);
    for (uint32_t part = 1; broker_part(b, part, &status); part++) {
        if (h->told_ns == 0 || part_is_news(h, first, &status, all)) {
            part_tell(h, first, &status);
        }
        first += status.counters._length;
    }
}

void telemetry_tell(struct telemetry *h, struct broker *b, uint64_t now_ns)
{
    bool all = h->told_ns == 0 || now_ns - h->told_ns >= HEALTH_DRIFT_NS;
    everything_tell(h, b, all);
    h->told_ns = all ? now_ns : h->told_ns;
}

void telemetry_close(struct telemetry *h, struct broker *b)
{
    everything_tell(h, b, true);
    (void)bus_drain(&h->status, LAST_PATIENCE_NS);
}
