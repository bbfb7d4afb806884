/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file broker_net.h
 * Several brokers and their agents in one process: a network that passes samples on, drops them, or
 * is cut between two brokers.  An agent's process here does what the runtime does: it drops numbers
 * that it has had, and mails that may be a repetition and that it has taken before; of multicasts
 * it takes what is for the seat that it knows.
 */
#ifndef MUSTER_TESTS_BROKER_NET_H
#define MUSTER_TESTS_BROKER_NET_H

#include "broker/control/parts.h"
#include "broker/membership/membership.h"
#include "brokers.h"
#include "core/text.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MS 1000000ull

enum { NET_BROKERS = 3, NET_AGENTS = 8, NET_TAKEN = 256 };

struct net_taken {
    char src[MU_NAME_MAX + 1];
    uint64_t seq;
};

struct net_agent {
    char name[MU_NAME_MAX + 1];
    char process[MU_PROCESS_MAX + 1];
    int at; /* its broker; -1: it is not there */
    uint64_t since_wall_ns, incarnation, seq, last_number;
    bool in_order, no_broadcasts, newcomer;
    bool hears;    /* multicasts of its broker */
    bool accepted; /* by it */
    uint32_t seat; /* there; 0: it has heard of none */
    uint64_t serial;
    struct net_taken taken[NET_TAKEN];
    uint32_t taken_count;
    char heard[4096], told[4096], refused[128];
};

static struct net {
    struct broker *b[NET_BROKERS];
    uint64_t incarnation[NET_BROKERS];
    bool link[NET_BROKERS][NET_BROKERS];
    bool deaf[NET_BROKERS];  /* what others acknowledge to it is lost */
    bool twice[NET_BROKERS]; /* what it delivers to others arrives twice */
    bool mute[NET_BROKERS];  /* others do not hear it, and it does not know */
    bool faint[NET_BROKERS]; /* its multicasts are lost */
    uint64_t now_ns;
    struct net_agent agents[NET_AGENTS];
    uint32_t agents_count;
    uint32_t announcements;
    uint32_t repeats; /* mails that agents dropped, having had them */
    uint32_t multicasts;
} net;

static const char *const net_names[NET_BROKERS] = {"a", "b", "c"};

static inline void net_broker_open(int i)
{
    net.incarnation[i] += 1000000; /* far beyond the numbers of a box in a test */
    struct broker_options options = {.name = net_names[i],
                                     .incarnation = net.incarnation[i],
                                     .number_base = net.incarnation[i], /* as with a store */
                                     .pid = 9,
                                     .wall_ns = 1000};
    net.b[i] = broker_kept(&options);
}

static inline int net_index(const char *broker)
{
    for (int i = 0; i < NET_BROKERS; i++) {
        if (strcmp(net_names[i], broker) == 0) {
            return i;
        }
    }
    return -1;
}

/* --- links ------------------------------------------------------------------------------------ */

static inline void net_hear_of(int i, int j, bool there)
{
    char place[MU_PROCESS_MAX + 1];
    uint32_t count = 0;
    snprintf(place, sizeof place, "broker.%s", net_names[j]);
    for (int k = 0; k < NET_BROKERS; k++) {
        count += net.link[i][k];
    }
    broker_peers(net.b[i], count, net.now_ns);
    if (!there) {
        broker_matched(net.b[i], place, false, net.now_ns);
        broker_gone(net.b[i], place, 0, true, net.now_ns);
    }
}

/* Joins two brokers, or cuts them off from each other. */
static inline void net_link(int i, int j, bool there)
{
    net.link[i][j] = net.link[j][i] = there;
    net_hear_of(i, j, there);
    net_hear_of(j, i, there);
    if (there) { /* late joiners hear all that stands */
        announce_all(net.b[i]);
        announce_all(net.b[j]);
    }
}

/* Others lose a broker that hears them still, or hear it again. */
static inline void net_mute(int i, bool mute)
{
    char place[MU_PROCESS_MAX + 1];
    snprintf(place, sizeof place, "broker.%s", net_names[i]);
    net.mute[i] = mute;
    for (int j = 0; mute && j < NET_BROKERS; j++) {
        if (net.link[i][j]) {
            broker_matched(net.b[j], place, false, net.now_ns);
            broker_gone(net.b[j], place, 0, true, net.now_ns);
        }
    }
    if (!mute) {
        announce_all(net.b[i]);
    }
}

