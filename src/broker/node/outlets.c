/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/control/parts.h"

#include <string.h>

mu_result outlets_open(struct outlets *m, struct bus *bus, struct broker *b,
                       const struct bus_reader *ups, bool once)
{
    *m = (struct outlets){.bus = bus, .broker = b, .ups = ups, .once = once};
    return bus_writer_open(bus, BUS_DELIVERY, BUS_TO_ALL, NULL, &m->circulars);
}

/* @return the writer to the process that has this place, or NULL */
static struct outlet *outlet_of(struct outlets *m, uint32_t place)
{
    const struct process *at = &m->broker->processes.at[place];
    struct outlet *bag = &m->at[place];
    return at->session != SESSION_FREE && strcmp(bag->process, at->name) == 0 ? bag : NULL;
}

struct outlet *outlets_find(struct outlets *m, const char *process)
{
    uint32_t place = processes_find(&m->broker->processes, process);
    return place != MU_NONE ? outlet_of(m, place) : NULL;
}

const struct bus_writer *outlets_writer(struct outlets *m, const char *process)
{
    const struct outlet *bag = outlets_find(m, process);
    return bag ? &bag->writer : strcmp(process, BUS_TO_ALL) == 0 ? &m->circulars : NULL;
}

uint64_t outlets_spoke_ns(struct outlets *m)
{
    uint64_t spoke_ns = UINT64_MAX;
    for (uint32_t i = 0; i < m->broker->processes.top; i++) {
        const struct outlet *bag = outlet_of(m, i);
        spoke_ns = bag && bag->heard_ns < spoke_ns ? bag->heard_ns : spoke_ns;
    }
    return spoke_ns != UINT64_MAX ? spoke_ns : 0;
}

/* --- opening and closing ---------------------------------------------------------------------- */

static void outlet_open(struct outlets *m, struct outlet *bag, const char *process)
{
    *bag = (struct outlet){0};
    if (bus_writer_open(m->bus, BUS_DELIVERY, process, NULL, &bag->writer) == MU_OK) {
        mu_text_copy(bag->process, sizeof bag->process, process);
    }
}

void outlets_follow(struct outlets *m)
{
    for (uint32_t i = 0; i < m->broker->processes.top; i++) {
        const struct process *at = &m->broker->processes.at[i];
        struct outlet *bag = &m->at[i];
        if (bag->process[0] != '\0' && !outlet_of(m, i)) {
            bus_writer_close(&bag->writer);
            bag->process[0] = '\0';
        }
        if (bag->process[0] == '\0' && at->session != SESSION_FREE) {
            outlet_open(m, bag, at->name);
        }
    }
}

/* --- matching --------------------------------------------------------------------------------- */

/* Both directions must stand before a registration is confirmed. */
static bool outlet_stands(const struct outlets *m, const struct outlet *bag, bool stood,
                          const char *mute)
{
    if (bus_writer_matches(&bag->writer) == 0) {
        return false; /* the usual case while many processes come, and cheap to see */
    }
    bool one_way = stood || strcmp(bag->process, mute) == 0;
    return one_way ? bus_writer_reaches(&bag->writer, bag->process)
                   : bus_reader_hears(m->ups, &bag->writer, bag->process);
}

static uint32_t hearers_count(const struct outlets *m)
{
    return m->once ? bus_writer_matches(&m->circulars) : 0;
}

/* A process that does not hear multicasts, such as a simulator, is asked again when one more does.
 */
static void outlet_listen(struct outlets *m, struct outlet *bag, const struct process *at)
{
    bool asks = processes_is_matched(at) && !processes_hears(at);
    uint32_t hearers = asks ? hearers_count(m) : bag->hearers;
    if (hearers == bag->hearers) {
        return;
    }
    bag->hearers = hearers;
    if (bus_writer_shares(&bag->writer, bag->process, &m->circulars)) {
        broker_hears(m->broker, bag->process);
    }
}

/* Another life of a neighbour reads what was for the one before, whose reader DDS may still take
 * for alive: what went out before it was found is lost. */
static void outlet_count_readers(struct outlet *bag, uint32_t readers, struct broker *b)
{
    if (bag->readers > 0 && readers > bag->readers) {
        broker_read_anew(b, bag->process);
    }
    bag->readers = readers;
}

/* To ask DDS for the readers costs much more than to ask how many.  @return whether none has
 * come or gone since they were looked at, and nothing is missing */
static bool outlet_rests(const struct outlet *bag, const struct process *at)
{
    return processes_hears(at) && bag->readers_now == bus_writer_matches(&bag->writer) &&
           bag->readers == bus_writer_matched_ever(&bag->writer);
}

bool outlets_look(struct outlets *m, const char *mute, bool all, uint64_t now_ns)
{
    struct broker *b = m->broker;
    bool some_missing = false;
    if (all) {
        b->multicast.readers = hearers_count(m);
    }
    for (uint32_t i = 0; i < b->processes.top; i++) {
        const struct process *at = &b->processes.at[i];
        struct outlet *bag = outlet_of(m, i);
        bool stood = processes_is_matched(at);
        if (!bag || (stood && !all) || outlet_rests(bag, at)) {
            continue;
        }
        uint32_t readers = bus_writer_matched_ever(&bag->writer);
        bag->readers_now = bus_writer_matches(&bag->writer);
        bool stands = outlet_stands(m, bag, stood, mute);
        if (stands != stood) {
            bag->hearers = 0;
            broker_matched(b, bag->process, stands, now_ns);
        }
        outlet_listen(m, bag, at);
        outlet_count_readers(bag, readers, b);
        some_missing = some_missing || !stands;
    }
    return some_missing;
}
