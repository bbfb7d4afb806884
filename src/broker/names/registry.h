/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file registry.h
 * The white pages: every name that was ever registered, who bears it, and where it lives.
 *
 * An agent keeps its index for ever; the other parts of the broker use it to find what is theirs.
 */
#ifndef MUSTER_BROKER_REGISTRY_H
#define MUSTER_BROKER_REGISTRY_H

#include "broker/base/changes.h"
#include "core/table.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

/** The broker itself stands first in the white pages, its parts after it (counters.h). */
enum {
    REGISTRY_BROKER = 0,
    REGISTRY_OWN = MU_BROKER_LINES,
    REGISTRY_MAX = MU_AGENTS_MAX + REGISTRY_OWN
};

/* Lines of the white pages that are published together. */
enum { REGISTRY_PAGE = 64, REGISTRY_PAGES = (REGISTRY_MAX + REGISTRY_PAGE - 1) / REGISTRY_PAGE };

/* What a registration says of an agent. */
struct presence {
    muster_Kind kind;
    muster_State state;
    bool no_broadcasts;         /* mail to all passes it by */
    muster_BoxPolicy full;      /* of its box, */
    uint32_t box_mails;         /* which holds so many mails, */
    uint64_t box_bytes;         /* of so many bytes; 0: the broker's own limit */
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

/* Queues of a place, for agents that may have something to be told: until they are served, and
 * until somebody has looked at how urgent it is. */
enum tenant_queue { TENANT_READY, TENANT_STIRRED, TENANT_QUEUES };

struct tenant_link {
    uint32_t next, prev;
    bool queued;
};

/* An agent in a place: see tenants.h. */
struct tenant {
    uint32_t place, slot;
    uint32_t next, prev; /* of the same part */
    struct tenant_link links[TENANT_QUEUES];
};

struct agent {
    char name[MU_NAME_MAX + 1];
    char place[MU_PROCESS_MAX + 1]; /* its process, or the last one that it had */
    uint32_t process;               /* MU_NONE when absent */
    uint32_t left;                  /* the seat that a lock step took it from, or MU_NONE */
    uint64_t left_wall_ns;          /* since when who left that had its name */
    uint32_t claim;                 /* the first one on its name: see claims.h; MU_NONE: nobody's */
    struct tenant tenant;           /* while it has a process */
    struct presence is;
    uint64_t since_wall_ns;
    uint64_t seen_seq;      /* the last mail that it has sent in this life of the broker */
    uint64_t came_seq;      /* the last one that has come in this life, taken or not */
    uint64_t durable_seq;   /* the last one that went to the store, in any life */
    uint64_t failed_seq;    /* the last one that was not delivered, in any life */
    uint64_t durable_order; /* of its last mail that is to go to the store, in this life */
    uint64_t earlier_seq;   /* no mail of an earlier life of the broker has a higher one */
    uint64_t reserved_seq;  /* on disk: later lives count from here */
    uint64_t elsewhere_seq; /* no mail that other brokers have had of it has a higher one */
    uint64_t mark;          /* the last list of receivers that it was put on */
    uint64_t kept_until_ns; /* so long newcomers wait for its last bearer: see presence_keep */
    uint64_t seated_above;  /* the last number of its box before the last verdict */
    uint64_t step_version;  /* of its line when a step ended, if more was said of it since */
    bool verdict_due;
    bool seated;     /* it has acknowledged a later one */
    bool let_go;     /* a lock step waits for it to come back in another process */
    bool handed;     /* the broker has given it to its process, which has not said since when it is
                        there */
    bool gone;       /* its process went in lock step: counts when that ends */
    bool ended;      /* it was disposed of in lock step, whose members are to know */
    bool passed;     /* a lock step has taken the name from a process since it began */
    bool unsaved;    /* the journal has to write its line */
    bool ram_behind; /* it has sent mail in RAM behind durable_order */
    bool awaited; /* it went without a word, or an earlier life of the broker knew it: its receipts
                     are kept */
    muster_Kind saved_kind;
};

struct registry {
    struct agent *agents; /* REGISTRY_MAX of them */
    uint32_t count;
    uint32_t present; /* agents that are there, the broker and its parts not counted */
    uint32_t *order;  /* indices in order of name */
    struct changes changes;
    bool pages_due[REGISTRY_PAGES]; /* something in them has changed */
    uint32_t news[REGISTRY_PAGES];  /* a ring: these pages */
    uint32_t news_head;
    uint32_t news_count;
    uint64_t mark;
    struct mu_table names;
};

void registry_init(struct registry *r);

/** @return the index of a name, or MU_NONE */
uint32_t registry_find(const struct registry *r, const char *name);

/** @return whether it is the broker or one of its parts */
bool registry_is_own(uint32_t agent);

/** @return why nobody may register that name as that kind, or NULL */
const char *registry_objection(const char *name, muster_Kind kind);

/** Enters a new name, absent until registry_seat.  @return its index, or MU_NONE when full */
uint32_t registry_add(struct registry *r, const char *name);

/** A line of the white pages is news to everybody again. */
void registry_touch(struct registry *r, uint32_t agent);

/** The agent is now in this process. */
void registry_seat(struct registry *r, uint32_t agent, uint32_t process, const char *place,
                   const struct presence *presence, uint64_t wall_ns);

/** The agent has left its process. */
void registry_unseat(struct registry *r, uint32_t agent, uint64_t wall_ns);

/** Takes in what a registration says of a seated agent.  @return whether anything changed */
bool registry_update(struct registry *r, uint32_t agent, const struct presence *presence,
                     uint64_t wall_ns);

/** @return whether the state changed */
bool registry_set_state(struct registry *r, uint32_t agent, muster_State state, uint64_t wall_ns);

/** @return the number that a new process of that name goes on after */
uint64_t registry_last_seq(const struct agent *a);

/** @return the next page in which a line has changed since it was last given here, or MU_NONE */
uint32_t registry_next_page(struct registry *r);

/** A page is to be given again. */
void registry_mark_page(struct registry *r, uint32_t page);

/** Fills a line with pointers into the registry. */
void registry_line(const struct registry *r, uint32_t agent, const char *broker,
                   muster_Member *out);

/** Words that people and rules see; NULL when out of range. */
const char *registry_kind_word(muster_Kind kind);
const char *registry_state_word(muster_State state);

#endif