/* --- agents ----------------------------------------------------------------------------------- */

static inline struct net_agent *net_agent(const char *name)
{
    for (uint32_t i = 0; i < net.agents_count; i++) {
        if (strcmp(net.agents[i].name, name) == 0) {
            return &net.agents[i];
        }
    }
    CU_FAIL_FATAL("no such agent");
    return NULL;
}

/* What an agent's process says of it, to all brokers that hear it. */
static inline void net_register(struct net_agent *a, muster_State state)
{
    muster_Entry entry = {.reason = words(""),
                          .name = a->name,
                          .kind = muster_KIND_AGENT,
                          .state = state,
                          .no_broadcasts = a->no_broadcasts,
                          .home = words(""),
                          .via = words(""),
                          .host = words(""),
                          .since_wall_ns = a->since_wall_ns,
                          .newcomer = a->newcomer};
    muster_Registration r = {.wire = muster_WIRE,
                             .process = a->process,
                             .broker = words(net_names[a->at]),
                             .incarnation = a->incarnation,
                             .host = words("here"),
                             .pid = 1};
    r.agents._buffer = &entry;
    r.agents._length = r.agents._maximum = 1;
    for (int i = 0; i < NET_BROKERS; i++) {
        if (net.b[i] && (i == a->at || net.link[a->at][i])) {
            broker_registration(net.b[i], &r, net.now_ns);
        }
    }
}

static inline void net_enter(struct net_agent *a, int broker)
{
    a->at = broker;
    a->incarnation++;
    a->in_order = a->hears = a->accepted = false;
    a->last_number = a->serial = a->seat = 0;
    net_register(a, muster_STATE_RUNNING);
    broker_matched(net.b[broker], a->process, true, net.now_ns);
}

/* It reads its broker's multicasts from now on. */
static inline void net_hear(struct net_agent *a)
{
    a->hears = true;
    broker_hears(net.b[a->at], a->process);
}

/* A new agent; of two with one name, tag tells them apart. */
static inline struct net_agent *net_join_as(const char *name, const char *tag, int broker,
                                            uint64_t since_wall_ns)
{
    struct net_agent *a = &net.agents[net.agents_count++];
    *a = (struct net_agent){.since_wall_ns = since_wall_ns, .newcomer = true};
    (void)mu_text_copy(a->name, sizeof a->name, name);
    snprintf(a->process, sizeof a->process, "p-%s%s", name, tag);
    net_enter(a, broker);
    return a;
}

static inline struct net_agent *net_join(const char *name, int broker)
{
    static uint64_t since_wall_ns = 5000;
    return net_join_as(name, "", broker, since_wall_ns++);
}

/* Its broker has not been heard for a lease, and has not heard of it either. */
static inline void net_move(const char *name, int broker)
{
    net_enter(net_agent(name), broker);
}

static inline void net_leave(const char *name)
{
    struct net_agent *a = net_agent(name);
    net_register(a, muster_STATE_ABSENT);
    a->at = -1;
}

static inline void net_up(struct net_agent *a, muster_Mail *mail, uint64_t ack)
{
    struct one_up u;
    one_up(&u, a->name, a->process, mail, mail != NULL, ack);
    u.up.acts._length = mail != NULL;
    u.up.broker_incarnation = net.incarnation[a->at];
    broker_up(net.b[a->at], &u.up, net.now_ns);
}

static inline void net_send(const char *src, const char *dst, const char *content)
{
    struct net_agent *a = net_agent(src);
    muster_Mail m = letter(src, ++a->seq, dst, content);
    net_up(a, &m, 0);
}

/* A question or change that the broker itself answers. */
static inline void net_ask(const char *src, const char *performative, const char *content)
{
    struct net_agent *a = net_agent(src);
    muster_Mail m = letter(src, ++a->seq, "broker", content);
    m.layer = 2;
    m.performative = words(performative);
    net_up(a, &m, 0);
}

/* --- what arrives ----------------------------------------------------------------------------- */

static inline void net_note(char *text, size_t size, const char *line)
{
    size_t len = strlen(text);
    snprintf(text + len, size - len, "%s%s", len ? "; " : "", line);
}

