/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file processes.h
 * Processes as the broker sees them, and the agents that live in each.
 */
#ifndef MUSTER_BROKER_PROCESSES_H
#define MUSTER_BROKER_PROCESSES_H

#include "broker/base/base.h"

struct broker;

/* --- processes.c ----------------------------------------------------------------------------- */

/* The processes that agents live in, and which of them have something to be told. */

enum {
    PROCESSES_PARTS = MU_PARTS_MAX,
    PROCESSES_REFUSALS = 64,          /* that wait for one Delivery */
    PROCESSES_ALL = MU_PROCESSES_MAX, /* no process */
};

_Static_assert(MU_LOCAL_AGENTS_MAX % MU_PART_AGENTS == 0, "a process has whole parts");

/* A registration that was turned down. */
struct refusal {
    char name[MU_PROCESS_MAX + 1]; /* as it came, perhaps no valid name at all; cut if long */
    muster_Refusal code;
    char reason[2 * MU_FIELD_MAX];
};

/* Queues of a process, for agents that may have something to be told: until they are served, and
 * until it was looked at how urgent it is. */
enum resident_queue { RESIDENT_READY, RESIDENT_STIRRED, RESIDENT_QUEUES };

/* An agent in a process. */
struct resident {
    uint32_t slot;
    struct mu_link part; /* of the same part */
    struct mu_link links[RESIDENT_QUEUES];
};

/* What of a process is there: its reader (AWAY; THERE; HEARS, if it reads multicasts, too), and its
 * writer (_SILENT: its liveliness has ended since it was heard last). */
enum session {
    SESSION_FREE, /* no process has the place */
    SESSION_AWAY,
    SESSION_THERE,
    SESSION_HEARS,
    SESSION_AWAY_SILENT,
    SESSION_THERE_SILENT,
    SESSION_HEARS_SILENT,
    SESSIONS
};

enum session_event {
    SESSION_ENTERS,
    SESSION_MATCHED,
    SESSION_UNMATCHED,
    SESSION_READS_MULTICASTS,
    SESSION_HEARD,
    SESSION_SILENT,
    SESSION_FORGOTTEN,
    SESSION_EVENTS
};

/* Its turn to be served, whether it is in the queue of those to look at or not: HELD, ordinary mail
 * waits for the dispatcher's next round; REFUSED, the network has refused its Delivery, which waits
 * for the next try. */
enum turn_state { TURN_IDLE, TURN_HELD, TURN_REFUSED, TURNS };

enum turn_event {
    TURN_IS_HELD,
    TURN_ROUND_BEGINS,
    TURN_IS_REFUSED,
    TURN_IS_RETRIED,
    TURN_IS_FORGOTTEN,
    TURN_EVENTS
};

/* ONLOOKERS: its agents have no bodies, and the special ones look on; BROKER: its agents live
 * beyond that broker. */
enum process_kind { PROCESS_PLAIN, PROCESS_ONLOOKERS, PROCESS_BROKER };

struct process {
    char name[MU_PROCESS_MAX + 1];
    uint8_t scope; /* enum scope: see steps.h */
    enum session session;
    enum turn_state turn;
    enum process_kind kind;
    bool roll_call_due;    /* it is to say all its parts again */
    bool speaks;           /* its registration is just being taken in */
    bool overruled;        /* a run has passed over a name that it asked for */
    uint64_t incarnation;  /* of the process */
    uint32_t mails_had;    /* in its last Delivery; when they are many, see pacing.c: */
    uint32_t flooded_from; /* the process that the last of those mails came from, or MU_NONE */
    uint64_t flooded_until_ns;
    uint64_t flood_wake_ns;         /* when it is woken, if it is held for that */
    struct mu_link queued, flooded; /* in the queue of those to look at, and of those held */
    uint32_t seat;                  /* its number; no other place ever had it */
    uint64_t serial;                /* of the last Delivery to it */
    uint64_t version_had;           /* of the white pages */
    uint64_t groups_had;
    uint64_t services_had;
    uint32_t claims; /* names that it waits for */
    uint32_t agents_count;
    uint32_t parts_top;                    /* parts ever used */
    struct mu_list parts[PROCESSES_PARTS]; /* its agents: see below */
    struct mu_list queues[RESIDENT_QUEUES];
    uint32_t refusals_count;
    struct refusal refusals[PROCESSES_REFUSALS];
};

