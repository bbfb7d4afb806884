/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file names.h
 * The bearers of names, in which process, and beyond which other broker.
 */
#ifndef MUSTER_BROKER_NAMES_H
#define MUSTER_BROKER_NAMES_H

#include "broker/names/processes.h"
#include "broker/names/remote.h"

/* --- graveyard.c ----------------------------------------------------------------------------- */

/*
 * The numbers of names that have ended, and may come back: by them mail that was sent before is
 * known to be a duplicate, and new mail is not taken for one.
 *
 * It holds the GRAVES_MAX names that have ended last.  A name that is not among them begins as one
 * that no agent has had.
 */
enum { GRAVES_MAX = 65536 };

/* Numbers of an agent's mail. */
struct mail_numbers {
    uint64_t seen;      /* the last that it has sent in this life of the broker */
    uint64_t came;      /* the last that has come in this life, taken or not */
    uint64_t durable;   /* the last that went to the store, in any life */
    uint64_t failed;    /* the last that was not delivered, in any life */
    uint64_t earlier;   /* no mail of an earlier life of the broker has a higher one */
    uint64_t reserved;  /* on disk: later lives count from here */
    uint64_t elsewhere; /* no mail that other brokers have had of it has a higher one */
};

struct grave {
    char name[MU_NAME_MAX + 1]; /* "": none */
    muster_Kind saved_kind;     /* as that of struct agent */
    struct mail_numbers seq;
};

struct graveyard {
    struct grave ring[GRAVES_MAX];
    uint32_t next;
    struct mu_table names;
};

/** @return the numbers of a name that has ended, or NULL; valid until the next call */
struct grave *graveyard_find(struct graveyard *g, const char *name);

/** Makes room for a name that has none there, if need be for the oldest one's. */
struct grave *graveyard_add(struct graveyard *g, const char *name);

/** An agent's name ends. */
void graveyard_bury(struct graveyard *g, const struct agent *a);

/** An agent's name has come back: it takes its numbers out. */
void graveyard_raise(struct graveyard *g, struct agent *a);

/* --- registry.c ------------------------------------------------------------------------------ */

/*
 * The white pages: every name that the broker knows, its bearer, and where that lives.
 *
 * The other parts of the broker find what is theirs by an agent's index.  A name keeps its index
 * until it ends (membership/retire.c): the index is held nowhere then, and another name may get it.
 */

/* Lines of the white pages that are published together. */
enum { REGISTRY_PAGE = 64, REGISTRY_PAGES = (REGISTRY_MAX + REGISTRY_PAGE - 1) / REGISTRY_PAGE };

/* How a name ends whose agent was disposed of. */
enum name_state {
    NAMED_LASTS,
    NAMED_ENDS_WITH_RUN, /* a step has disposed of it: the members of the run are to know */
    NAMED_ENDS,          /* what it holds is still to be cleared */
    NAMED_ENDED,         /* it holds nothing, and is unknown to senders */
    NAMED_STATES
};

enum name_event {
    NAMED_BORNE,    /* an agent has it */
    NAMED_DISPOSED, /* its process, or its broker, says so */
    NAMED_DISPOSED_BY_STEP,
    NAMED_CLEARED,
    NAMED_EVENTS
};

/* What the broker and the bearer of a name know of each other. */
enum bearer {
    BEARER_NONE,
    BEARER_AWAITED, /* it went without a word, or an earlier life of the broker knew it: its
                       receipts are kept */
    BEARER_OWED,    /* its process is to be told that it has the name, or where its box goes on */
    BEARER_TOLD,
    BEARERS
};

enum bearer_event {
    BEARER_SEATS,
    BEARER_OWES,
    BEARER_OWES_NOTHING, /* another broker, which need not know of a box that has not begun */
    BEARER_TELLS,
    BEARER_UNSEATS,
    BEARER_AWAITS,
    BEARER_FORGETS,
    BEARER_EVENTS
};

/* What its process has reported of an agent. */
enum report {
    REPORT_THERE,
    REPORT_AWAITED, /* nothing yet: the broker has given it to the process */
    REPORT_GONE,    /* inside a run: counts when that ends */
};

