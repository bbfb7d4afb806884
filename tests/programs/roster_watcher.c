/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Comes late, as a broker that was started again, and hears what the simulator says of the run: a
 * line for each Roster, "STEP LOCKSTEP".
 *   roster_watcher DOMAIN
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
                                  .name = "roster_watcher"};
    if (options.domain < 0 || bus_open(&bus, &options) != MU_OK ||
        bus_reader_open(&bus, BUS_ROSTER, NULL, &reader) != MU_OK) {
        return 4;
    }
    for (;;) {
        enum bus_life life;
        const muster_Roster *r;
        while ((r = bus_next(&reader, &life))) {
            if (life == BUS_DATA) {
                printf("%lld %d\n", (long long)r->step, r->lockstep);
            }
        }
        fflush(stdout);
        bus_wait(&bus, 0, 100000000);
    }
}
