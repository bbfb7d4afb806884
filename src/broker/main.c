/* SPDX-License-Identifier: Apache-2.0 */
/* muster-broker: the broker on the network.  What it decides is in broker.c; here it is done. */
#include "broker/control/parts.h"
#include "broker/node/node.h"
#include "bus/config.h"
#include "core/clock.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/signals.h"
#include "muster/memory.h"
#include "muster/version.h"

#include <malloc.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>

/* How often, by the wall, matched writers are looked at and counters are told. */
static const uint64_t LOOK_NS = HEALTH_NEWS_NS;
static const int64_t IMPATIENT_NS = 2000000;

/* How long a lock step waits for its paths to be warm: busy mail must not keep it from beginning.
 */
static const uint64_t ROSTER_PATIENCE_NS = 500000000;

/* So long it listens for another one of its name before it answers any process. */
static const uint64_t DOUBT_NS = 300000000;

struct node {
    struct bus bus;
    struct startup own; /* the broker, its store and its files */
    struct bus_reader registrations, ups, rosters;
    struct bus_writer pages, events;
    struct telemetry health;
    struct beacon beacon;
    struct links peers;
    struct outlets outlets;
    const muster_Roster *roster;        /* on loan, waits until all of its processes were heard */
    uint64_t roster_ns;                 /* since when */
    char simulator[MU_PROCESS_MAX + 1]; /* of the last roster: it gets mail and sends none */
    uint64_t began_ns, looked_ns;
    bool unmatched; /* a process has come or gone, or its path does not stand yet */
};

static uint64_t post_now(const struct node *p)
{
    return mu_clock_ns() - p->began_ns;
}

static mu_result post_open(struct node *p, bool on_loopback)
{
    struct broker *b = p->own.broker;
    MU_TRY(bus_reader_open(&p->bus, BUS_REGISTRATION, NULL, &p->registrations));
    MU_TRY(bus_reader_open(&p->bus, BUS_UP, b->place, &p->ups));
    MU_TRY(bus_reader_open(&p->bus, BUS_ROSTER, NULL, &p->rosters));
    MU_TRY(bus_writer_open(&p->bus, BUS_PAGES, NULL, NULL, &p->pages));
    MU_TRY(bus_writer_open(&p->bus, BUS_BROKER_EVENT, NULL, NULL, &p->events));
    MU_TRY(outlets_open(&p->outlets, &p->bus, b, &p->ups, on_loopback));
    MU_TRY(links_open(&p->peers, &p->bus, b->place));
    MU_TRY(telemetry_open(&p->health, &p->bus));
    return beacon_open(&p->beacon, &p->bus, b);
}

/* --- in --------------------------------------------------------------------------------------- */

/* Whatever comes late on a path delays all that comes after it, and the first samples of a DDS
 * writer can be late.  @return whether an Up of every process of a roster has come, and every
 * Delivery to it has arrived */
static bool roster_is_heard(struct node *p, const muster_Roster *roster)
{
    for (uint32_t i = 0; roster->lockstep && i < roster->processes._length; i++) {
        const struct outlet *outlet = outlets_find(&p->outlets, roster->processes._buffer[i]);
        if (!outlet || outlet->heard_ns == 0 || !bus_drain(&outlet->writer, 0)) {
            return false;
        }
    }
    return !roster->lockstep || !p->outlets.once || bus_drain(&p->outlets.multicasts, 0);
}

/* The end of a roster has the simulator's name alone. */
static bool roster_is_ours(const struct node *p, const muster_Roster *roster, enum bus_life life)
{
    if (life != BUS_DATA) {
        return strcmp(roster->simulator, p->simulator) == 0;
    }
    return roster->broker[0] == '\0' || strcmp(roster->broker, p->own.broker->name) == 0;
}

static void rosters_take(struct node *p)
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
        broker_roster(p->own.broker, life == BUS_DATA ? p->roster : &ended, post_now(p));
        mu_text_copy(p->simulator, sizeof p->simulator, p->roster->simulator);
        p->roster = NULL;
    }
}

static void ups_take(struct node *p)
{
    enum bus_life life;
    const muster_Up *up;
    while ((up = bus_next(&p->ups, &life))) {
        if (life != BUS_DATA) {
            continue;
        }
        uint64_t now_ns = mu_clock_ns();
        struct outlet *outlet = outlets_find(&p->outlets, up->process);
        if (outlet) {
            outlet->heard_ns = now_ns;
        }
        broker_up(p->own.broker, up, now_ns - p->began_ns);
    }
}

