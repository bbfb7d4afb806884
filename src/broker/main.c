/* SPDX-License-Identifier: Apache-2.0 */
/* muster-broker: the broker on the network.  What it decides is in broker.c; here it is done. */
#include "broker/beacons.h"
#include "broker/broker.h"
#include "bus/bus.h"
#include "core/clock.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/name.h"
#include "core/network.h"
#include "core/options.h"
#include "core/text.h"
#include "muster/memory.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* How often, by the wall, matched writers are looked at and counters are told. */
static const uint64_t LOOK_NS = 100000000;
static const int64_t IMPATIENT_NS = 2000000;

/* How long a lock step waits for its paths to be warm: busy mail must not keep it from beginning.
 */
static const uint64_t ROSTER_PATIENCE_NS = 500000000;

/* How often a broker says that it is there. */
static const uint64_t HEARTBEAT_NS = 300000000;

/* So long it listens for another one of its name before it answers anybody. */
static const uint64_t DOUBT_NS = 300000000;

/* The writer into one process's partition. */
struct mailbag {
    char process[MU_PROCESS_MAX + 1];
    struct bus_writer writer;
    bool matched;
    bool heard; /* an Up of it has come */
};

struct post {
    struct bus bus;
    struct broker *broker;
    struct beacons beacons;
    struct bus_reader registrations, ups, rosters, heard;
    struct bus_writer members, status, beacon;
    struct mailbag bags[MU_PROCESSES_MAX];
    uint32_t bag_count;
    const muster_Roster *roster;        /* on loan, waits until all of its processes were heard */
    uint64_t roster_ns;                 /* since when */
    char simulator[MU_PROCESS_MAX + 1]; /* of the last roster: it gets mail and sends none */
    uint64_t began_ns, looked_ns, beacon_ns;
    bool sure;                /* no other broker has our name */
    bool yields;              /* another one has it */
    muster_BrokerStatus told; /* the counters that were told last */
};

static volatile sig_atomic_t signal_came;

static void signal_note(int number)
{
    (void)number;
    signal_came = 1;
}

static uint64_t post_now(const struct post *p)
{
    return mu_clock_ns() - p->began_ns;
}

static mu_result post_open(struct post *p)
{
    MU_TRY(bus_reader_open(&p->bus, BUS_REGISTRATION, NULL, &p->registrations));
    MU_TRY(bus_writer_open(&p->bus, BUS_BEACON, NULL, NULL, &p->beacon));
    MU_TRY(bus_reader_open(&p->bus, BUS_BEACON, NULL, &p->heard));
    char partition[sizeof "broker." + MU_NAME_MAX];
    snprintf(partition, sizeof partition, "broker.%s", p->beacons.name);
    MU_TRY(bus_reader_open(&p->bus, BUS_UP, partition, &p->ups));
    MU_TRY(bus_reader_open(&p->bus, BUS_ROSTER, NULL, &p->rosters));
    MU_TRY(bus_writer_open(&p->bus, BUS_MEMBER, NULL, NULL, &p->members));
    MU_TRY(bus_writer_open(&p->bus, BUS_BROKER_STATUS, NULL, NULL, &p->status));
    return MU_OK;
}

/* --- the other brokers ------------------------------------------------------------------------ */

static void beacon_take(struct post *p, const muster_Beacon *beacon)
{
    switch (beacons_hear(&p->beacons, beacon)) {
    case BEACON_NOTHING: break;
    case BEACON_MET:
        mu_log(MU_LOG_INFO, "broker-met", "name=%s host=%s pid=%u index=%u", beacon->broker,
               beacon->host, beacon->pid, beacon->index);
        break;
    case BEACON_LATER:
        mu_log(MU_LOG_WARNING, "name-claimed", "name=%s host=%s pid=%u", beacon->broker,
               beacon->host, beacon->pid);
        break;
    case BEACON_EARLIER:
        fprintf(stderr,
                "muster broker: the network has a broker named %s already, on %s (process %u); "
                "give this one another name\n",
                beacon->broker, beacon->host, beacon->pid);
        p->yields = true;
        break;
    }
}

