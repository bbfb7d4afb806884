/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/control/parts.h"

#include <string.h>

mu_result outlets_open(struct outlets *m, struct bus *bus, const struct bus_reader *ups, bool once)
{
    *m = (struct outlets){.bus = bus, .ups = ups, .once = once};
    mu_table_init(&m->names, MU_PROCESSES_MAX);
    for (uint32_t i = 0; i < MU_PROCESSES_MAX; i++) {
        m->order[i] = i;
    }
    return bus_writer_open(bus, BUS_DELIVERY, BUS_TO_ALL, NULL, &m->circulars);
}

const struct bus_writer *outlets_writer(struct outlets *m, const char *process)
{
    const struct outlet *bag = outlets_find(m, process);
    return bag ? &bag->writer : strcmp(process, BUS_TO_ALL) == 0 ? &m->circulars : NULL;
}

struct outlet *outlets_find(struct outlets *m, const char *process)
{
    uint32_t index = mu_table_find(&m->names, process);
    return index != MU_NONE ? &m->at[index] : NULL;
}

uint64_t outlets_spoke_ns(const struct outlets *m)
{
    uint64_t spoke_ns = UINT64_MAX;
    for (uint32_t i = 0; i < m->count; i++) {
        uint64_t heard_ns = m->at[m->order[i]].heard_ns;
        spoke_ns = heard_ns < spoke_ns ? heard_ns : spoke_ns;
    }
    return m->count > 0 ? spoke_ns : 0;
}

/* --- opening and closing ---------------------------------------------------------------------- */

static void outlet_open(struct outlets *m, const char *process)
{
    MU_ASSERT(m->count < MU_PROCESSES_MAX); /* the broker serves no more, and each bag is for one */
    uint32_t index = m->order[m->count];
    struct outlet *bag = &m->at[index];
    *bag = (struct outlet){0};
    mu_text_copy(bag->process, sizeof bag->process, process);
    if (bus_writer_open(m->bus, BUS_DELIVERY, process, NULL, &bag->writer) == MU_OK) {
        mu_result entered = mu_table_put(&m->names, bag->process, index);
        MU_ASSERT(entered == MU_OK);
        m->count++;
    }
}

static void outlet_close(struct outlets *m, struct outlet *bag)
{
    mu_result gone = mu_table_remove(&m->names, bag->process);
    MU_ASSERT(gone == MU_OK);
    bus_writer_close(&bag->writer);
}

void outlets_follow(struct outlets *m, const struct broker *b)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < m->count; i++) {
        uint32_t index = m->order[i];
        struct outlet *bag = &m->at[index];
        if (bag->matched || broker_serves(b, bag->process)) {
            m->order[i] = m->order[kept];
            m->order[kept++] = index;
        } else {
            outlet_close(m, bag);
        }
    }
    m->count = kept;
    for (const char *process = NULL; (process = broker_process(b, process));) {
        if (!outlets_find(m, process)) {
            outlet_open(m, process);
        }
    }
}

/* --- matching --------------------------------------------------------------------------------- */

/* Both directions must stand before a registration is confirmed. */
static bool outlet_stands(const struct outlets *m, const struct outlet *bag, const char *mute)
{
    if (bus_writer_matches(&bag->writer) == 0) {
        return false; /* the usual case while many processes come, and cheap to see */
    }
    bool one_way = bag->matched || strcmp(bag->process, mute) == 0;
    return one_way ? bus_writer_reaches(&bag->writer, bag->process)
                   : bus_reader_hears(m->ups, &bag->writer, bag->process);
}

static uint32_t hearers_count(const struct outlets *m)
{
    return m->once ? bus_writer_matches(&m->circulars) : 0;
}

/* A process that does not hear multicasts, such as a simulator, is asked again when one more does.
 */
static void outlet_listen(struct outlets *m, struct outlet *bag, struct broker *b)
{
    uint32_t hearers = bag->matched && !bag->hears ? hearers_count(m) : bag->hearers;
    if (hearers == bag->hearers) {
        return;
    }
    bag->hearers = hearers;
    bag->hears = bus_writer_shares(&bag->writer, bag->process, &m->circulars);
    if (bag->hears) {
        broker_hears(b, bag->process);
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
static bool outlet_rests(const struct outlet *bag)
{
    return bag->matched && bag->hears && bag->readers_now == bus_writer_matches(&bag->writer) &&
           bag->readers == bus_writer_matched_ever(&bag->writer);
}

bool outlets_look(struct outlets *m, struct broker *b, const char *mute, bool all, uint64_t now_ns)
{
    bool some_missing = false;
    if (all) {
        b->multicast.readers = hearers_count(m);
    }
    for (uint32_t i = 0; i < m->count; i++) {
        struct outlet *bag = &m->at[m->order[i]];
        if ((bag->matched && !all) || outlet_rests(bag)) {
            continue;
        }
        uint32_t readers = bus_writer_matched_ever(&bag->writer);
        bag->readers_now = bus_writer_matches(&bag->writer);
        bool matched = outlet_stands(m, bag, mute);
        if (matched != bag->matched) {
            bag->matched = matched;
            bag->hears = false;
            bag->hearers = 0;
            broker_matched(b, bag->process, matched, now_ns);
        }
        outlet_listen(m, bag, b);
        outlet_count_readers(bag, readers, b);
        some_missing = some_missing || !matched;
    }
    return some_missing;
}
