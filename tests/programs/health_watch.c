/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Prints what a broker says of itself, as a late comer hears it.
 *   health_watch DOMAIN [SECONDS]
 * A line for each sample: "PART COUNTER NUMBER ..." or "status COUNTER NUMBER ...".
 */
#include "bus/bus.h"
#include "core/clock.h"
#include "wire.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void status_print(const muster_BrokerStatus *s)
{
    printf("status agents %" PRIu32 " sent %" PRIu64 " delivered %" PRIu64 " waiting %" PRIu64
           " malformed %" PRIu64 " stored %" PRIu32 " oldest_ns %" PRIu64 " cpu_ns %" PRIu64
           " resident_bytes %" PRIu64 "\n",
           s->agents, s->sent, s->delivered, s->waiting, s->malformed, s->stored, s->oldest_ns,
           s->cpu_ns, s->resident_bytes);
}

static void part_print(const muster_PartStatus *s)
{
    printf("%s", s->part);
    for (uint32_t i = 0; i < s->counters._length; i++) {
        printf(" %s %" PRIu64, s->counters._buffer[i].name, s->counters._buffer[i].value);
    }
    printf("\n");
}

int main(int argc, char **argv)
{
    static struct bus bus;
    static struct bus_reader statuses, parts;
    struct bus_options options = {.domain = argc > 1 ? (int)strtol(argv[1], NULL, 10) : 0,
                                  .place = BUS_OBSERVER,
                                  .name = "health_watch"};
    uint64_t seconds = argc > 2 ? strtoull(argv[2], NULL, 10) : 60;
    if (bus_open(&bus, &options) != MU_OK ||
        bus_reader_open(&bus, BUS_BROKER_STATUS, NULL, &statuses) != MU_OK ||
        bus_reader_open(&bus, BUS_PART_STATUS, NULL, &parts) != MU_OK) {
        return 4;
    }
    setvbuf(stdout, NULL, _IOLBF, 0);
    uint64_t until_ns = mu_clock_ns() + seconds * 1000000000u;
    while (mu_clock_ns() < until_ns) {
        enum bus_life life;
        const void *sample;
        while ((sample = bus_next(&statuses, &life))) {
            if (life == BUS_DATA) {
                status_print(sample);
            }
        }
        while ((sample = bus_next(&parts, &life))) {
            if (life == BUS_DATA) {
                part_print(sample);
            }
        }
        bus_wait(&bus, 0, 50000000);
    }
    bus_close(&bus);
    return 0;
}
