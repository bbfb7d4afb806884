/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Looks at what goes to simulator and processes, as any tool on DDS does: comes, opens readers of
 * Up and Delivery, and goes again, so many times or until there is nothing more.  At the end a
 * line: how often it saw one, how many samples, and how many steps came twice or were missing
 * between the first and the last.  Each time it is a participant of its own: readers that follow
 * others in one participant get what DDS still sends to those, before a writer knows them.
 *   up_watcher DOMAIN TIMES MS
 */
#include "bus/bus.h"
#include "core/clock.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WRITERS = 64 };

static const uint64_t PATIENCE_NS = 20000000000; /* until a run has begun, or is over */

static struct {
    char process[MU_PROCESS_MAX + 1];
    int64_t step;
} last[WRITERS];
static uint64_t visits, samples, twice, missing;

static void step_note(const char *process, int64_t step)
{
    int i = 0;
    while (last[i].process[0] && strcmp(last[i].process, process) != 0) {
        i++;
    }
    if (i == WRITERS - 1) {
        exit(5);
    }
    bool known = last[i].process[0] != '\0';
    twice += known && step <= last[i].step;
    missing += known && step > last[i].step + 1;
    samples++;
    snprintf(last[i].process, sizeof last[i].process, "%s", process);
    last[i].step = step;
}

static void ups_take(struct bus_reader *ups)
{
    enum bus_life life;
    const muster_Up *up;
    while ((up = bus_next(ups, &life))) {
        if (life == BUS_DATA && up->step > 0) {
            step_note(up->process, up->step);
        }
    }
}

static void deliveries_take(struct bus_reader *deliveries)
{
    enum bus_life life;
    const muster_Delivery *d;
    while ((d = bus_next(deliveries, &life))) {
        if (life == BUS_DATA && d->step > 0) {
            char reader[sizeof last[0].process];
            snprintf(reader, sizeof reader, "to %.*s", MU_PROCESS_MAX - 3, d->process);
            step_note(reader, d->step);
        }
    }
}

/* @return whether there was anything to see, which is looked at for so long from its first sample
 */
static bool look(const struct bus_options *options, uint64_t for_ns)
{
    static struct bus bus;
    static struct bus_reader ups, deliveries;
    memset(last, 0, sizeof last);
    if (bus_open(&bus, options) != MU_OK ||
        bus_reader_open(&bus, BUS_UP, "simulator", &ups) != MU_OK ||
        bus_reader_open(&bus, BUS_DELIVERY, "p*", &deliveries) != MU_OK) {
        exit(4);
    }
    uint64_t before = samples, until_ns = mu_clock_ns() + PATIENCE_NS;
    while (mu_clock_ns() < until_ns) {
        bool none = samples == before;
        bus_wait(&bus, 1, 1000000);
        ups_take(&ups);
        deliveries_take(&deliveries);
        if (none && samples > before) {
            until_ns = mu_clock_ns() + for_ns;
        }
    }
    bus_reader_close(&ups);
    bus_reader_close(&deliveries);
    bus_close(&bus);
    return samples > before;
}

int main(int argc, char **argv)
{
    struct bus_options options = {.domain = argc == 4 ? (int)strtol(argv[1], NULL, 10) : -1,
                                  .place = BUS_OBSERVER,
                                  .name = "up_watcher",
                                  .local = "off"};
    if (options.domain < 0) {
        return 4;
    }
    while (visits < strtoul(argv[2], NULL, 10) &&
           look(&options, strtoul(argv[3], NULL, 10) * 1000000)) {
        visits++;
    }
    printf("{\"visits\": %llu, \"samples\": %llu, \"twice\": %llu, \"missing\": %llu}\n",
           (unsigned long long)visits, (unsigned long long)samples, (unsigned long long)twice,
           (unsigned long long)missing);
    return 0;
}
