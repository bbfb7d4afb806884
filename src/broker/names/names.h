/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file names.h
 * The bearers of names, in which process, and beyond which other broker.
 */
#ifndef MUSTER_BROKER_NAMES_H
#define MUSTER_BROKER_NAMES_H

#include "broker/base/base.h"
#include "core/table.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

struct broker;

/* --- registry.c ------------------------------------------------------------------------------ */

/*
 * The white pages: every name that the broker knows, its bearer, and where that lives.
 *
 * The other parts of the broker find what is theirs by an agent's index.  A name keeps its index
 * until it ends (membership/retire.c): the index is held nowhere then, and another name may get it.
 */

/** The broker itself stands first in the white pages, its parts after it (metrics.h). */
enum {
    REGISTRY_BROKER = 0,
    REGISTRY_OWN = MU_BROKER_LINES,
    REGISTRY_ORDINARY = MU_AGENTS_MAX + REGISTRY_OWN,
    REGISTRY_KEPT = 64, /* places beyond, for commands that come when all others are taken */
    REGISTRY_MAX = REGISTRY_ORDINARY + REGISTRY_KEPT
};

/* From so many names on the broker looks for names that can end. */
enum { REGISTRY_CROWDED = REGISTRY_ORDINARY - MU_AGENTS_MAX / 8 };

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
 * until it was looked at how urgent it is. */
enum resident_queue { RESIDENT_READY, RESIDENT_STIRRED, RESIDENT_QUEUES };

/* An agent in a place: see residents.h. */
struct resident {
    uint32_t place, slot;
    struct mu_link part; /* of the same part */
    struct mu_link links[RESIDENT_QUEUES];
};

struct agent {
    char name[MU_NAME_MAX + 1];
    char place[MU_PROCESS_MAX + 1]; /* its process, or the last one that it had */
    uint32_t process;               /* MU_NONE when absent */
    uint8_t scope;                  /* enum scope: see steps.h */
    uint32_t left;                  /* the seat that a step took it from, or MU_NONE */
    uint64_t left_wall_ns;          /* since when the agent that left it had its name */
    uint32_t claim;                 /* the first one on its name: see claims.h; MU_NONE: none */
    struct resident resident;       /* while it has a process */
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
    uint64_t kept_until_ns; /* so long newcomers wait for its last bearer: see names_hold */
    uint64_t seated_above;  /* the last number of its box before the last verdict */
    uint64_t step_version;  /* of its line when a step ended, if more was said of it since */
    bool verdict_due;
    bool seated;     /* it has acknowledged a later one */
    bool let_go;     /* a run waits for it to come back in another process */
    bool handed;     /* the broker has given it to its process, which has not said since when it is
                        there */
    bool gone;       /* its process went inside a run: counts when that ends */
    bool ended;      /* it was disposed of inside a run, whose members are to know */
    bool passed;     /* a run has taken the name from a process since it began */
    bool unsaved;    /* the journal has to write its line */
    bool ram_behind; /* it has sent mail in RAM behind durable_order */
    bool awaited; /* it went without a word, or an earlier life of the broker knew it: its receipts
                     are kept */
    muster_Kind saved_kind;
};

/*
 * The numbers of names that have ended, and may come back: by them mail that was sent before is
 * known to be a duplicate, and new mail is not taken for one.
 *
 * It holds the GRAVES_MAX names that have ended last.  A name that is not among them begins as one
 * that no agent has had.
 */
enum { GRAVES_MAX = 65536 };

struct grave {
    char name[MU_NAME_MAX + 1]; /* "": none */
    muster_Kind saved_kind;
    uint64_t seen_seq, came_seq, durable_seq, failed_seq; /* as those of struct agent */
    uint64_t earlier_seq, reserved_seq, elsewhere_seq;
};

struct graveyard {
    struct grave *ring; /* GRAVES_MAX of them */
    uint32_t next;
    struct mu_table names;
};