static inline bool net_has_taken(const struct net_agent *a, const muster_Mail *m)
{
    for (uint32_t i = 0; i < a->taken_count; i++) {
        if (a->taken[i].seq == m->seq && strcmp(a->taken[i].src, m->src) == 0) {
            return true;
        }
    }
    return false;
}

static inline void net_parcel(struct net_agent *a, const muster_Parcel *p)
{
    const muster_Mail *m = &p->letter;
    if (p->number <= a->last_number || (a->in_order && p->number != a->last_number + 1)) {
        return;
    }
    a->in_order = true;
    a->last_number = p->number;
    if ((m->again || m->hops > 0) && net_has_taken(a, m)) {
        net.repeats++;
        return;
    }
    struct net_taken *t = &a->taken[a->taken_count++ % NET_TAKEN];
    (void)mu_text_copy(t->src, sizeof t->src, m->src);
    t->seq = m->seq;
    net_note(a->heard, sizeof a->heard, m->content);
}

/* What a broker sends an agent's process is counted. */
static inline void net_count(struct net_agent *a, uint32_t seat, uint64_t serial)
{
    CU_ASSERT_TRUE_FATAL(seat > 0 && (seat != a->seat || serial == a->serial + 1));
    a->seat = seat;
    a->serial = serial;
}

static inline void net_one_of_many(struct net_agent *a, const muster_Delivery *d, uint32_t index)
{
    CU_ASSERT_TRUE_FATAL(a->hears && d->slots._buffer[index] == 0);
    net_count(a, a->seat, d->serials._buffer[index]);
    for (uint32_t i = 0; a->accepted && i < d->letters._length; i++) {
        muster_Parcel p = {.number = d->numbers._buffer[index] + i,
                           .letter = d->letters._buffer[i]};
        net_parcel(a, &p);
    }
}

/* Each process is one agent's here.  Who has moved on, or whose seat is another one by now, does
 * not take it for his. */
static inline void net_to_many(int broker, const muster_Delivery *d)
{
    uint64_t before[NET_AGENTS];
    bool lost = net.faint[broker];
    net.multicasts++;
    for (uint32_t i = 0; i < net.agents_count; i++) {
        struct net_agent *a = &net.agents[i];
        before[i] = a->last_number;
        for (uint32_t k = 0; k < d->seats._length; k++) {
            bool is_its_own = a->at == broker && a->seat == d->seats._buffer[k];
            if (is_its_own && lost) {
                a->serial = d->serials._buffer[k]; /* it has waited for that long enough */
            } else if (is_its_own) {
                net_one_of_many(a, d, k);
            }
        }
    }
    broker_delivered(net.b[broker], net.now_ns);
    for (uint32_t i = 0; i < net.agents_count; i++) {
        struct net_agent *a = &net.agents[i];
        if (a->last_number > before[i]) {
            net_up(a, NULL, a->last_number);
        }
    }
}

static inline void net_to_agent(int broker, const muster_Delivery *d)
{
    char line[160];
    for (uint32_t i = 0; i < net.agents_count; i++) {
        struct net_agent *a = &net.agents[i];
        if (a->at != broker || strcmp(a->process, d->process) != 0) {
            continue;
        }
        uint64_t before = a->last_number;
        net_count(a, d->seat, d->serial);
        for (uint32_t k = 0; k < d->parcels._length; k++) {
            net_parcel(a, &d->parcels._buffer[k]);
        }
        for (uint32_t k = 0; k < d->receipts._length; k++) {
            const muster_Receipt *r = &d->receipts._buffer[k];
            snprintf(line, sizeof line, "%llu-%llu %s", (unsigned long long)r->first_seq,
                     (unsigned long long)r->last_seq, outcome_word(r->result));
            net_note(a->told, sizeof a->told, line);
        }
        for (uint32_t k = 0; k < d->verdicts._length; k++) {
            a->accepted = d->verdicts._buffer[k].accepted;
            a->newcomer = a->newcomer && !a->accepted;
            a->seq = a->seq ? a->seq : d->verdicts._buffer[k].last_seq;
            if (!a->accepted) {
                (void)mu_text_copy(a->refused, sizeof a->refused, d->verdicts._buffer[k].reason);
            }
        }
        broker_delivered(net.b[broker], net.now_ns);
        net_up(a, NULL, a->last_number > before ? a->last_number : 0);
        return;
    }
    broker_delivered(net.b[broker], net.now_ns);
}

