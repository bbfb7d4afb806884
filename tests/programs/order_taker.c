/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Half a simulator, for who orders something of it: who takes orders can be stopped at a moment
 * that is known, while another process still says that a run goes on.
 *   order_taker DOMAIN take    has its orders taken; prints "met" when somebody can write one
 *   order_taker DOMAIN say     says that a run goes on, when it has read a line
 */
#include "bus/bus.h"
#include "wire.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the other side learns of us takes a round trip more than what we learn of it. */
static const int64_t ROUND_TRIP_NS = 300000000;

static int orders_take(struct bus *bus)
{
    static struct bus_reader orders;
    enum bus_life life;
    bool met = false;
    if (bus_reader_open(bus, BUS_RUN_COMMAND, NULL, &orders) != MU_OK) {
        return 4;
    }
    for (;;) {
        bool here = bus_reader_matches(&orders) > 0;
        if (here && !met) {
            bus_wait(bus, 0, ROUND_TRIP_NS);
            puts("met");
        }
        met = here;
        while (bus_next(&orders, &life)) {
        }
        bus_wait(bus, 1, 10000000);
    }
}

static int run_say(struct bus *bus)
{
    static struct bus_writer status;
    static char simulator[] = "sim", none[1];
    char line[8];
    muster_RunStatus said = {
        .simulator = simulator, .state = muster_RUN_RUNNING, .hash = none, .waits_for = none};
    if (bus_writer_open(bus, BUS_RUN_STATUS, NULL, NULL, &status) != MU_OK) {
        return 4;
    }
    puts("ready");
    bool told = fgets(line, sizeof line, stdin) && bus_write(&status, &said) == MU_OK;
    while (told && fgets(line, sizeof line, stdin)) {
    }
    bus_close(bus);
    return told ? 0 : 4;
}

int main(int argc, char **argv)
{
    static struct bus bus;
    bool takes = argc == 3 && strcmp(argv[2], "take") == 0;
    struct bus_options options = {.domain = argc == 3 ? (int)strtol(argv[1], NULL, 10) : -1,
                                  .place = takes ? BUS_SIMULATOR : BUS_BROKER,
                                  .name = "order_taker"};
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (options.domain < 0 || bus_open(&bus, &options) != MU_OK) {
        return 4;
    }
    return takes ? orders_take(&bus) : run_say(&bus);
}
