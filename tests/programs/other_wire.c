/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A program of the next wire, whose types are the same by chance.
 *   other_wire DOMAIN number      registers an agent with the next number; prints it and the word
 * of its refusal.  The broker is called main other_wire DOMAIN user-data   registers it with our
 * number, by a writer that says the next one other_wire DOMAIN beacon      says, by such a writer,
 * that a broker is there The last two go on for PATIENCE_NS, or until they are ended.
 */
#include "bus/topics.h"
#include "core/clock.h"
#include "wire.h"

#include <muster/refusal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t PATIENCE_NS = 10000000000;
static const char NEXT[] = "muster 9.0.0 wire 4000000000";

static struct bus bus;
static char none[1], process[] = "p-newer", newer[] = "newer", version[] = "9.0.0";

/* --- what it says ----------------------------------------------------------------------------- */

static mu_result registration_write(struct bus_writer *writer, uint32_t wire)
{
    muster_Entry entry = {
        .name = newer, .state = muster_STATE_RUNNING, .home = none, .via = none, .host = none};
    muster_Registration r = {.process = process,
                             .wire = wire,
                             .version = version,
                             .broker = none,
                             .incarnation = 1,
                             .host = none};
    r.agents._buffer = &entry;
    r.agents._length = r.agents._maximum = 1;
    return bus_write(writer, &r);
}

static mu_result beacon_write(struct bus_writer *writer)
{
    muster_Beacon b = {.broker = newer, .incarnation = 1, .host = none, .takes_agents = true};
    return bus_write(writer, &b);
}

/* As bus_writer_open, but its user data are those of the next wire. */
static bool writer_open(enum bus_topic topic, struct bus_writer *writer)
{
    const struct topic *t = &topic_table[topic];
    dds_qos_t *qos = topics_qos(t);
    dds_qset_userdata(qos, NEXT, strlen(NEXT));
    writer->bus = &bus;
    writer->writer = dds_create_writer(
        bus.participant, dds_create_topic(bus.participant, t->descriptor, t->name, NULL, NULL), qos,
        NULL);
    dds_delete_qos(qos);
    return writer->writer > 0;
}

/* --- what it hears ---------------------------------------------------------------------------- */

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

static bool waits(uint64_t began_ns)
{
    bus_wait(&bus, 1, 100000000);
    return mu_clock_ns() - began_ns < PATIENCE_NS;
}

static bool number_told(void)
{
    static struct bus_writer registrations, ups;
    static struct bus_reader deliveries;
    if (bus_reader_open(&bus, BUS_DELIVERY, process, &deliveries) != MU_OK ||
        bus_writer_open(&bus, BUS_REGISTRATION, NULL, NULL, &registrations) != MU_OK ||
        bus_writer_open(&bus, BUS_UP, "broker.main", NULL, &ups) != MU_OK ||
        registration_write(&registrations, muster_WIRE + 1) != MU_OK) {
        return false;
    }
    bool told = false;
    for (uint64_t began_ns = mu_clock_ns(); !told && waits(began_ns);) {
        told = verdict_print(&deliveries);
    }
    return told;
}

static bool user_data_told(bool is_broker)
{
    static struct bus_writer writer;
    if (!writer_open(is_broker ? BUS_BEACON : BUS_REGISTRATION, &writer)) {
        return false;
    }
    mu_result written =
        is_broker ? beacon_write(&writer) : registration_write(&writer, muster_WIRE);
    for (uint64_t began_ns = mu_clock_ns(); written == MU_OK && waits(began_ns);) {
    }
    return written == MU_OK;
}

int main(int argc, char **argv)
{
    const char *what = argc == 3 ? argv[2] : "";
    bool is_broker = strcmp(what, "beacon") == 0;
    struct bus_options options = {.domain = argc == 3 ? (int)strtol(argv[1], NULL, 10) : -1,
                                  .place = is_broker ? BUS_BROKER : BUS_AGENT,
                                  .name = "other_wire"};
    if (options.domain < 0 || bus_open(&bus, &options) != MU_OK) {
        return 4;
    }
    bool told = strcmp(what, "number") == 0 ? number_told() : user_data_told(is_broker);
    bus_close(&bus);
    return told ? 0 : 1;
}
