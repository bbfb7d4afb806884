/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/control/parts.h"
#include "core/log.h"

#include <stdio.h>
#include <string.h>

mu_result links_open(struct links *p, struct bus *bus, const char *place)
{
    *p = (struct links){.bus = bus};
    MU_TRY(bus_reader_open(bus, BUS_DELIVERY, place, &p->deliveries));
    return bus_writer_open(bus, BUS_REGISTRATION, NULL, NULL, &p->registration);
}

static const struct links_line *line_find(const struct links *p, const char *name)
{
    for (uint32_t i = 0; i < MU_BROKERS_MAX; i++) {
        if (strcmp(p->lines[i].name, name) == 0) {
            return &p->lines[i];
        }
    }
    return NULL;
}

static void line_open(struct links *p, struct links_line *line, const char *name)
{
    char place[MU_PROCESS_MAX + 1];
    snprintf(place, sizeof place, "broker.%s", name);
    if (bus_writer_open(p->bus, BUS_UP, place, NULL, &line->ups) == MU_OK) {
        mu_text_copy(line->name, sizeof line->name, name);
    } else {
        mu_log(MU_LOG_ERROR, "no-line-to-broker", "name=%s", name);
    }
}

void links_follow(struct links *p, const struct beacons *beacons, struct broker *b, uint64_t now_ns)
{
    uint32_t open = 0;
    for (uint32_t i = 0; i < beacons->count; i++) {
        const struct beacons_broker *other = &beacons->at[i];
        struct links_line *line = &p->lines[i];
        bool is_its = other->there && strcmp(line->name, other->name) == 0;
        if (line->name[0] != '\0' && !is_its) {
            bus_writer_close(&line->ups);
            line->name[0] = '\0';
        }
        if (other->there && !is_its) {
            line_open(p, line, other->name);
        }
        open += line->name[0] != '\0';
    }
    broker_peers(b, open, now_ns);
}

/* Once: it goes on as long as there are so many. */
static void passed_over_tell(struct links *p, const struct broker *b)
{
    const char *name = b->federation.passed_over;
    if (name[0] != '\0' && !p->overflows) {
        p->overflows = true;
        mu_log(MU_LOG_WARNING, "neighbour-passed-over", "name=%s most=%d", name, MU_BROKERS_MAX);
    }
}

void links_take(struct links *p, struct broker *b, uint64_t now_ns)
{
    enum bus_life life;
    const muster_Delivery *d;
    while ((d = bus_next(&p->deliveries, &life))) {
        if (life == BUS_DATA) {
            broker_delivery(b, d, now_ns);
        }
    }
    passed_over_tell(p, b);
}

bool links_tell(struct links *p, struct broker *b)
{
    muster_Registration r;
    muster_Up up;
    const char *name;
    while (broker_announcement(b, &r)) {
        if (bus_write(&p->registration, &r) != MU_OK) {
            return false;
        }
        broker_announced(b);
    }
    while (broker_up_next(b, &name, &up)) {
        const struct links_line *line = line_find(p, name);
        /* For one that is silent there is nothing to say: it will hand all of it out again. */
        if (line && bus_write(&line->ups, &up) != MU_OK) {
            return false;
        }
        broker_up_sent(b);
    }
    return true;
}