static void beacons_take(struct post *p)
{
    enum bus_life life;
    const muster_Beacon *beacon;
    while (!p->yields && (beacon = bus_next(&p->heard, &life))) {
        if (life == BUS_DATA) {
            beacon_take(p, beacon);
        } else if (beacons_lose(&p->beacons, beacon->broker)) {
            mu_log(MU_LOG_INFO, "broker-lost", "name=%s", beacon->broker);
        }
    }
}

static void beacon_tell(struct post *p)
{
    uint64_t now_ns = mu_clock_ns();
    if (p->beacon_ns && now_ns - p->beacon_ns < HEARTBEAT_NS) {
        return;
    }
    p->beacon_ns = now_ns;
    muster_BrokerStatus status = {0};
    broker_status(p->broker, &status);
    muster_Beacon beacon = {.broker = p->beacons.name,
                            .incarnation = p->beacons.incarnation,
                            .host = p->beacons.host,
                            .pid = p->beacons.pid,
                            .index = p->bus.index > 0 ? (uint32_t)p->bus.index : 0,
                            .agents = status.agents,
                            .takes_agents = p->sure && status.agents < MU_AGENTS_MAX};
    mu_result written = bus_write(&p->beacon, &beacon);
    (void)written; /* the next heartbeat says it again */
}

/* Nobody is answered while another broker of this name may be there. */
static void doubt_settle(struct post *p, bool is_lone)
{
    while (!is_lone && !p->yields && !signal_came && post_now(p) < DOUBT_NS) {
        beacons_take(p);
        beacon_tell(p);
        bus_wait(&p->bus, 1, IMPATIENT_NS);
    }
    p->sure = true;
    p->beacon_ns = 0;
}

/* --- in --------------------------------------------------------------------------------------- */

static void registrations_take(struct post *p)
{
    enum bus_life life;
    const muster_Registration *r;
    while ((r = bus_next(&p->registrations, &life))) {
        if (life == BUS_DATA && strcmp(r->broker, p->beacons.name) == 0) {
            broker_registration(p->broker, r, post_now(p));
        } else if (life == BUS_DATA) {
            broker_gone(p->broker, r->name, r->process, false, post_now(p)); /* it is elsewhere */
        } else {
            broker_gone(p->broker, r->name, r->process, life == BUS_LOST, post_now(p));
        }
    }
}

static struct mailbag *bag_find(struct post *p, const char *process)
{
    for (uint32_t i = 0; i < p->bag_count; i++) {
        if (strcmp(p->bags[i].process, process) == 0) {
            return &p->bags[i];
        }
    }
    return NULL;
}

/* Whatever comes late on a path delays all that comes after it, and the first samples of a DDS
 * writer can be late.  @return whether an Up of every process of a roster has come, and every
 * Delivery to it has arrived */
static bool roster_is_heard(struct post *p, const muster_Roster *roster)
{
    for (uint32_t i = 0; roster->lockstep && i < roster->processes._length; i++) {
        const struct mailbag *bag = bag_find(p, roster->processes._buffer[i]);
        if (!bag || !bag->heard || !bus_drain(&bag->writer, 0)) {
            return false;
        }
    }
    return true;
}

/* The end of a roster has the simulator's name alone. */
static bool roster_is_ours(const struct post *p, const muster_Roster *roster, enum bus_life life)
{
    if (life != BUS_DATA) {
        return strcmp(roster->simulator, p->simulator) == 0;
    }
    return roster->broker[0] == '\0' || strcmp(roster->broker, p->beacons.name) == 0;
}

static void rosters_take(struct post *p)
{
    enum bus_life life = BUS_DATA;
    while (p->roster || (p->roster = bus_next(&p->rosters, &life))) {
        if (!roster_is_ours(p, p->roster, life)) {
            p->roster = NULL;
            continue;
        }
        p->roster_ns = p->roster_ns ? p->roster_ns : mu_clock_ns();
        bool may_wait = life == BUS_DATA && mu_clock_ns() - p->roster_ns < ROSTER_PATIENCE_NS;
        if (may_wait && !roster_is_heard(p, p->roster)) {
            return;
        }
        p->roster_ns = 0;
        muster_Roster ended = {.simulator = p->roster->simulator, .lockstep = false};
        broker_roster(p->broker, life == BUS_DATA ? p->roster : &ended, post_now(p));
        mu_text_copy(p->simulator, sizeof p->simulator, p->roster->simulator);
        p->roster = NULL;
    }
}

