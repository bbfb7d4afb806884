/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/control/parts.h"

#include <string.h>

mu_result outlets_open(struct outlets *m, struct bus *bus, struct broker *b,
                       const struct bus_reader *ups, bool once)
{
    *m = (struct outlets){.bus = bus, .broker = b, .ups = ups, .once = once};
    return bus_writer_open(bus, BUS_DELIVERY, BUS_TO_ALL, NULL, &m->multicasts);
}

/* @return the writer to the process of this name, or NULL */
static struct outlet *outlet_of(struct outlets *m, uint32_t place)
{
    const struct process *at = &m->broker->processes.at[place];
    struct outlet *outlet = &m->at[place];
    bool is_its = at->session != SESSION_FREE && strcmp(outlet->process, at->name) == 0 &&
                  outlet->incarnation == at->incarnation;
    return is_its ? outlet : NULL;
}

struct outlet *outlets_find(struct outlets *m, const char *process)
{
    uint32_t place = processes_find(&m->broker->processes, process);
    return place != MU_NONE ? outlet_of(m, place) : NULL;
}

const struct bus_writer *outlets_writer(struct outlets *m, const char *process)
{
    const struct outlet *outlet = outlets_find(m, process);
    return outlet ? &outlet->writer : strcmp(process, BUS_TO_ALL) == 0 ? &m->multicasts : NULL;
}

uint64_t outlets_spoke_ns(struct outlets *m)
{
    uint64_t spoke_ns = UINT64_MAX;
    for (uint32_t i = 0; i < m->broker->processes.top; i++) {
        const struct outlet *outlet = outlet_of(m, i);
        spoke_ns = outlet && outlet->heard_ns < spoke_ns ? outlet->heard_ns : spoke_ns;
    }
    return spoke_ns != UINT64_MAX ? spoke_ns : 0;
}

/* --- opening and closing ---------------------------------------------------------------------- */

static void outlet_open(struct outlets *m, struct outlet *outlet, const struct process *at)
{
    *outlet = (struct outlet){.incarnation = at->incarnation};
    if (bus_writer_open(m->bus, BUS_DELIVERY, at->name, NULL, &outlet->writer) == MU_OK) {
        mu_text_copy(outlet->process, sizeof outlet->process, at->name);
    }
}

/* Another life of a neighbour gets a writer of its own: one keeps all that is written for the
 * reader of the life before, too, until DDS misses that, and what went out before it was heard is
 * lost. */
void outlets_follow(struct outlets *m, uint64_t now_ns)
{
    for (uint32_t i = 0; i < m->broker->processes.top; i++) {
        const struct process *at = &m->broker->processes.at[i];
        struct outlet *outlet = &m->at[i];
        if (outlet->process[0] != '\0' && !outlet_of(m, i)) {
            bus_writer_close(&outlet->writer);
            broker_matched(m->broker, outlet->process, false, now_ns);
            outlet->process[0] = '\0';
        }
        if (outlet->process[0] == '\0' && at->session != SESSION_FREE) {
            outlet_open(m, outlet, at);
        }
    }
}

/* --- matching --------------------------------------------------------------------------------- */

/* Both directions must stand before a registration is confirmed. */
static bool outlet_stands(const struct outlets *m, const struct outlet *outlet, bool stood,
                          const char *mute)
{
    if (bus_writer_matches(&outlet->writer) == 0) {
        return false; /* the usual case while many processes come, and cheap to see */
    }
    bool is_deaf = stood || strcmp(outlet->process, mute) == 0;
    return is_deaf ? bus_writer_reaches(&outlet->writer, outlet->process)
                   : bus_reader_hears(m->ups, &outlet->writer, outlet->process);
}

static uint32_t hearers_count(const struct outlets *m)
{
    return m->once ? bus_writer_matches(&m->multicasts) : 0;
}

/* A process that does not hear multicasts, such as a simulator, is asked again when one more does.
 */
static void outlet_listen(struct outlets *m, struct outlet *outlet, const struct process *at)
{
    bool asks = processes_is_matched(at) && !processes_hears(at);
    uint32_t hearers = asks ? hearers_count(m) : outlet->hearers;
    if (hearers == outlet->hearers) {
        return;
    }
    outlet->hearers = hearers;
    if (bus_writer_shares(&outlet->writer, outlet->process, &m->multicasts)) {
        broker_hears(m->broker, outlet->process);
    }
}

/* To ask DDS for the readers costs much more than to ask how many.  @return whether none has
 * come or gone since they were looked at, and nothing is missing */
static bool outlet_rests(const struct outlet *outlet, const struct process *at)
{
    return processes_hears(at) && outlet->readers_now == bus_writer_matches(&outlet->writer) &&
           outlet->readers == bus_writer_matched_ever(&outlet->writer);
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
        struct outlet *outlet = outlet_of(m, i);
        bool stood = processes_is_matched(at);
        if (!outlet || (stood && !all) || outlet_rests(outlet, at)) {
            continue;
        }
        uint32_t readers = bus_writer_matched_ever(&outlet->writer);
        outlet->readers_now = bus_writer_matches(&outlet->writer);
        bool stands = outlet_stands(m, outlet, stood, mute);
        if (stands != stood) {
            outlet->hearers = 0;
            broker_matched(b, outlet->process, stands, now_ns);
        }
        outlet_listen(m, outlet, at);
        outlet->readers = readers;
        some_missing = some_missing || !stands;
    }
    return some_missing;
}