/* A process that leaves has said its last before: that is heard first.  @return whether any process
 * came, changed or went */
static bool registrations_take(struct node *p)
{
    bool some = false;
    enum bus_life life;
    const muster_Registration *r;
    char who[128];
    while (bus_reader_meets(&p->registrations, who, sizeof who)) {
        mu_log(MU_LOG_WARNING, "other-version",
               "who=\"%s\" ours=%s does=\"it is not heard: use programs of one version\"", who,
               MU_VERSION);
    }
    while ((r = bus_next(&p->registrations, &life))) {
        some = true;
        ups_take(p);
        if (life == BUS_DATA) {
            broker_registration(p->own.broker, r, post_now(p));
        } else {
            broker_gone(p->own.broker, r->process, r->part, life == BUS_LOST, post_now(p));
        }
    }
    return some;
}

/* @return whether processes may have come or gone */
static bool post_take(struct node *p, uint64_t run_ns)
{
    bool some = registrations_take(p);
    ups_take(p);
    links_take(&p->peers, p->own.broker, run_ns);
    rosters_take(p);
    return some || p->roster;
}

/* --- out -------------------------------------------------------------------------------------- */

/* One that the network does not take holds up no other.  @return whether it took all */
static bool deliveries_write(struct node *p)
{
    const char *process;
    muster_Delivery delivery;
    bool all = true;
    while (broker_next(p->own.broker, &process, &delivery)) {
        const struct bus_writer *writer = outlets_writer(&p->outlets, process);
        if (!writer || bus_write(writer, &delivery) != MU_OK) {
            broker_undelivered(p->own.broker);
            all = false;
        } else {
            broker_delivered(p->own.broker, post_now(p));
        }
    }
    return all;
}

static void pages_publish(struct node *p)
{
    muster_Page page;
    while (broker_page_news(p->own.broker, &page)) {
        if (bus_write(&p->pages, &page) != MU_OK) {
            registry_mark_page(&p->own.broker->registry, page.part);
            return;
        }
    }
}

static void alerts_tell(struct node *p)
{
    muster_BrokerEvent event;
    while (broker_event_next(p->own.broker, &event)) {
        mu_result written = bus_write(&p->events, &event);
        (void)written; /* the counters, which are told again and again, have it too */
        mu_log(MU_LOG_INFO, event.kind, "agent=%s sender=%s count=%llu", event.agent, event.sender,
               (unsigned long long)event.count);
    }
}

/* --- the loop --------------------------------------------------------------------------------- */

/* While it waits for a whole step, a process outside the lock step waits for at most so long. */
static const int64_t OUTSIDE_PATIENCE_NS = 2000000;

static int64_t wait_ns(const struct node *p, bool impatient)
{
    uint64_t now_ns = post_now(p), due_ns = broker_deadline_ns(p->own.broker);
    uint64_t most_ns = impatient || p->roster ? (uint64_t)IMPATIENT_NS : LOOK_NS;
    uint64_t until_ns = due_ns > now_ns ? due_ns - now_ns : 0;
    return (int64_t)(until_ns < most_ns ? until_ns : most_ns);
}

/* A step that does not come for so long is paced, or a process is slow: then the next one that
 * speaks is heard at once. */
static void samples_await(struct node *p, bool impatient)
{
    uint64_t wanted = broker_samples_wanted(p->own.broker);
    int64_t most_ns = wait_ns(p, impatient);
    int64_t whole_ns = most_ns < OUTSIDE_PATIENCE_NS ? most_ns : OUTSIDE_PATIENCE_NS;
    if (wanted < 2) {
        (void)bus_wait(&p->bus, 1, most_ns);
    } else if (!bus_wait(&p->bus, wanted, whole_ns)) {
        (void)bus_wait(&p->bus, 1, most_ns - whole_ns);
    }
}

/* What must be on disk before any process is told. */
static void store_write(struct node *p)
{
    muster_Level level;
    if (p->own.disk && journal_wanted(p->own.broker, &level)) {
        (void)disk_commit(p->own.disk, p->own.broker, level, post_now(p));
    }
}

