/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/link.h"

#include "core/clock.h"
#include "core/name.h"
#include "core/text.h"
#include "muster/version.h"
#include "runtime/process.h"

#include <stdio.h>
#include <string.h>

/* A process listens so long before it chooses, unless it hears of the best broker there can be. */
static const uint64_t SETTLE_NS = 100000000;

/* A broker that has not answered for so long is asked again.  More than it waits for a name that
 * another process holds. */
static const uint64_t ANSWER_NS = 2000000000;

/* A process that has not looked for so long has missed heartbeats: it listens for one more before
 * it takes its broker for silent. */
static const uint64_t ABSENCE_NS = 500000000;
static const uint64_t HEARTBEAT_NS = 400000000;

mu_result link_open(mu_process *p, const char *wanted)
{
    if (wanted && !mu_name_valid(wanted)) {
        fprintf(stderr, "'%s' cannot be a broker's name\n", wanted);
        return MU_FAULT_USAGE;
    }
    mu_text_copy(p->link.wanted, sizeof p->link.wanted, wanted ? wanted : "");
    return bus_reader_open(&p->bus, BUS_BEACON, NULL, &p->link.beacons);
}

static void beacons_take(struct link *l)
{
    enum bus_life life;
    const muster_Beacon *beacon;
    char who[128];
    while (bus_reader_meets(&l->beacons, who, sizeof who)) {
        fprintf(stderr,
                "a broker of another version is passed over (%s); this program is of muster "
                "%s: use programs of one version\n",
                who, MU_VERSION);
    }
    while ((beacon = bus_next(&l->beacons, &life))) {
        if (life == BUS_DATA) {
            bool is_ours = beacon->incarnation == l->incarnation;
            l->lives_ns = is_ours ? mu_clock_ns() : l->lives_ns;
            (void)beacons_note(&l->known, beacon);
        } else {
            (void)beacons_lose(&l->known, beacon->broker);
        }
    }
}

/* Higher than before, even when the clock on the wall is set back. */
static uint64_t incarnation_next(const mu_process *p)
{
    uint64_t wall_ns = mu_clock_wall_ns();
    return wall_ns > p->incarnation ? wall_ns : p->incarnation + 1;
}

/* Last words that did not go out were for the earlier broker: agents that are leaving have left. */
void link_register(mu_process *p)
{
    if (p->steps == PROCESS_READY) {
        (void)process_step_on(p, STEP_UNMATCHED);
    }
    p->leaving = 0;
    p->leaving_ns = 0;
    p->heartbeat_ns = p->now_ns;
    for (uint32_t i = 0; i < p->agent_count; i++) {
        struct mu_agent *a = &p->agents[i];
        (void)life_name_on(a, NAME_ANEW);
        if (life_is_leaving(a)) {
            life_exit_on(a, EXIT_SAID_ALL);
        }
        queue_remove(a, QUEUE_SEND);
        queue_remove(a, QUEUE_ACK); /* the new broker counts from 1 */
    }
    ack_delay_clear(&p->ack_delay, p->now_ns);
    roll_mark_all(p);
}

/* Registers all agents.  A later life of the same broker answers by itself: it hears of them for
 * the first time.  Another broker may know them from before, and not have missed them: a higher
 * incarnation makes it answer, but it forgets the news that it had for them. */
static void agents_say(mu_process *p, bool anew, uint64_t now_ns)
{
    p->incarnation = anew ? incarnation_next(p) : p->incarnation;
    p->link.asked_ns = now_ns;
    link_register(p);
}

/* Goes to a broker: another one, or another life of the same.  An Up that has not gone out is put
 * together anew: its acknowledgements are for boxes of the earlier broker. */