static inline bool net_announce(int i)
{
    muster_Registration r;
    bool any = false;
    while (broker_announcement(net.b[i], &r)) {
        any = true;
        net.announcements++;
        for (int j = 0; j < NET_BROKERS; j++) {
            if (net.link[i][j] && !net.mute[i]) {
                broker_registration(net.b[j], &r, net.now_ns);
            }
        }
        broker_announced(net.b[i]);
    }
    return any;
}

static inline bool net_acknowledge(int i)
{
    const char *peer;
    muster_Up up;
    bool any = false;
    while (broker_up_next(net.b[i], &peer, &up)) {
        any = true;
        int j = net_index(peer);
        if (net.link[i][j] && !net.deaf[j] && !net.mute[i]) {
            broker_up(net.b[j], &up, net.now_ns);
        }
        broker_up_sent(net.b[i]);
    }
    return any;
}

static inline bool net_deliver(int i)
{
    const char *process;
    muster_Delivery d;
    bool any = false;
    while (broker_next(net.b[i], &process, &d)) {
        any = true;
        if (strcmp(process, BUS_TO_ALL) == 0) {
            net_to_many(i, &d);
            continue;
        }
        int j = strncmp(process, "broker.", 7) == 0 ? net_index(process + 7) : -1;
        if (j < 0) {
            net_to_agent(i, &d);
            continue;
        }
        bool arrives = net.link[i][j] && !net.mute[i];
        for (int k = 0; arrives && k < (net.twice[i] ? 2 : 1); k++) {
            broker_delivery(net.b[j], &d, net.now_ns);
        }
        broker_delivered(net.b[i], net.now_ns);
    }
    return any;
}

/* Readers and writers of brokers that are joined find each other. */
static inline void net_match(int i)
{
    char place[MU_PROCESS_MAX + 1];
    for (int j = 0; j < NET_BROKERS; j++) {
        snprintf(place, sizeof place, "broker.%s", net_names[j]);
        uint32_t at = processes_find(&net.b[i]->processes, place);
        if (at != MU_NONE && net.link[i][j] && !net.mute[j] &&
            !processes_is_matched(&net.b[i]->processes.at[at])) {
            broker_matched(net.b[i], place, true, net.now_ns);
        }
    }
}

/* Lets everything happen that needs no time. */
static inline void net_settle(void)
{
    bool any = true;
    for (int round = 0; any; round++) {
        CU_ASSERT_TRUE_FATAL(round < 1000);
        any = false;
        for (int i = 0; i < NET_BROKERS; i++) {
            net_match(i);
            any = net_announce(i) || any;
            any = net_acknowledge(i) || any;
            any = net_deliver(i) || any;
        }
    }
}

static inline void net_tick(uint64_t later_ns)
{
    net.now_ns += later_ns;
    for (int i = 0; i < NET_BROKERS; i++) {
        broker_tick(net.b[i], net.now_ns);
    }
    net_settle();
}

static inline void net_begin(void)
{
    uint64_t incarnation = net.incarnation[0];
    memset(&net, 0, sizeof net);
    for (int i = 0; i < NET_BROKERS; i++) {
        net.incarnation[i] = incarnation;
        net_broker_open(i);
    }
}

/* @return "BROKER STATE" of an agent as a broker sees it, or "nobody" */
static inline const char *net_lives(int broker, const char *name)
{
    static char line[80];
    muster_Member m;
    if (!broker_knows(net.b[broker], name, &m)) {
        return "nobody";
    }
    snprintf(line, sizeof line, "%s %s", m.broker, state_word(m.state));
    return line;
}

#define LIVES(broker, name, wanted) CU_ASSERT_STRING_EQUAL(net_lives(broker, name), wanted)

/* What is in a text is exactly this, and it is read. */
#define READ(text, wanted)   \
    do {                     \
        READS(text, wanted); \
        (text)[0] = '\0';    \
    } while (0)
#define HEARD(name, wanted) READ(net_agent(name)->heard, wanted)
#define TOLD(name, wanted)  READ(net_agent(name)->told, wanted)

#endif