static void post_round(struct node *p)
{
    uint64_t now_ns = mu_clock_ns(), run_ns = now_ns - p->began_ns;
    beacon_hear(&p->beacon);
    beacon_tell(&p->beacon, p->own.broker, &p->outlets, now_ns);
    links_follow(&p->peers, &p->beacon.beacons.others, p->own.broker, run_ns);
    p->unmatched = post_take(p, run_ns) || p->unmatched;
    bool look = now_ns - p->looked_ns >= LOOK_NS;
    if (look || p->unmatched) {
        outlets_follow(&p->outlets, run_ns);
        p->unmatched = outlets_look(&p->outlets, p->simulator, look, run_ns);
    }
    broker_tick(p->own.broker, post_now(p));
    store_write(p);
    bool impatient = !links_tell(&p->peers, p->own.broker) || p->unmatched;
    impatient = !deliveries_write(p) || impatient;
    pages_publish(p);
    alerts_tell(p);
    files_audit_write(&p->own.audit, p->own.broker);
    if (look) {
        p->looked_ns = now_ns;
        telemetry_tell(&p->health, p->own.broker, p->looked_ns);
        if (p->own.disk) {
            disk_rest(p->own.disk, post_now(p));
        }
    }
    samples_await(p, impatient);
}

/* No process is answered while another broker of this name may be there. */
static void doubt_settle(struct node *p, bool is_lone)
{
    struct beacon *h = &p->beacon;
    uint64_t until_ns = post_now(p) + DOUBT_NS;
    while (!is_lone && !h->yields && !mu_signal_came && post_now(p) < until_ns) {
        beacon_hear(h);
        beacon_tell(h, p->own.broker, &p->outlets, mu_clock_ns());
        bus_wait(&p->bus, 1, IMPATIENT_NS);
    }
    h->sure = true;
    h->pulse.told_ns = 0; /* agents may come from now on */
}

/* Joins the network.  @return MU_EXIT_DONE, or the exit code, explained */
static int network_join(struct node *p, const struct mu_network *network)
{
    mu_result opened = bus_join(&p->bus, network, BUS_BROKER, "broker");
    if (opened == MU_BUSY) {
        fprintf(stderr, "muster broker: domain %d has as many brokers on this host as it can\n",
                (int)network->domain);
    }
    opened = opened == MU_OK ? post_open(p, config_is_loopback(network->interface)) : opened;
    return mu_exit_for(opened);
}

/* DDS takes and frees buffers for packets as long as the broker lives.  By default the first that
 * is freed raises the size up to which the heap keeps such pieces, and what it keeps lies scattered
 * among small ones that stay.  Before any thread starts. */
static void heap_bound(void)
{
    enum { LARGE_BYTES = 128 * 1024, FREE_BYTES = 1024 * 1024 };
    mallopt(M_MMAP_THRESHOLD, LARGE_BYTES); /* such a piece is the system's own, and goes back */
    mallopt(M_TRIM_THRESHOLD, FREE_BYTES);
}

/* Its threads do not push aside the one that wakes them: that often has more to send, or is about
 * to wait, and then the broker goes on on the same processor, whose caches have what was sent. */
static void batch_begin(void)
{
    sched_setscheduler(0, SCHED_BATCH, &(struct sched_param){0});
}

int main(int argc, char **argv)
{
    heap_bound();
    batch_begin();
    static struct settings settings;
    int code = settings_read(&settings, argc, argv);
    if (!settings.name) {
        return code;
    }
    mu_log_open("broker", settings.verbose ? MU_LOG_INFO : MU_LOG_WARNING);

    signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is a full disk, no reason to die */
    struct node *p = mu_startup_alloc(sizeof *p);
    p->began_ns = mu_clock_ns();
    const struct mu_network *network = &settings.network;
    code = startup_run(&p->own, &settings);
    code = code == MU_EXIT_DONE ? network_join(p, network) : code;
    if (code != MU_EXIT_DONE) {
        return code;
    }
    mu_signals_note();
    mu_memory_seal();
    doubt_settle(p, network->peers.count == 0 && bus_is_lone_broker(&p->bus, (int)network->domain));
    mu_log(MU_LOG_INFO, "broker-is-up", "name=%s domain=%d index=%d", settings.name,
           (int)network->domain, p->bus.index);
    while (!mu_signal_came && !p->beacon.yields) {
        post_round(p);
    }
    if (!p->beacon.yields) { /* disposed, both Beacons would be gone */
        beacon_close(&p->beacon);
        telemetry_close(&p->health, p->own.broker);
    }
    bus_close(&p->bus);
    if (p->own.disk) {
        disk_close(p->own.disk);
    }
    return p->beacon.yields ? MU_EXIT_DDS : MU_EXIT_DONE;
}
