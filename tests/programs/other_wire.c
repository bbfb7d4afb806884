/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Registers an agent as a program of the next wire would whose Registration is the same.
 *   other_wire DOMAIN   (its broker is called main)
 * Prints the agent and the word of its refusal.
 */
#include "bus/bus.h"
#include "core/clock.h"
#include "wire.h"

#include <muster/refusal.h>
#include <stdio.h>
#include <stdlib.h>

static const uint64_t PATIENCE_NS = 10000000000;

static char none[1], process[] = "p-newer", newer[] = "newer", version[] = "9.0.0";

static bool verdict_print(struct bus_reader *deliveries)
{
    enum bus_life life;
    const muster_Delivery *d;
    while ((d = bus_next(deliveries, &life))) {
        for (uint32_t i = 0; life == BUS_DATA && i < d->verdicts._length; i++) {
            const muster_Verdict *v = &d->verdicts._buffer[i];
            printf("%s: %s\n", v->agent,
                   v->accepted ? "accepted" : mu_refusal_word((enum mu_refusal)v->code));
            return true;
        }
    }
    return false;
}

int main(int argc, char **argv)
{
    static struct bus bus;
    static struct bus_writer registrations, ups;
    static struct bus_reader deliveries;
    struct bus_options options = {.domain = argc > 1 ? (int)strtol(argv[1], NULL, 10) : 0,
                                  .place = BUS_AGENT,
                                  .name = "other_wire"};
    if (bus_open(&bus, &options) != MU_OK ||
        bus_reader_open(&bus, BUS_DELIVERY, process, &deliveries) != MU_OK ||
        bus_writer_open(&bus, BUS_REGISTRATION, NULL, NULL, &registrations) != MU_OK ||
        bus_writer_open(&bus, BUS_UP, "broker.main", NULL, &ups) != MU_OK) {
        return 1;
    }
    muster_Entry entry = {
        .name = newer, .state = muster_STATE_RUNNING, .home = none, .via = none, .host = none};
    muster_Registration r = {.process = process,
                             .wire = muster_WIRE + 1,
                             .version = version,
                             .broker = none,
                             .incarnation = 1,
                             .host = none};
    r.agents._buffer = &entry;
    r.agents._length = r.agents._maximum = 1;
    mu_result written = bus_write(&registrations, &r);
    bool told = false;
    uint64_t began_ns = mu_clock_ns();
    while (written == MU_OK && !told && mu_clock_ns() - began_ns < PATIENCE_NS) {
        bus_wait(&bus, 1, 100000000);
        told = verdict_print(&deliveries);
    }
    bus_close(&bus);
    return told ? 0 : 1;
}