static void up_take(struct post *p, const muster_Up *up)
{
    struct mailbag *bag = bag_find(p, up->process);
    if (bag) {
        bag->heard = true;
    }
    broker_up(p->broker, up, post_now(p));
}

static void post_take(struct post *p)
{
    enum bus_life life;
    registrations_take(p);
    const muster_Up *up;
    while ((up = bus_next(&p->ups, &life))) {
        if (life == BUS_DATA) {
            up_take(p, up);
        }
    }
    rosters_take(p);
}

/* --- out -------------------------------------------------------------------------------------- */

static void bag_add(struct post *p, const char *process)
{
    if (p->bag_count == MU_PROCESSES_MAX) {
        mu_log(MU_LOG_ERROR, "too-many-processes", "process=%s max=%d", process, MU_PROCESSES_MAX);
        return;
    }
    struct mailbag *bag = &p->bags[p->bag_count];
    *bag = (struct mailbag){0};
    mu_text_copy(bag->process, sizeof bag->process, process);
    if (bus_writer_open(&p->bus, BUS_DELIVERY, process, NULL, &bag->writer) == MU_OK) {
        p->bag_count++;
    }
}

/* Opens a bag for every new process, and closes those of processes that are gone for good. */
static void bags_follow(struct post *p)
{
    const char *process;
    for (uint32_t i = 0; (process = broker_process(p->broker, i)); i++) {
        if (!bag_find(p, process)) {
            bag_add(p, process);
        }
    }
    uint32_t kept = 0;
    for (uint32_t i = 0; i < p->bag_count; i++) {
        struct mailbag *bag = &p->bags[i];
        if (bag->matched || broker_serves(p->broker, bag->process)) {
            p->bags[kept++] = *bag;
        } else {
            bus_writer_close(&bag->writer);
        }
    }
    p->bag_count = kept;
}

/* Both directions must stand before a registration is confirmed; the simulator sends no mail. */
static bool bag_stands(const struct post *p, const struct mailbag *bag)
{
    bool mute = bag->matched || strcmp(bag->process, p->simulator) == 0;
    return mute ? bus_writer_reaches(&bag->writer, bag->process)
                : bus_reader_hears(&p->ups, &bag->writer, bag->process);
}

/* Tells the broker which processes have matched.  @return whether any has not */
static bool bags_look(struct post *p, bool all)
{
    bool some_missing = false;
    for (uint32_t i = 0; i < p->bag_count; i++) {
        struct mailbag *bag = &p->bags[i];
        if (bag->matched && !all) {
            continue;
        }
        bool matched = bag_stands(p, bag);
        if (matched != bag->matched) {
            bag->matched = matched;
            broker_matched(p->broker, bag->process, matched, post_now(p));
        }
        some_missing = some_missing || !matched;
    }
    return some_missing;
}

/* @return whether the network took all that was ready */
static bool deliveries_write(struct post *p)
{
    const char *process;
    muster_Delivery delivery;
    while (broker_next(p->broker, &process, &delivery)) {
        delivery.broker_incarnation = p->beacons.incarnation;
        const struct mailbag *bag = bag_find(p, process);
        if (!bag || bus_write(&bag->writer, &delivery) != MU_OK) {
            broker_undelivered(p->broker);
            return false;
        }
        broker_delivered(p->broker, post_now(p));
    }
    return true;
}

static void members_tell(struct post *p)
{
    muster_Member member;
    while (broker_member_news(p->broker, &member)) {
        mu_result written = bus_write(&p->members, &member);
        (void)written; /* reliable, and the last state of a line is what counts */
    }
}

static void status_tell(struct post *p)
{
    muster_BrokerStatus status = {0};
    broker_status(p->broker, &status);
    status.malformed += p->bus.malformed;
    if (memcmp(&status, &p->told, sizeof status) != 0 && bus_write(&p->status, &status) == MU_OK) {
        p->told = status;
    }
}

/* --- the loop --------------------------------------------------------------------------------- */

/* While it waits for a whole step, whoever is not in the lock step waits for at most so long. */
static const uint64_t OUTSIDE_PATIENCE_NS = 5000000;

