/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Looks at the broker's events, as any DDS tool could: one line each, "KIND AGENT SENDER COUNT".
 *   event_watcher DOMAIN
 */
#include "bus/bus.h"
#include "wire.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    static struct bus bus;
    static struct bus_reader reader;
    struct bus_options options = {.domain = argc == 2 ? (int)strtol(argv[1], NULL, 10) : -1,
                                  .place = BUS_OBSERVER,
                                  .name = "event_watcher"};
    if (options.domain < 0 || bus_open(&bus, &options) != MU_OK ||
        bus_reader_open(&bus, BUS_BROKER_EVENT, NULL, &reader) != MU_OK) {
        return 4;
    }
    while (bus_reader_matches(&reader) == 0) {
        bus_wait(&bus, 0, 10000000);
    }
    printf("ready\n");
    for (;;) {
        enum bus_life life;
        const muster_BrokerEvent *e;
        while ((e = bus_next(&reader, &life))) {
            if (life == BUS_DATA) {
                printf("%s %s %s %llu\n", e->kind, e->agent, e->sender,
                       (unsigned long long)e->count);
            }
        }
        fflush(stdout);
        bus_wait(&bus, 0, 100000000);
    }
}