struct processes {
    struct process at[MU_PROCESSES_MAX];
    uint32_t top;           /* entries ever used */
    uint32_t seats;         /* given out */
    uint32_t hearers;       /* those that read multicasts */
    uint32_t held, refused; /* those whose turn is so */
    bool all_awake;         /* since something happened to all, none has been looked at */
    struct mu_list queue;   /* of those to look at */
    struct mu_table names;
};

/** @return the index of a process, or MU_NONE */
static inline uint32_t processes_find(const struct processes *p, const char *name)
{
    return mu_table_find(&p->names, name);
}

/** Finds a process or enters it.  @return its index, or MU_NONE when full */
uint32_t processes_get(struct processes *p, const char *name);

/** Forgets a process, unless it is needed. */
void processes_tidy(struct processes *p, uint32_t place);

/** Something happens to the reader or the writer of a process; our own code aborts if it cannot. */
void processes_session_on(struct processes *p, uint32_t place, enum session_event event);

/** Notes a refused registration; when there are too many, the process will ask again. */
void processes_refuse(struct processes *p, uint32_t place, const char *name, muster_Refusal code,
                      const char *reason);

/** The name is the process's after all: what it has not heard yet, it need not hear. */
void processes_accept(struct processes *p, uint32_t place, const char *name);

/** Puts a process into the queue of those that may have something to be told. */
void processes_wake(struct processes *p, uint32_t place);

/** Has a process say all its parts again. */
void processes_call_roll(struct processes *p, uint32_t place);

/** Takes the first one out of the queue.  @return MU_NONE when it is empty */
uint32_t processes_next(struct processes *p);

/** Something happens to the turn of a process; our own code aborts if it cannot. */
void processes_turn_on(struct processes *p, uint32_t place, enum turn_event event);

static inline bool processes_is_matched(const struct process *at)
{
    return at->session == SESSION_THERE || at->session == SESSION_HEARS ||
           at->session == SESSION_THERE_SILENT || at->session == SESSION_HEARS_SILENT;
}

static inline bool processes_hears(const struct process *at)
{
    return at->session == SESSION_HEARS || at->session == SESSION_HEARS_SILENT;
}

static inline bool processes_is_silent(const struct process *at)
{
    return at->session >= SESSION_AWAY_SILENT;
}

/* Which agents live in a process, part by part, and which of them may have something to be told. */

/** An agent, which lives nowhere, moves into a slot of a process. */
void processes_add_agent(struct broker *b, uint32_t place, uint32_t slot, uint32_t agent);

/** An agent leaves its process. */
void processes_remove_agent(struct broker *b, uint32_t agent);

/** @return the first agent of a process, or MU_NONE */
uint32_t processes_first_agent(const struct broker *b, uint32_t place);

/** @return the next agent of the same process, or of the same part, or MU_NONE */
uint32_t processes_next_agent(const struct broker *b, uint32_t agent);
uint32_t processes_next_agent_of(const struct broker *b, uint32_t agent);

/** Goes through the agents of a process; none may leave it meanwhile. */
#define PROCESSES_EACH_AGENT(b, agent, place)                                  \
    for (uint32_t agent = processes_first_agent(b, place); (agent) != MU_NONE; \
         (agent) = processes_next_agent(b, agent))

/** The agent may have something to be told, and its process with it; without a process, nothing. */
void processes_wake_agent(struct broker *b, uint32_t agent);

/**
 * @return an agent of the process that was woken since it was last served or calmed, or
 * MU_NONE: so no waiting agent has to be looked at twice
 */
static inline uint32_t processes_stirred_agent(const struct processes *p, uint32_t place)
{
    return mu_list_first(&p->at[place].queues[RESIDENT_STIRRED]);
}

/** What the agent has to be told can wait, until it is woken again. */
void processes_calm_agent(struct broker *b, uint32_t agent);

/** @return whether an agent waits in a process's queue */
static inline bool processes_agent_waits(const struct processes *p, uint32_t place)
{
    return p->at[place].queues[RESIDENT_READY].count > 0;
}

/** Takes out the agent that waits longest; there must be one. */
uint32_t processes_pop_agent(struct broker *b, uint32_t place);

#endif