struct agent {
    char name[MU_NAME_MAX + 1];
    char place[MU_PROCESS_MAX + 1]; /* its process, or the last one that it had */
    uint32_t process;               /* MU_NONE when absent */
    uint8_t scope;                  /* enum scope: see steps.h */
    uint32_t left;                  /* the seat that a step took it from, or MU_NONE */
    uint64_t left_wall_ns;          /* since when the agent that left it had its name */
    struct mu_list claims;          /* on its name: see claims.c */
    struct resident resident;       /* while it has a process */
    struct presence is;
    uint64_t since_wall_ns;
    struct mail_numbers seq;
    uint64_t durable_order; /* of its last mail that is to go to the store, in this life, */
    uint64_t ram_order;     /* and of its last one in RAM */
    uint64_t mark;          /* the last list of receivers that it was put on */
    uint64_t kept_until_ns; /* so long newcomers wait for its last bearer: see names_hold */
    uint64_t seated_above;  /* the last number of its box before the last verdict */
    uint64_t step_version;  /* of its line when a step ended, if more was said of it since */
    enum bearer bearer;
    enum report report;
    enum name_state named;
    /* What a run has done with the name, until the next one begins: either, whatever becomes of it
     * then. */
    bool let_go;            /* it waited for the agent to come back in another process */
    bool passed;            /* it has taken the name from a process */
    bool unsaved;           /* the journal has to write its line, whoever bears it */
    muster_Kind saved_kind; /* on disk; JOURNAL_ENDED: the name has ended */
};

/* The end of names: see membership/retire.c. */
struct retirement {
    uint32_t ending; /* so many names are about to end, at least, that need not wait */
    uint64_t expiry_ns;
    uint64_t next_ns;        /* the next look */
    uint64_t ended;          /* counter */
    bool held[REGISTRY_MAX]; /* for each index, during a look */
};

struct registry {
    struct agent *agents;         /* REGISTRY_MAX of them; a free one has no name */
    uint32_t count;               /* no agent has a higher index */
    uint32_t live;                /* names that there are */
    uint32_t present;             /* agents that are there, the broker and its parts not counted */
    uint32_t order[REGISTRY_MAX]; /* indices in order of name: live of them */
    struct mu_pool ordinary; /* the indices of all but commands that found no place among them, */
    struct mu_pool kept;     /* and of those, from REGISTRY_ORDINARY on */
    struct graveyard graveyard;
    uint32_t roomless; /* names of the store that had no place when the broker began */
    struct changelog changes;
    struct mu_link pages[REGISTRY_PAGES];
    struct mu_list news; /* pages in which something has changed */
    uint64_t mark;
    struct mu_table names;
};

/** @param names  how many there may be at a time, the broker's own not counted */
void registry_init(struct registry *r, uint32_t names);

/** @return the index of a name, or MU_NONE */
static inline uint32_t registry_find(const struct registry *r, const char *name)
{
    return mu_table_find(&r->names, name);
}

/** @return the index of a name that has not ended, or MU_NONE: what is for it is turned down */
static inline uint32_t registry_addressee(const struct registry *r, const char *name)
{
    uint32_t agent = registry_find(r, name);
    return agent != MU_NONE && r->agents[agent].named == NAMED_ENDED ? MU_NONE : agent;
}

/* Something happens to a name; our own code aborts if it cannot. */
void registry_named_on(struct registry *r, uint32_t agent, enum name_event event);

/** @return whether it is the broker or one of its parts */
static inline bool registry_is_own(uint32_t agent)
{
    return agent < REGISTRY_OWN;
}

/** @return why no agent may register that name as that kind, or NULL */
const char *registry_objection(const char *name, muster_Kind kind);

/** Enters a new name, absent until registry_seat; one that has ended goes on with its numbers.
 * @return its index, or MU_NONE when full */
uint32_t registry_add(struct registry *r, const char *name);

/** A name that lasts is found by another one, too.  @param alias  stays where it is; NULL: none */
void registry_alias(struct registry *r, uint32_t agent, const char *alias);

/** Enters the name of a command where registry_add finds no place.  @return as registry_add */
uint32_t registry_add_command(struct registry *r, const char *name);

/** Ends a name: it goes to the graveyard, and its index to the next name that comes. */
void registry_remove(struct registry *r, uint32_t agent);

/** @return whether names should end that can: fewer than an eighth is free */
bool registry_is_crowded(const struct registry *r);

/** A line of the white pages is news to all again. */
void registry_touch(struct registry *r, uint32_t agent);

/** The agent is now in this process. */
void registry_seat(struct registry *r, uint32_t agent, uint32_t process, const char *place,
                   const struct presence *presence, uint64_t wall_ns);

/** The agent has left its process. */
void registry_unseat(struct registry *r, uint32_t agent, uint64_t wall_ns);