/* The end of names: see membership/retire.c. */
struct retirement {
    uint64_t expiry_ns;
    uint64_t next_ns; /* the next look */
    uint64_t ended;   /* counter */
    bool *held;       /* for each index, during a look */
};

struct registry {
    struct agent *agents; /* REGISTRY_MAX of them; a free one has no name */
    uint32_t count;       /* no agent has a higher index */
    uint32_t live;        /* names that there are */
    uint32_t present;     /* agents that are there, the broker and its parts not counted */
    uint32_t *order;      /* indices in order of name: live of them */
    uint32_t used;        /* ordinary indices ever given out */
    uint32_t *free;       /* those of names that have ended */
    uint32_t free_count;
    uint64_t kept; /* a bit for each place of REGISTRY_KEPT that is taken */
    struct graveyard graveyard;
    struct changelog changes;
    struct mu_link pages[REGISTRY_PAGES];
    struct mu_list news; /* pages in which something has changed */
    uint64_t mark;
    struct mu_table names;
};

void registry_init(struct registry *r);

/** @return the agent's scope, for the rules of steps/scope.h */
static inline uint8_t registry_scope(const struct registry *r, uint32_t agent)
{
    return r->agents[agent].scope;
}

/** @return the index of a name, or MU_NONE */
uint32_t registry_find(const struct registry *r, const char *name);

/** @return whether it is the broker or one of its parts */
bool registry_is_own(uint32_t agent);

/** @return why no agent may register that name as that kind, or NULL */
const char *registry_objection(const char *name, muster_Kind kind);

/** Enters a new name, absent until registry_seat; one that has ended goes on with its numbers.
 * @return its index, or MU_NONE when full */
uint32_t registry_add(struct registry *r, const char *name);

/** Enters the name of a command where registry_add finds no place.  @return as registry_add */
uint32_t registry_add_command(struct registry *r, const char *name);

/** Ends a name: it goes to the graveyard, and its index to the next name that comes. */
void registry_remove(struct registry *r, uint32_t agent);

/** @return whether registry_add has a place for one more */
bool registry_has_room(const struct registry *r);

/** @return whether names should end that can */
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

/* --- graveyard.c ----------------------------------------------------------------------------- */

void graveyard_init(struct graveyard *g);

/** @return the numbers of a name that has ended, or NULL; valid until the next call */
struct grave *graveyard_find(const struct graveyard *g, const char *name);

/** Makes room for a name that has none there, if need be for the oldest one's. */
struct grave *graveyard_add(struct graveyard *g, const char *name);

/** An agent's name ends. */
void graveyard_bury(struct graveyard *g, const struct agent *a);

/** An agent's name has come back: it takes its numbers out. */
void graveyard_raise(struct graveyard *g, struct agent *a);

/* --- claims.c -------------------------------------------------------------------------------- */

/*
 * Others want a name, and wait for its holder to go: each for so long, and in the order in which
 * they came.
 */

enum { CLAIMS_MAX = REGISTRY_MAX };

struct claim {
    uint32_t agent;   /* whose name it is */
    uint32_t process; /* that wants it, */
    uint32_t slot;    /* for this agent of its own */
    uint64_t until_ns;
    struct presence presence;
    uint32_t behind;     /* the next one on the same name, or MU_NONE */
    struct mu_link link; /* in order of until_ns */
};

struct claims {
    struct claim *at; /* CLAIMS_MAX of them */
    struct mu_pool pool;
    struct mu_list list;
};

void claims_init(struct claims *c);

/** @return the claim of a process among those that begin with `first`, or MU_NONE */
uint32_t claims_find(const struct claims *c, uint32_t first, uint32_t process);

/**
 * Enters a claim behind those that *first begins; the times of successive ones must not decrease.
 * @return whether there was room
 */
bool claims_add(struct claims *c, uint32_t *first, const struct claim *claim);

/** Ends one of the claims that *first begins. */
void claims_drop(struct claims *c, uint32_t *first, uint32_t index);

