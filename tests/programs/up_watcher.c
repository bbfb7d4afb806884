/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Looks at what goes to simulator and processes, as any tool on DDS does: opens readers of Up and
 * Delivery and closes them again, so many times.  At the end a line: how often it saw one, how many
 * samples, and how many steps came twice or were missing between the first and the last.
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

static struct bus bus;
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

static void look(uint64_t for_ns)
{
    static struct bus_reader ups, deliveries;
    enum bus_life life;
    const muster_Up *up;
    uint64_t until_ns = mu_clock_ns() + for_ns, before = samples;
    memset(last, 0, sizeof last);
    if (bus_reader_open(&bus, BUS_UP, "simulator", &ups) != MU_OK ||
        bus_reader_open(&bus, BUS_DELIVERY, "p*", &deliveries) != MU_OK) {
        exit(4);
    }
    while (mu_clock_ns() < until_ns) {
        bus_wait(&bus, 1, 1000000);
        while ((up = bus_next(&ups, &life))) {
            if (life == BUS_DATA && up->step > 0) {
                step_note(up->process, up->step);
            }
        }
        const muster_Delivery *d;
        while ((d = bus_next(&deliveries, &life))) {
            if (life == BUS_DATA && d->step > 0) {
                char reader[sizeof last[0].process];
                snprintf(reader, sizeof reader, "to %.*s", MU_PROCESS_MAX - 3, d->process);
                step_note(reader, d->step);
            }
        }
    }
    visits += samples > before;
    bus_reader_close(&ups);
    bus_reader_close(&deliveries);
}

int main(int argc, char **argv)
{
    struct bus_options options = {.domain = argc == 4 ? (int)strtol(argv[1], NULL, 10) : -1,
                                  .place = BUS_OBSERVER,
                                  .name = "up_watcher",
                                  .local = "off"};
    if (options.domain < 0 || bus_open(&bus, &options) != MU_OK) {
        return 4;
    }
    for (long i = strtol(argv[2], NULL, 10); i > 0; i--) {
        look(strtoul(argv[3], NULL, 10) * 1000000);
    }
    printf("{\"visits\": %llu, \"samples\": %llu, \"twice\": %llu, \"missing\": %llu}\n",
           (unsigned long long)visits, (unsigned long long)samples, (unsigned long long)twice,
           (unsigned long long)missing);
    return 0;
}
