/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file places.h
 * The processes that agents live in, and which of them have something to be told.
 */
#ifndef MUSTER_BROKER_PLACES_H
#define MUSTER_BROKER_PLACES_H

#include "broker/names/registry.h"

enum {
    PLACES_PARTS = MU_PARTS_MAX,
    PLACES_REFUSALS = 64,          /* that wait for one Delivery */
    PLACES_ALL = MU_PROCESSES_MAX, /* no place */
};

_Static_assert(MU_LOCAL_AGENTS_MAX % MU_PART_AGENTS == 0, "a process has whole parts");

/* A registration that was turned down. */
struct refusal {
    char name[MU_PROCESS_MAX + 1]; /* as it came, perhaps no valid name at all; cut if long */
    muster_Refusal code;
    const char *reason;
};

/* Agents of a place: see tenants.h. */
struct tenant_ends {
    uint32_t first, last;
};

struct place {
    char name[MU_PROCESS_MAX + 1];
    bool used;
    bool matched;
    bool rostered;         /* a lock step waits for it */
    bool watches;          /* its agents have no bodies: the special ones look on */
    bool simulator;        /* of the lock step */
    bool answered;         /* its Up of the current step is in */
    bool step_due;         /* the Delivery of the last step has not gone out to it */
    bool queued;           /* in the queue of those to look at */
    bool held;             /* waits for the courier to wake */
    bool blocked;          /* the network refused it; waits for the next try */
    bool lost;             /* nobody has written for it since its liveliness ended */
    bool roll_call_due;    /* it is to say all its parts again */
    bool speaks;           /* its registration is just being taken in */
    bool flooded;          /* its last Delivery had many mails: see floods.h */
    bool flood_queued;     /* among the places that are held for that */
    bool hears;            /* circulars */
    bool overruled;        /* a lock step has passed over a name that it asked for */
    bool is_broker;        /* a broker, and its agents live beyond it */
    uint64_t incarnation;  /* of the process */
    uint32_t flooded_from; /* the place that the last of those mails came from, or MU_NONE */
    uint64_t flooded_until_ns;
    uint64_t flood_wake_ns; /* when it is woken, if it is among those */
    uint32_t seat;          /* its number; no other place ever had it */
    uint64_t serial;        /* of the last Delivery to it */
    int64_t step_had;       /* the step of the last Delivery of this lock step */
    uint64_t version_had;   /* of the white pages */
    uint64_t groups_had;
    uint64_t services_had;
    uint32_t claims; /* names that it waits for */
    uint32_t agents_count;
    uint32_t parts_top;           /* parts ever used */
    uint32_t parts[PLACES_PARTS]; /* the first agent of each: see tenants.h */
    struct tenant_ends queues[TENANT_QUEUES];
    uint32_t refusals_count;
    uint32_t unmatched_at; /* where it stands among the unmatched, if it has not matched */
    struct refusal refusals[PLACES_REFUSALS];
};

struct places {
    struct place *at; /* MU_PROCESSES_MAX of them */
    uint32_t top;     /* entries ever used */
    uint32_t seats;   /* given out */
    uint32_t used_count;
    uint32_t *unmatched; /* indices of those in use that have not matched */
    uint32_t unmatched_count;
    uint32_t blocked;
    bool all_awake;  /* since something happened to all, none has been looked at */
    uint32_t *queue; /* a ring of MU_PROCESSES_MAX */
    uint32_t queue_head;
    uint32_t queue_count;
    struct mu_table names;
};

void places_init(struct places *p);

/** @return whether a process may have that name, which is a DDS partition, too */
bool places_name_valid(const char *name);

/** @return the index of a process, or MU_NONE */
uint32_t places_find(const struct places *p, const char *name);

/** Finds a process or enters it.  @return its index, or MU_NONE when full */
uint32_t places_get(struct places *p, const char *name);

/** Forgets a process, unless somebody needs it. */
void places_tidy(struct places *p, uint32_t place);

void places_set_matched(struct places *p, uint32_t place, bool matched);

/** Notes a refused registration; when there are too many, the process will ask again. */
void places_refuse(struct places *p, uint32_t place, const char *name, muster_Refusal code,
                   const char *reason);

/** The name is the process's after all: what it has not heard yet, it need not hear. */
void places_accept(struct places *p, uint32_t place, const char *name);

/** Puts a process into the queue of those that may have something to be told. */
void places_wake(struct places *p, uint32_t place);

/** Takes the first one out of the queue.  @return MU_NONE when it is empty */
uint32_t places_next(struct places *p);

/** The network refused it (true), or may be tried again (false). */
void places_set_blocked(struct places *p, uint32_t place, bool blocked);

#endif