/* --- processes.c ----------------------------------------------------------------------------- */

/* The processes that agents live in, and which of them have something to be told. */

enum {
    PROCESSES_PARTS = MU_PARTS_MAX,
    PROCESSES_REFUSALS = 64,          /* that wait for one Delivery */
    PROCESSES_ALL = MU_PROCESSES_MAX, /* no place */
};

_Static_assert(MU_LOCAL_AGENTS_MAX % MU_PART_AGENTS == 0, "a process has whole parts");

/* A registration that was turned down. */
struct refusal {
    char name[MU_PROCESS_MAX + 1]; /* as it came, perhaps no valid name at all; cut if long */
    muster_Refusal code;
    const char *reason;
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

/* Its turn to be served: _READY, it is in the queue of those to look at; HELD, ordinary mail waits
 * for the dispatcher's next round; REFUSED, the network has refused its Delivery, which waits for
 * the next try. */
enum turn_state {
    TURN_IDLE,
    TURN_READY,
    TURN_HELD,
    TURN_HELD_READY,
    TURN_REFUSED,
    TURN_REFUSED_READY,
    TURNS
};

enum turn_event {
    TURN_WAKES,
    TURN_LOOKED_AT,
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
    uint32_t flooded_from; /* the place that the last of those mails came from, or MU_NONE */
    uint64_t flooded_until_ns;
    uint64_t flood_wake_ns; /* when it is woken, if it is held for that; else 0 */
    uint32_t seat;          /* its number; no other place ever had it */
    uint64_t serial;        /* of the last Delivery to it */
    uint64_t version_had;   /* of the white pages */
    uint64_t groups_had;
    uint64_t services_had;
    uint32_t claims; /* names that it waits for */
    uint32_t agents_count;
    uint32_t parts_top;                    /* parts ever used */
    struct mu_list parts[PROCESSES_PARTS]; /* its agents: see residents.h */
    struct mu_list queues[RESIDENT_QUEUES];
    uint32_t refusals_count;
    uint32_t unmatched_at; /* where it stands among the unmatched, if it has not matched */
    struct refusal refusals[PROCESSES_REFUSALS];
};

struct processes {
    struct process *at; /* MU_PROCESSES_MAX of them */
    uint32_t top;       /* entries ever used */
    uint32_t seats;     /* given out */
    uint32_t used_count;
    uint32_t *unmatched; /* indices of those in use that have not matched */
    uint32_t unmatched_count;
    uint32_t hearers;       /* those that read multicasts */
    uint32_t held, refused; /* those whose turn is so */
    bool all_awake;         /* since something happened to all, none has been looked at */
    uint32_t *queue;        /* a ring of MU_PROCESSES_MAX */
    uint32_t queue_head;
    uint32_t queue_count;
    struct mu_table names;
};

void processes_init(struct processes *p);

/** @return the index of a process, or MU_NONE */
uint32_t processes_find(const struct processes *p, const char *name);

/** Finds a process or enters it.  @return its index, or MU_NONE when full */
uint32_t processes_get(struct processes *p, const char *name);

/** Forgets a process, unless it is needed. */
void processes_tidy(struct processes *p, uint32_t place);

void processes_set_matched(struct processes *p, uint32_t place, bool matched);

/** Something happens to the reader or the writer of a process; our own code aborts if it cannot. */
void processes_session_on(struct processes *p, uint32_t place, enum session_event event);

/** Notes a refused registration; when there are too many, the process will ask again. */
void processes_refuse(struct processes *p, uint32_t place, const char *name, muster_Refusal code,
                      const char *reason);

/** The name is the process's after all: what it has not heard yet, it need not hear. */
void processes_accept(struct processes *p, uint32_t place, const char *name);

/** Puts a process into the queue of those that may have something to be told. */
void processes_wake(struct processes *p, uint32_t place);

/** Takes the first one out of the queue.  @return MU_NONE when it is empty */
uint32_t processes_next(struct processes *p);

/** Something happens to the turn of a process; our own code aborts if it cannot. */
void processes_turn_on(struct processes *p, uint32_t place, enum turn_event event);

/* States of processes: processes.c too. */

/** @return the next state, or SESSIONS: the event is illegal */
enum session processes_next_session(enum session session, enum session_event event);

enum turn_state processes_next_turn(enum turn_state turn, enum turn_event event);

bool processes_is_held(const struct process *at);
bool processes_is_refused(const struct process *at);
bool processes_is_matched(const struct process *at);
bool processes_hears(const struct process *at);
bool processes_is_silent(const struct process *at);

/* --- residents.c ----------------------------------------------------------------------------- */

/* Which agents live in a place, part by part, and which of them may have something to be told. */

/** No agent: the broker itself lives in no place. */
#define RESIDENTS_NONE MU_NONE

/** An agent, which lives nowhere, moves into a slot of a place. */
void residents_add(struct registry *r, struct processes *p, uint32_t place, uint32_t slot,
                   uint32_t agent);

/** An agent leaves its place. */
void residents_remove(struct registry *r, struct processes *p, uint32_t agent);

/** @return the first agent of a place, or of a part of it, or RESIDENTS_NONE */
uint32_t residents_first(const struct processes *p, uint32_t place);
uint32_t residents_first_of(const struct processes *p, uint32_t place, uint32_t part);

/** @return the next agent of the same place, or of the same part, or RESIDENTS_NONE */
uint32_t residents_next(const struct registry *r, const struct processes *p, uint32_t agent);
uint32_t residents_next_of(const struct registry *r, uint32_t agent);

/** The agent may have something to be told, and its place with it; without a place, nothing. */
void residents_wake(struct registry *r, struct processes *p, uint32_t agent);

/**
 * @return an agent of the place that was woken since it was last served or calmed, or
 * RESIDENTS_NONE: so no waiting agent has to be looked at twice
 */
uint32_t residents_stirred(const struct processes *p, uint32_t place);

/** What the agent has to be told can wait, until it is woken again. */
void residents_calm(struct registry *r, struct processes *p, uint32_t agent);

/** Takes the agent that waits longest out of a place's queue.  @return RESIDENTS_NONE: none waits
 */
uint32_t residents_pop(struct registry *r, struct processes *p, uint32_t place);

/* --- names.c --------------------------------------------------------------------------------- */

/** @return what may be handed to the agent just now */
enum mailbox_gate names_gate(const struct broker *b, uint32_t agent);

/**
 * It has acknowledged a number.  If that was not handed out before the last verdict, its process
 * knows its seat here, and which number comes next: a reader that has had that number already takes
 * whatever follows it.
 */
void names_confirm(struct broker *b, uint32_t agent, uint64_t number);

/** @return whether the agent lives beyond another broker */
bool names_is_beyond(const struct broker *b, uint32_t agent);

/** Its bearer was lost with a broker, or is on its way to another platform, and may come by itself:
 * for a while newcomers wait. */
void names_hold(struct broker *b, uint32_t agent);

/** The broker at which an agent lives, if it is another one, is to know after which number its box
 * goes on: it takes none that does not follow. */
void names_tell_number(struct broker *b, uint32_t agent);

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

/* --- remote.c -------------------------------------------------------------------------------- */

/*
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
 * such a one is used only after a pause, in which the brokers that relied on us have heard that we
 * know none.  An agent's own broker is always believed.
 */

/* How long another way has to wait that may be an echo of our own. */
enum { FEDERATION_PAUSE_MS = 1000 };

/*
 * Where a new process of a name begins to number its mail: each broker has lanes of its own, by its
 * name, so that of two that cannot hear each other neither gives a number that the other gives.
 */
enum { FEDERATION_RANGE_NUMBERS = 1 << 16, FEDERATION_RANGES = 1 << 20 };

/* Acknowledgements in one Up to a neighbour. */
enum { FEDERATION_ACKS = 1024 };

/* What a neighbour says of an agent. */
struct route {
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

struct peer {
    char name[MU_NAME_MAX + 1];
    char place[MU_PROCESS_MAX + 1];
    enum peer_state state;
    uint64_t incarnation;
    uint64_t heard_ns; /* when this life of it was heard last */
    /* One for each agent of the registry: */
    struct route *routes;
    uint64_t *taken; /* the last number of its box there that was taken here */
    bool *ack_due;
    uint32_t *acks; /* those with an acknowledgement due */
    /* By their slots in its announcement, one more than the indices of those that are there: */
    uint32_t *at_slot;
    uint32_t acks_count;
};

/* An agent without a route waits until it may have one that can be an echo. */
struct pause {
    uint64_t until_ns;
    struct mu_link link;
};

struct federation_counts {
    uint64_t announced, parcels_in, passed_on, repeated, receipts_in, clashes, hops_refused;
    uint64_t earlier_lives;
};

struct federation {
    struct peer peers[MU_BROKERS_MAX];
    uint32_t peers_count;
    uint32_t peers_there;
    struct pause *pauses; /* one for each agent */
    struct mu_list pausing;
    char holders[MU_BROKERS_MAX][MU_FIELD_MAX + 1]; /* reasons of refusals */
    uint32_t holders_count;
    /* announce.c */
    uint32_t listeners; /* other brokers that are there */
    uint64_t version_said;
    bool missed;      /* an agent beyond another broker had no place in the white pages */
    uint64_t beat_ns; /* the next heartbeat */
    bool due[MU_PARTS_MAX];
    uint32_t due_count;
    uint32_t part_open;
    muster_Entry entries[MU_PART_AGENTS];
    /* relay.c */
    uint32_t peer_open;
    muster_Ack *acks_open;
    uint32_t acks_open_count;
    struct federation_counts count;
};

void remote_init(struct federation *l);

/** @return whether a process's name is that of a broker */
bool remote_is_broker(const char *process);

/** @return the broker's name in such a name of a process */
const char *remote_name(const char *process);

/** @return the neighbour of that name, or NULL */
struct peer *remote_peer(struct broker *b, const char *name);

/** @return the reason of a refusal: an agent at that broker holds the name */
const char *remote_holder(struct broker *b, const char *home);

/** @return the lane of this broker, below FEDERATION_RANGES */
uint64_t remote_range(const struct broker *b);

/** @return the number behind which a new process of that agent begins to number its mail */
uint64_t remote_begin_seq(const struct broker *b, uint32_t agent);
uint64_t remote_deadline_ns(const struct broker *b);

struct peer *remote_best_peer(struct broker *b, uint32_t agent);

/** @return whether a life of a neighbour has been silent for so long that what is said by an
 * earlier number cannot be a word that was under way */
bool remote_is_over(const struct broker *b, const struct peer *p);

/** @return whether a way can lead back to here: its neighbour may have it from us */
bool remote_may_be_echo(const struct agent *a, const struct route *route, bool same_neighbour);

void remote_forget_numbers(struct broker *b, struct peer *p);

void remote_hold_down(struct broker *b, uint32_t agent);

/** Ends the pause that remote_deadline_ns is of.  @return the agent */
uint32_t remote_end_pause(struct federation *l);

/** @return whether an agent has to wait for a route that can be an echo */
bool remote_pauses(const struct federation *l, uint32_t agent);

/** A silent one makes room. */
struct peer *remote_add_peer(struct broker *b, const char *name);

/** @return false: the event was refused, and counted */
bool remote_peer_on(struct federation *l, struct peer *p, enum peer_event event);

struct presence remote_presence(const struct route *route);

/** A process that comes after it must not begin with numbers that it has used. */
void remote_lose_route(struct broker *b, struct peer *p, uint32_t agent);

#endif