/** Takes in what a registration says of a seated agent.  @return whether anything changed */
bool registry_update(struct registry *r, uint32_t agent, const struct presence *presence,
                     uint64_t wall_ns);

/** @return the number that a new process of that name goes on after */
uint64_t registry_last_seq(const struct agent *a);

/** @return the next page in which a line has changed since it was last given here, or MU_NONE */
uint32_t registry_next_page(struct registry *r);

/** A page is to be given again. */
void registry_mark_page(struct registry *r, uint32_t page);

/** Orders elements that begin with an agent's index by its name, for mu_sort. */
int registry_compare(const void *x, const void *y, const void *registry);

/** Fills a line with pointers into the registry. */
void registry_line(const struct registry *r, uint32_t agent, const char *broker,
                   muster_Member *out);

/* --- claims.c -------------------------------------------------------------------------------- */

/*
 * Others want a name, and wait for its holder to go: each for so long, and in the order in which
 * they came.
 */

enum { CLAIMS_MAX = REGISTRY_MAX };

struct claim {
    uint32_t agent;    /* whose name it is */
    uint32_t process;  /* that wants it, */
    uint32_t slot;     /* for this agent of its own */
    uint64_t until_ns; /* it waits so long */
    struct presence presence;
    struct mu_link behind; /* on the same name, in the order in which they came */
    struct mu_link link;   /* of all, in order of until_ns */
};

struct claims {
    struct claim at[CLAIMS_MAX];
    struct mu_pool pool;
    struct mu_list list;
};

/** @return the claim of a process among those of a name, or MU_NONE */
uint32_t claims_find(const struct claims *c, const struct mu_list *of, uint32_t process);

/**
 * Enters a claim behind those of a name; the times of successive ones must not decrease.
 * @return whether there was room
 */
bool claims_add(struct claims *c, struct mu_list *of, const struct claim *claim);

/** Ends one of the claims of a name. */
void claims_drop(struct claims *c, struct mu_list *of, uint32_t index);

/* --- names.c --------------------------------------------------------------------------------- */

/* So long a new holder waits for the old one. */
enum { NAMES_HOLD_NS = 1500000000 };

/** Something happens to the bearer of a name; our own code aborts if it cannot. */
void names_bearer_on(struct registry *r, uint32_t agent, enum bearer_event event);

/** @return whether the agent lives beyond another broker */
static inline bool names_is_beyond(const struct registry *r, const struct processes *p,
                                   uint32_t agent)
{
    uint32_t place = r->agents[agent].process;
    return place != MU_NONE && p->at[place].kind == PROCESS_BROKER;
}

/** @return what may be handed to the agent just now; mail for one beyond another broker waits there
 */
static inline enum mailbox_gate names_gate(const struct registry *r, const struct processes *p,
                                           uint32_t agent)
{
    const struct agent *a = &r->agents[agent];
    if (a->process == MU_NONE) {
        return GATE_SHUT;
    }
    switch (a->is.state) {
    case muster_STATE_STANDBY:
    case muster_STATE_RUNNING: return GATE_OPEN;
    case muster_STATE_SUSPENDED: return names_is_beyond(r, p, agent) ? GATE_OPEN : GATE_URGENT;
    case muster_STATE_MOVING: return names_is_beyond(r, p, agent) ? GATE_OPEN : GATE_SHUT;
    case muster_STATE_ABSENT: break;
    }
    return GATE_SHUT;
}

/** Its bearer was lost with a broker, or is on its way to another platform, and may come by itself:
 * for a while newcomers wait. */
void names_hold(struct broker *b, uint32_t agent);

/** The broker at which an agent lives, if it is another one, is to know after which number its box
 * goes on: it takes none that does not follow. */
static inline void names_tell_number(struct registry *r, const struct processes *p, uint32_t agent)
{
    if (names_is_beyond(r, p, agent)) {
        names_bearer_on(r, agent, BEARER_OWES);
    }
}

/** @return when a process that begins to wait now has waited long enough */
uint64_t names_hold_end_ns(const struct broker *b);

/** The bearer of the name is on the way here: from a broker that is no more, or to another
 * platform. */
bool names_is_held(const struct broker *b, uint32_t agent);

/** The white pages have changed: a process that may be told at any time is. */
void names_changed(struct broker *b);

/** A process is told that it has the name; another broker, where a box goes on that others have had
 * something from. */
void names_owe_verdict(struct broker *b, uint32_t agent);

#endif
