/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/link.h"

#include "core/clock.h"
#include "core/name.h"
#include "core/text.h"
#include "runtime/process.h"

#include <stdio.h>
#include <string.h>

/* So long a process listens before it chooses, unless it hears of the best there can be. */
static const uint64_t SETTLE_NS = 100000000;

/* Who was not here for so long has missed heartbeats and listens for one more before it believes in
 * a silence. */
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
    while ((beacon = bus_next(&l->beacons, &life))) {
        if (life == BUS_DATA) {
            choice_note(&l->choice, beacon);
        } else {
            choice_lose(&l->choice, beacon->broker);
        }
    }
}

/* Goes to a broker: another one, or another life of the same.  A higher incarnation of the agents
 * makes it answer, even if it knows them from before and has never missed them. */
static mu_result broker_enter(mu_process *p, const struct choice_broker *to)
{
    struct link *l = &p->link;
    bool is_other = strcmp(l->broker, to->name) != 0;
    if (is_other) {
        bus_writer_close(&p->up);
        p->out_pending = false;
        mu_text_copy(l->broker, sizeof l->broker, to->name);
        snprintf(l->partition, sizeof l->partition, "broker.%s", to->name);
        MU_TRY(bus_writer_open(&p->bus, BUS_UP, l->partition, p->with_body ? "simulator" : NULL,
                               &p->up));
    }
    if (l->incarnation != to->incarnation) {
        p->mail = NULL;
    }
    l->incarnation = to->incarnation;
    l->silent = false;
    process_register(p);
    return MU_OK;
}

/* @return whether it is too early to choose, as a better broker may be heard of */
static bool must_wait(struct link *l, const struct choice_broker *best, const char *host,
                      uint64_t now_ns)
{
    l->heard_ns = l->heard_ns ? l->heard_ns : now_ns;
    bool is_first = l->broker[0] == '\0';
    const char *wanted = l->wanted[0] ? l->wanted : NULL;
    return is_first && !choice_is_final(best, host, wanted) && now_ns - l->heard_ns < SETTLE_NS;
}

mu_result link_look(mu_process *p)
{
    struct link *l = &p->link;
    uint64_t now_ns = mu_clock_ns();
    if (l->looked_ns && now_ns - l->looked_ns > ABSENCE_NS) {
        l->patient_until_ns = now_ns + HEARTBEAT_NS;
    }
    l->looked_ns = now_ns;
    beacons_take(l);
    if (p->in_lockstep) {
        return MU_OK; /* a run that has lost its broker ends */
    }
    const struct choice_broker *now = choice_find(&l->choice, l->broker);
    if (now && now->there) {
        l->silent = false; /* if it has missed us, our next heartbeat tells it */
        return now->incarnation != l->incarnation ? broker_enter(p, now) : MU_OK;
    }
    if (now_ns < l->patient_until_ns) {
        return MU_OK;
    }
    bool is_first = l->broker[0] == '\0';
    l->silent = !is_first;
    const struct choice_broker *best =
        choice_best(&l->choice, p->host, is_first && l->wanted[0] ? l->wanted : NULL);
    return best && !must_wait(l, best, p->host, now_ns) ? broker_enter(p, best) : MU_OK;
}