static mu_result broker_enter(mu_process *p, const char *name, uint64_t incarnation)
{
    struct link *l = &p->link;
    bool is_other = strcmp(l->broker, name) != 0;
    process_up_on(p, UP_DROPPED);
    if (is_other) {
        bus_writer_close(&p->up);
        mu_text_copy(l->broker, sizeof l->broker, name);
        snprintf(l->partition, sizeof l->partition, "broker.%s", l->broker);
        MU_TRY(bus_writer_open(&p->bus, BUS_UP, l->partition,
                               process_takes_steps(p) ? "simulator" : NULL, &p->up));
    }
    l->incarnation = incarnation;
    l->silent = false;
    probes_review(p);
    /* A life that has answered already, and seemed to be another, would not answer again either. */
    agents_say(p, is_other || p->broker_incarnation == incarnation, mu_clock_ns());
    return MU_OK;
}

bool link_is_ours(mu_process *p, const muster_Delivery *d)
{
    struct link *l = &p->link;
    if (d->broker_incarnation == l->incarnation) {
        l->lives_ns = p->leaving > 0 ? mu_clock_ns() : l->lives_ns;
        return true;
    }
    if (process_in_lockstep(p) || d->broker_incarnation < l->incarnation ||
        strcmp(d->broker, l->broker) != 0) {
        return false;
    }
    choice_follow(&l->known, l->broker, d->broker_incarnation);
    return broker_enter(p, d->broker, d->broker_incarnation) == MU_OK;
}

/* The broker is there: if it has missed us, our next heartbeat tells it. */
static mu_result broker_keep(mu_process *p, const struct beacons_broker *now, uint64_t now_ns,
                             bool *turned)
{
    struct link *l = &p->link;
    l->silent = false;
    if (now->incarnation != l->incarnation) {
        *turned = true;
        return broker_enter(p, now->name, now->incarnation);
    }
    bool answered = p->broker_incarnation == l->incarnation || p->agent_count == 0;
    if (!answered && now_ns - l->asked_ns > ANSWER_NS) {
        agents_say(p, true, now_ns);
    }
    return MU_OK;
}

/* @return whether it is too early to choose, as a better broker may be heard of */
static bool must_wait(struct link *l, const struct beacons_broker *best, const char *host,
                      uint64_t now_ns)
{
    l->heard_ns = l->heard_ns ? l->heard_ns : now_ns;
    bool is_first = l->broker[0] == '\0';
    const char *wanted = l->wanted[0] ? l->wanted : NULL;
    return is_first && !choice_is_final(best, host, wanted) && now_ns - l->heard_ns < SETTLE_NS;
}

mu_result link_look(mu_process *p, bool *turned)
{
    struct link *l = &p->link;
    *turned = false;
    uint64_t now_ns = p->now_ns;
    if (l->looked_ns && now_ns - l->looked_ns > ABSENCE_NS) {
        l->patient_until_ns = now_ns + HEARTBEAT_NS;
    }
    l->looked_ns = now_ns;
    beacons_take(l);
    if (process_in_lockstep(p)) {
        return MU_OK; /* a run that has lost its broker ends */
    }
    const struct beacons_broker *now = beacons_find(&l->known, l->broker);
    if (now && now->there) {
        return broker_keep(p, now, now_ns, turned);
    }
    if (now_ns < l->patient_until_ns) {
        return MU_OK;
    }
    bool is_first = l->broker[0] == '\0';
    l->silent = !is_first;
    const struct beacons_broker *best =
        choice_best(&l->known, p->host, is_first && l->wanted[0] ? l->wanted : NULL);
    if (!best || must_wait(l, best, p->host, now_ns)) {
        return MU_OK;
    }
    *turned = true;
    return broker_enter(p, best->name, best->incarnation);
}

bool mu_process_has_broker(const mu_process *p)
{
    return p->link.broker[0] && !p->link.silent && bus_reader_matches(&p->delivery) > 0;
}

const char *mu_process_broker(const mu_process *p)
{
    bool answered = p->broker_incarnation != 0 && p->broker_incarnation == p->link.incarnation;
    return answered && !p->link.silent ? p->link.broker : NULL;
}