static int64_t wait_ns(const struct post *p, bool impatient)
{
    uint64_t now_ns = post_now(p);
    uint64_t due_ns = broker_deadline_ns(p->broker);
    uint64_t most_ns = impatient ? (uint64_t)IMPATIENT_NS : LOOK_NS;
    if (broker_samples_wanted(p->broker) > 1 && most_ns > OUTSIDE_PATIENCE_NS) {
        most_ns = OUTSIDE_PATIENCE_NS;
    }
    uint64_t until_ns = due_ns > now_ns ? due_ns - now_ns : 0;
    return (int64_t)(until_ns < most_ns ? until_ns : most_ns);
}

static void post_round(struct post *p)
{
    beacons_take(p);
    beacon_tell(p);
    post_take(p);
    bool look = mu_clock_ns() - p->looked_ns >= LOOK_NS;
    bags_follow(p);
    bool impatient = bags_look(p, look);
    broker_tick(p->broker, post_now(p));
    impatient = !deliveries_write(p) || impatient;
    members_tell(p);
    if (look) {
        p->looked_ns = mu_clock_ns();
        status_tell(p);
    }
    bus_wait(&p->bus, broker_samples_wanted(p->broker), wait_ns(p, impatient));
}

/* A broker that gives way leaves the Beacon to the other one: disposed, both would be gone. */
static int post_close(struct post *p)
{
    if (p->yields) {
        return MU_EXIT_DDS;
    }
    muster_Beacon beacon = {.broker = p->beacons.name, .host = p->beacons.host};
    bus_dispose(&p->beacon, &beacon);
    status_tell(p);
    (void)bus_drain(&p->status, 200000000);
    return MU_EXIT_DONE;
}

int main(int argc, char **argv)
{
    struct mu_network network = {0};
    bool verbose = false;
    struct mu_option table[] = {
        MU_NETWORK_OPTIONS(network),
        {.name = "verbose",
         .letter = 'v',
         .kind = MU_OPTION_FLAG,
         .help = "log what happens",
         .target = &verbose},
    };
    static struct mu_options options;
    options = (struct mu_options){.program = "muster broker",
                                  .usage = "NAME [OPTION...]",
                                  .about = "Knows every agent by name and carries their mail.",
                                  .table = table,
                                  .count = sizeof table / sizeof table[0]};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (options.words_count != 1 || !mu_name_valid(options.words[0])) {
        fprintf(stderr, "muster broker: give it one name, for example: muster broker main\n");
        return MU_EXIT_USAGE;
    }
    mu_log_open("broker", verbose ? MU_LOG_INFO : MU_LOG_WARNING);

    struct post *p = mu_startup_alloc(sizeof *p);
    p->began_ns = mu_clock_ns();
    char host[MU_FIELD_MAX + 1] = "";
    gethostname(host, sizeof host - 1);
    struct broker_options broker = {.name = options.words[0],
                                    .incarnation = mu_clock_wall_ns(),
                                    .host = host,
                                    .pid = (uint32_t)getpid(),
                                    .wall_ns = mu_clock_wall_ns()};
    p->broker = broker_open(&broker);
    p->beacons = (struct beacons){.incarnation = broker.incarnation, .pid = broker.pid};
    mu_text_copy(p->beacons.name, sizeof p->beacons.name, broker.name);
    mu_text_copy(p->beacons.host, sizeof p->beacons.host, host);
    struct bus_options bus = {.domain = (int)network.domain,
                              .place = BUS_BROKER,
                              .name = "broker",
                              .interface = network.interface,
                              .hub = mu_network_peers(&network)};
    mu_result opened = bus_open(&p->bus, &bus);
    if (opened == MU_BUSY) {
        fprintf(stderr, "muster broker: domain %d has as many brokers on this host as it can\n",
                bus.domain);
    }
    if (opened != MU_OK || post_open(p) != MU_OK) {
        return MU_EXIT_DDS;
    }
    struct sigaction note = {.sa_handler = signal_note};
    sigaction(SIGINT, &note, NULL);
    sigaction(SIGTERM, &note, NULL);
    mu_memory_seal();
    doubt_settle(p, network.peers.count == 0 && bus_is_lone_broker(&p->bus, bus.domain));
    mu_log(MU_LOG_INFO, "broker-is-up", "name=%s domain=%d index=%d", broker.name, bus.domain,
           p->bus.index);
    while (!signal_came && !p->yields) {
        post_round(p);
    }
    int code = post_close(p);
    bus_close(&p->bus);
    return code;
}
