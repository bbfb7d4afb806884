/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file liaison.h
 * The other brokers, and which agents live beyond which of them.
 *
 * A broker is to another one what a process is: the place "broker.NAME", in which the agents live
 * that it announces.  What every neighbour says of every agent is kept; the best of it is used:
 *
 *   - of two agents with one name the one that has had it longer stays; one that lives here and
 *     has to give way is refused;
 *   - of several ways to the same agent (same name, same since) the shortest is used, and none if
 *     it lives here.
 *
 * When the way in use is lost, another one that is not shorter than it was may lead back to here:
 * such a one is used only after a pause, in which whoever relied on us has heard that we know
 * none.  An agent's own broker is always believed.
 */
#ifndef MUSTER_BROKER_LIAISON_H
#define MUSTER_BROKER_LIAISON_H

#include "broker/names/registry.h"

struct broker;

/* How long another way has to wait that may be an echo of our own. */
enum { LIAISON_PAUSE_MS = 1000 };

/*
 * Where a new process of a name begins to number its mail: each broker has lanes of its own, by its
 * name, so that of two that cannot hear each other neither gives a number that the other gives.
 */
enum { LIAISON_LANE_NUMBERS = 1 << 16, LIAISON_LANES = 1 << 20 };

/* Acknowledgements in one Up to a neighbour. */
enum { LIAISON_ACKS = 1024 };

/* What a neighbour says of an agent. */
struct way {
    bool present, no_broadcasts;
    uint8_t kind, state;
    uint32_t hops; /* brokers between the neighbour and the agent */
    uint32_t slot; /* in the neighbour's announcement */
    uint32_t pid;
    uint64_t since_wall_ns, last_seq;
    char home[MU_NAME_MAX + 1];
    char host[MU_FIELD_MAX + 1];
    uint64_t busy_since_wall_ns;
    char reason[MU_FIELD_MAX + 1];
};

struct peer {
    char name[MU_NAME_MAX + 1];
    char place[MU_PROCESS_MAX + 1];
    bool there; /* it is not silent */
    uint64_t incarnation;
    uint64_t heard_ns; /* when this life of it was heard last */
    /* One for each agent of the registry: */
    struct way *ways;
    uint64_t *taken; /* the last number of its box there that was taken here */
    bool *ack_due;
    uint32_t *acks; /* those with an acknowledgement due */
    uint32_t acks_count;
};

/* An agent without a way, until it may have one that can be an echo. */
struct pause {
    uint32_t agent;
    uint64_t until_ns;
};

struct liaison_counts {
    uint64_t announced, parcels_in, passed_on, repeated, receipts_in, clashes, hops_refused;
};

struct liaison {
    struct peer peers[MU_BROKERS_MAX];
    uint32_t peers_count;
    uint32_t peers_there;
    struct pause *pauses; /* a ring: one for each agent at most */
    uint32_t pauses_head, pauses_count;
    bool *pausing;                                  /* for each agent */
    char holders[MU_BROKERS_MAX][MU_FIELD_MAX + 1]; /* reasons of refusals */
    uint32_t holders_count;
    /* announce.c */
    uint32_t listeners; /* other brokers that are there */
    uint64_t version_said;
    uint64_t beat_ns; /* the next heartbeat */
    bool due[MU_PARTS_MAX];
    uint32_t due_count;
    uint32_t part_open;
    muster_Entry entries[MU_PART_AGENTS];
    /* relay.c */
    uint32_t peer_open;
    muster_Ack *acks_open;
    uint32_t acks_open_count;
    struct liaison_counts count;
};

void liaison_init(struct liaison *l);

/** @return whether a process's name is that of a broker */
bool liaison_is_broker(const char *process);

/** @return the broker's name in such a name of a process */
const char *liaison_name(const char *process);

/** @return the neighbour of that name, or NULL */
struct peer *liaison_peer(struct broker *b, const char *name);

/**
 * A neighbour of this name and life speaks.
 *
 * @return it, entered if it is new; NULL: it is of an earlier life, or there are too many
 */
struct peer *liaison_meet(struct broker *b, const char *name, uint64_t incarnation);

/** Takes a part of what another broker announces. */
void liaison_hear(struct broker *b, const muster_Registration *r);

/** Another broker is silent, or has left: nothing is known of who lives beyond it. */
void liaison_lose(struct broker *b, uint32_t place);

/** Something about the agent has changed: its best way is looked for. */
void liaison_review(struct broker *b, uint32_t agent);

/** @return the reason of a refusal: somebody at that broker holds the name */
const char *liaison_holder(struct broker *b, const char *home);

/** @return the lane of this broker, below LIAISON_LANES */
uint64_t liaison_lane(const struct broker *b);

/** @return the number behind which a new process of that agent begins to number its mail */
uint64_t liaison_begin_seq(const struct broker *b, uint32_t agent);

void liaison_tick(struct broker *b);
uint64_t liaison_deadline_ns(const struct broker *b);

#endif
