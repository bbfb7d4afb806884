/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file remote.h
 * The other brokers, and which agents live beyond which of them.
 */
#ifndef MUSTER_BROKER_REMOTE_H
#define MUSTER_BROKER_REMOTE_H

#include "broker/base/base.h"

struct agent;
struct broker;

/* --- remote.c -------------------------------------------------------------------------------- */

/*
 * The other brokers, and which agents live beyond which of them.
 *
 * A broker is to another one what a process is: a process "broker.NAME", in which the agents live
 * that it announces.  What every neighbour says of every agent is kept; the best of it is used:
 *
 *   - of two agents with one name the one that has had it longer stays; one that lives here and
 *     has to give way is refused;
 *   - of several routes to the same agent (same name, same since) the shortest is used, and none if
 *     it lives here.
 *
 * When the route in use is lost, another one that is not shorter than it was may lead back to here:
 * such a one is used only after a pause, in which the brokers that relied on us have heard that we
 * know none.  An agent's own broker is always believed.
 */

/* How long another route has to wait that may be an echo of our own. */
enum { FEDERATION_PAUSE_MS = 1000 };

/*
 * Where a new process of a name begins to number its mail: each broker has lanes of its own, by its
 * name, so that of two that cannot hear each other neither gives a number that the other gives.
 */
enum { FEDERATION_RANGE_NUMBERS = 1 << 16, FEDERATION_RANGES = 1 << 20 };

/* Acknowledgements in one Up to a neighbour. */
enum { FEDERATION_ACKS = 1024 };

/* Another broker: not heard of, heard of alone (by a Delivery, or before it was lost), or there. */
enum peer_state { PEER_UNKNOWN, PEER_SILENT, PEER_THERE, PEER_STATES };

/* A word of an earlier life is refused.  The other events are of our own making. */
enum peer_event {
    PEER_SPEAKS_EARLIER,
    PEER_OWN_EVENTS,
    PEER_SPEAKS = PEER_OWN_EVENTS, /* in the life that is known */
    PEER_BEGINS,                   /* a later life */
    PEER_ANNOUNCES,
    PEER_LOST,
    PEER_FORGOTTEN,
    PEER_EVENTS
};

/* What a registration says of an agent. */
struct presence {
    muster_Kind kind;
    muster_State state;
    bool no_broadcasts;         /* mail to all passes it by */
    struct box_limits box;      /* that it wants; 0: the broker's own */
    uint32_t hops;              /* brokers between here and */
    char home[MU_NAME_MAX + 1]; /* the broker at which it lives; "": it lives in the process */
    uint64_t since_wall_ns;     /* since when it has its name */
    uint64_t epoch;             /* how often it has set out for another process */
    bool newcomer;              /* no broker has given it the name before */
    uint32_t pid;
    char host[MU_FIELD_MAX + 1];
    uint64_t busy_since_wall_ns;   /* 0: it is not */
    char reason[MU_FIELD_MAX + 1]; /* why it is in this state; "": it does not say */
};

/* What a neighbour says of an agent. */
struct route {
    bool present;
    uint32_t slot; /* in the neighbour's announcement */
    uint64_t last_seq;
    struct presence is; /* the neighbour is one of its hops */
};

/* The box of an agent at another broker. */
struct peer_box {
    uint64_t taken;     /* the last number of it that was taken here */
    struct mu_link ack; /* of those with an acknowledgement due */
};

struct peer {
    char name[MU_NAME_MAX + 1];
    char place[MU_PROCESS_MAX + 1];
    enum peer_state state;
    uint64_t incarnation;
    uint64_t heard_ns; /* when this life of it was heard last */
    /* One for each agent of the registry: */
    struct route routes[REGISTRY_MAX];
    struct peer_box boxes[REGISTRY_MAX];
    /* By their slots in its announcement, one more than the indices of those that are there: */
    uint32_t at_slot[REGISTRY_MAX];
    struct mu_list acks; /* that are due */
};

/* An agent without a route waits until it may have one that can be an echo. */
struct pause {
    uint64_t until_ns;
    struct mu_link link;
};

struct federation_counts {
    uint64_t announced, items_in, passed_on, repeated, receipts_in, clashes, hops_refused;
    uint64_t earlier_lives;
};

struct federation {
    struct peer *peers; /* MU_BROKERS_MAX of them */
    uint32_t peers_count;
    uint32_t peers_there;
    char passed_over[MU_NAME_MAX + 1]; /* the first for which there was no room; "": none */
    struct pause pauses[REGISTRY_MAX];
    struct mu_list pausing;
    /* announce.c */
    uint32_t listeners; /* other brokers that are there */
    uint64_t version_said;
    bool missed;      /* an agent beyond another broker had no place in the white pages */
    uint64_t beat_ns; /* the next heartbeat */
    struct mu_link due[MU_PARTS_MAX];
    struct mu_list parts; /* that are due */
    muster_Entry entries[MU_PART_AGENTS];
    /* relay.c */
    uint32_t peer_open;
    muster_Ack acks_open[FEDERATION_ACKS];
    uint32_t acks_agents[FEDERATION_ACKS];
    uint32_t acks_open_count;
    struct federation_counts count;
};

/** @return the broker's name in the name of a process; NULL: it is none of a broker */
const char *remote_name(const char *process);

/** @return the neighbour of that name, or NULL */
struct peer *remote_peer(struct broker *b, const char *name);

/** @return the lane of this broker, below FEDERATION_RANGES */
uint64_t remote_range(const struct broker *b);

/** @return the number behind which a new process of that agent begins to number its mail */
uint64_t remote_begin_seq(const struct broker *b, uint32_t agent);
uint64_t remote_deadline_ns(const struct broker *b);

struct peer *remote_best_peer(struct broker *b, uint32_t agent);

/** @return whether a route can lead back to here: its neighbour may have it from us */
bool remote_may_be_echo(const struct agent *a, const struct route *route, bool same_neighbour);

void remote_hold_down(struct broker *b, uint32_t agent);

/** @return whether an agent has to wait for a route that can be an echo */
bool remote_pauses(const struct federation *l, uint32_t agent);

/** A silent one makes room. */
struct peer *remote_add_peer(struct broker *b, const char *name);

/** @return false: the event was refused, and counted */
bool remote_peer_on(struct federation *l, struct peer *p, enum peer_event event);

#endif
