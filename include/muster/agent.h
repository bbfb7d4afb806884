/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file agent.h
 * Agents: a name in the white pages, mail by name, and, for a robot, a body.
 *
 * A process opens a connection to the bus (mu_process), lets one or more agents join, and spins.
 * Everything happens in mu_process_spin, in the caller's thread; handlers are called from there,
 * must not block, and may send, drive, join and leave.
 * Registering, leaving, acknowledging, resending and the answers to directives are the runtime's: a
 * controller has no line of code for them.
 *
 * One thread at a time calls functions of one process; mu_process_stop alone may be called from
 * anywhere.  A child of fork has no connection: there, mu_process_close does nothing.
 *
 * Units: metres, radians (counter-clockwise, 0 along +x), seconds, or nanoseconds where the name
 * says so.
 */
#ifndef MUSTER_AGENT_H
#define MUSTER_AGENT_H

#include "muster/limits.h"
#include "muster/percept.h"
#include "muster/refusal.h"
#include "muster/result.h"
#include "muster/version.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

typedef struct mu_process mu_process;
typedef struct mu_agent mu_agent;

enum mu_kind { MU_KIND_AGENT, MU_KIND_ROBOT, MU_KIND_HOST, MU_KIND_SPECIAL };

enum mu_state { MU_STANDBY, MU_RUNNING, MU_SUSPENDED, MU_MOVING, MU_GONE };

enum mu_outcome {
    MU_MAIL_DELIVERED,
    MU_MAIL_STORED,
    MU_MAIL_EXPIRED,
    MU_MAIL_BOX_FULL,
    MU_MAIL_UNKNOWN_NAME,
    MU_MAIL_DUPLICATE,
    MU_MAIL_REFUSED,
    MU_MAIL_DROPPED,  /* it was in the box, and had to make room for another */
    MU_MAIL_NO_STORE, /* its level needs a disk that the broker has not, or cannot write to */
};

/* The failure that waiting mail survives at the broker. */
enum mu_level {
    MU_LEVEL_RAM,    /* nothing */
    MU_LEVEL_LOGGED, /* the death of the broker */
    MU_LEVEL_SYNCED, /* the loss of power, too */
};

/* A higher one overtakes in the receiver's box; within one, mail keeps its order. */
enum mu_priority { MU_PRIORITY_LOW = -1, MU_PRIORITY_NORMAL, MU_PRIORITY_HIGH };

/* What happens to mail for a box that is full. */
enum mu_box_policy { MU_BOX_REFUSE_NEW, MU_BOX_DROP_OLDEST, MU_BOX_DROP_LOWEST };

/** @return the word for it, as people and rules see it; never NULL */
const char *mu_kind_text(enum mu_kind kind);
const char *mu_state_text(enum mu_state state);
const char *mu_outcome_text(enum mu_outcome outcome);

/* Layers of mail; a designer adds higher ones. */
enum mu_layer { MU_LAYER_SYSTEM = 1, MU_LAYER_QUERY, MU_LAYER_SPEECH };

/*
 * A mail.  To send one, set dst and content and what else is wanted: NULL strings mean "".
 * In a mail that arrived every string is set.
 */
struct mu_mail {
    const char *src; /* set by the runtime */
    const char *dst; /* a name, names joined by commas; all, robots, special; group:G, or another
                        address that a resolver knows: role:R, task:T, near:2.5 */
    uint64_t seq;    /* set by the runtime: counts the sender's mails from 1 */
    uint64_t number; /* of an arrived mail: its place in this agent's box */
    bool directive;  /* enters no layer: the broker's trust policy lets it through or not, and
                        the receiver has no choice */
    uint32_t layer;  /* enum mu_layer, or a higher one; 0: MU_LAYER_SPEECH */
    const char *performative; /* of a directive: start, suspend, resume, do, ... */
    const char *language;     /* "" is clips */
    const char *ontology;
    const char *reply_with, *in_reply_to, *conversation;
    const char *content;
    uint64_t reply_by_ns; /* an answer after this time of the run is not wanted; 0: any time */
    enum mu_priority priority;
    enum mu_level level;
    bool timed;      /* wait for due_ns; else it goes at once */
    uint64_t due_ns; /* not before this time of the run */
    uint64_t ttl_ns; /* expires when this old; 0: never */
};

/* Orders to a gripper. */
enum mu_paddles { MU_PADDLES_OPEN = -1, MU_PADDLES_KEEP, MU_PADDLES_CLOSE };
enum mu_lift { MU_LIFT_DOWN = -1, MU_LIFT_KEEP, MU_LIFT_UP };

/* A line of the white pages.  A version adds members at the end. */
struct mu_member {
    char name[MU_NAME_MAX + 1];
    enum mu_kind kind;
    enum mu_state state;
    char broker[MU_NAME_MAX + 1];
    char host[MU_FIELD_MAX + 1];   /* the agent of kind host on which it lives; "": on none */
    uint32_t pid;                  /* of its process */
    uint64_t since_wall_ns;        /* since when in this state, nanoseconds since 1970 */
    uint64_t busy_since_wall_ns;   /* its rules, or a line, run since then; 0: no, or for less than
                                      half a second */
    char reason[MU_FIELD_MAX + 1]; /* why it suspended itself, for people; "" otherwise */
};

/* A line of the yellow pages (directory.h).  A version adds members at the end. */
struct mu_service {
    char service[MU_NAME_MAX + 1];
    char agent[MU_NAME_MAX + 1];
    char attributes[MU_ATTRIBUTES_MAX + 1]; /* key=value, separated by spaces */
};

/* Events that an agent can hear of; any handler may be NULL.  Arguments are valid in the handler
 * only.  A version adds members at the end. */
struct mu_handlers {
    void *self;
    /** The broker has accepted or refused the name; a refusal is final, with a reason. */
    void (*on_registered)(void *self, mu_agent *a, bool accepted, const char *reason);
    /** A mail arrived.  It is acknowledged when this returns. */
    void (*on_mail)(void *self, mu_agent *a, const struct mu_mail *mail);
    /** A directive that the runtime does not carry out itself: "do", "step", ... */
    void (*on_directive)(void *self, mu_agent *a, const struct mu_mail *mail);
    /** The agent's state has changed, or it runs and was told to resume. */
    void (*on_state)(void *self, mu_agent *a, enum mu_state state);
    /** A control step begins, in any state; drive only when running. */
    void (*on_step)(void *self, mu_agent *a, const struct mu_percept *percept);
    /** The control step's mail is in, and the agent runs: act. */
    void (*on_act)(void *self, mu_agent *a, const struct mu_percept *percept);
    /** A tick: a control step begins, in any state, for an agent whose name has no body in the
     *  world.  Of the percept, only step and time_ns have values.  on_act follows. */
    void (*on_beat)(void *self, mu_agent *a, const struct mu_percept *percept);
    /** For a process that watches: a control step begins.  The percepts have poses and speeds of
     * all bodies, in the world's order, and no readings of sensors.  Mail of the step follows. */
    void (*on_world)(void *self, mu_agent *a, const struct mu_percept *bodies, size_t count);
    /** The outcome of the mails first_seq to last_seq. */
    void (*on_receipt)(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome);
    /** The broker has refused a change of groups or services (directory.h): which, and why. */
    void (*on_refusal)(void *self, mu_agent *a, const char *change, const char *reason);
    /** An agent offers (came) or no longer offers a service that mu_agent_watch_service asked for.
     */
    void (*on_service)(void *self, mu_agent *a, const struct mu_service *service, bool came);
};

/* --- kinds of agents: kind.h ------------------------------------------------------------------ */

/* The result of a handler. */
enum mu_take {
    MU_PASS,    /* not mine: ask the next one */
    MU_TAKEN,   /* done, answered if an answer was wanted */
    MU_DECLINE, /* mine, and refused: the runtime answers `refuse`, unless the mail was an answer */
};

struct mu_layer_handler {
    uint32_t layer;           /* 0 ends a table */
    const char *performative; /* NULL: every one */
    enum mu_take (*take)(void *self, mu_agent *a, const struct mu_mail *mail);
};

/* Events of an agent's life. */
enum mu_event {
    MU_ON_CREATE,  /* the broker has accepted its name for the first time */
    MU_ON_RUN,     /* it begins to run: when it is created, or when it is started */
    MU_ON_ARRIVE,  /* it has moved here */
    MU_ON_LEAVE,   /* it is about to move */
    MU_ON_CLONE,   /* it is a copy of another one */
    MU_ON_DISPOSE, /* it is about to go for good; mail that it sends now still goes out */
    MU_EVENTS
};

struct mu_agent_kind {
    const char *name;
    const struct mu_agent_kind *parent;      /* NULL: mu_base_kind */
    const struct mu_layer_handler *handlers; /* ends with layer 0; NULL: none of its own */
    void (*hooks[MU_EVENTS])(void *self, mu_agent *a); /* NULL: the parent's is called */
};

/* --- a process -------------------------------------------------------------------------------- */

/** Domain 0, whatever the environment says. */
#define MU_DOMAIN_ZERO (-2147483647 - 1)

/* A version adds members at the end: all 0 is as before. */
struct mu_process_options {
    int domain;            /* DDS domain; 0: that of MUSTER_DOMAIN, where that is set */
    const char *interface; /* address of the interface; NULL: 127.0.0.1 */
    const char *peer;      /* hosts of brokers and simulator, joined by commas; NULL: this one */
    const char *name;      /* for DDS tools; NULL: the program's */
    bool with_body;        /* its agents have bodies: the simulator's steps are wanted */
    bool watches;          /* its agents have none, and see all bodies (on_world): steps of a lock
                              step wait for them, too.  Agents of MU_KIND_SPECIAL stay
                              outside: their mail comes in behind the mail of its members */
    uint32_t agents;       /* capacity; 0: MU_LOCAL_AGENTS; MU_LOCAL_AGENTS_MAX at most */
    uint32_t outbox;       /* mails of an agent that may wait for an answer; 0: MU_OUTBOX_MAX;
                              MU_OUTBOX_MOST at most */
    const char *broker;    /* name of the broker to begin with, which is waited for; NULL: that
                              of MUSTER_BROKER, else the first one of this host, else of another */
};

/**
 * Connects to the bus; a program can be in a domain once at a time.  Comes before mu_memory_seal;
 * its memory is the program's for good, so that it is no call for a loop.
 *
 * @param options  copied; NULL: all 0
 * @return MU_OK; MU_FAULT_USAGE: an option is wrong, or the program is in that domain already, or
 *         was built with headers of another version that do not fit this library; MU_FAULT_DDS
 */
MU_MUST_USE mu_result mu_process_open(mu_process **out, const struct mu_process_options *options);

/**
 * What mu_process_open is in C and C++.  A binding of another language may call mu_process_open
 * itself: its structs are then taken for those of this library.
 *
 * @param version  MU_VERSION of the program
 * @param sizes    mu_process_sizes of the program: structs to which a version adds members at the
 *                 end may be shorter than the library's, the rest is as long
 * @return as mu_process_open
 */
MU_MUST_USE mu_result mu_process_open_built(mu_process **out,
                                            const struct mu_process_options *options,
                                            const char *version, const uint32_t *sizes);

/**
 * Lets every agent leave and disconnects; p and its agents are no more.  Not for handlers: there,
 * mu_process_stop.  NULL, or in a child of the program that opened it: nothing to do.
 */
void mu_process_close(mu_process *p);

/**
 * Waits for at most timeout_ns and handles samples that have arrived.  Without a wait, a spin that
 * follows a send looks for them if the last look is 20 us ago.
 *
 * @return MU_OK; MU_DONE when the run is over; MU_BUSY: a handler called it, and nothing is done;
 *         MU_FAULT_DDS; MU_FAULT_USAGE: in a child of the program that opened it
 */
MU_MUST_USE mu_result mu_process_spin(mu_process *p, int64_t timeout_ns);

/**
 * For a program with a poll loop of its own: call mu_process_spin(p, 0) when the descriptor is
 * readable, and at least every 100 ms, because heartbeats are sent from there.
 *
 * @return a file descriptor that is readable when something has arrived; it stays the process's,
 *         until mu_process_close; -1: the system has none left
 */
int mu_process_wake_fd(mu_process *p);

/**
 * Spins until the run is over, mu_process_stop is called, or SIGINT or SIGTERM arrives.
 *
 * @return MU_OK: it has ended, for whatever reason; MU_BUSY and faults as mu_process_spin
 */
MU_MUST_USE mu_result mu_process_run(mu_process *p);

/** Ends mu_process_run, now and whenever it is called again; may be called from handlers, signal
 *  handlers and other threads. */
void mu_process_stop(mu_process *p);

/** Has round called after each round of mu_process_run, at least every 300 ms; NULL: no more. */
void mu_process_each_round(mu_process *p, void (*round)(void *self), void *self);

/** @return whether the simulator's steps wait for this process */
bool mu_process_in_lockstep(const mu_process *p);

/** Spins until a broker has answered: to the first agent, as none is asked before.  @return
 * MU_OK, MU_TIMEOUT after patience_ns, or what mu_process_spin says else */
MU_MUST_USE mu_result mu_process_await_broker(mu_process *p, uint64_t patience_ns);

/** @return whether a broker is connected */
bool mu_process_has_broker(const mu_process *p);

/**
 * The broker that has answered.  When it is silent for a second the process goes to another one
 * that is there, or waits for the first to come back.  Its agents keep their names, and mail
 * without an answer goes out again.  In lock step a process stays.
 *
 * @return its name, valid until the next spin; NULL: none has answered, or it is silent
 */
const char *mu_process_broker(const mu_process *p);

/**
 * Enters an agent; the answer comes to on_registered.
 *
 * An agent with body starts in standby, others are running.
 *
 * @param name         NULL: that of MUSTER_AGENT, by which `muster run` names a controller's agent
 * @param handlers     copied; NULL: none
 * @param last_number  the last mail number that an earlier life of this agent has dealt with: mail
 *                     up to it is dropped when it comes again.  0 when it keeps no record.
 * @return MU_OK; MU_MALFORMED: not a name, or no kind; MU_EXISTS: an agent of this process bears
 * it; MU_FULL: the process has room for no more.  The place of an agent that has left is reused
 * when no other is free and its last mails are out: pointers to it then mean the new agent
 */
MU_MUST_USE mu_result mu_agent_join(mu_process *p, mu_agent **out, const char *name,
                                    enum mu_kind kind, uint64_t last_number,
                                    const struct mu_handlers *handlers);

/* How far an agent has come in one process, for its life in another. */
struct mu_passage {
    uint64_t last_number; /* that it has taken from its box, */
    uint64_t handed;      /* so many mails in all, */
    uint64_t broker;      /* at the broker of this incarnation */
    uint64_t epoch;       /* how often it has set out */
    enum mu_kind kind;    /* it stays what it is */
};

/**
 * Says that it sets out, or stays after all: a copy of it that another process may have is out of
 * date, and the broker gives the name to no such copy.
 */
void mu_agent_set_out(mu_agent *a);

/** @return how far it has come; final when it is settled */
struct mu_passage mu_agent_passage(const mu_agent *a);

/** @return whether the broker has answered for all mail it sent, and heard of all that it took */
bool mu_agent_is_settled(const mu_agent *a);

/**
 * Leaves the process for another one, as when it is disposed of.  But its rules hear nothing, and
 * mail at the broker waits for its next life.
 */
void mu_agent_leave(mu_agent *a);

/** Lets mail to `all` pass this agent by: it spares agents that would only throw it away. */
void mu_agent_decline_broadcasts(mu_agent *a);

/**
 * Limits mail that waits for the agent at the broker, and chooses the policy of a full box.
 *
 * @param mails, bytes  0: the broker's own limits, which are never exceeded
 */
void mu_agent_limit_box(mu_agent *a, enum mu_box_policy policy, uint32_t mails, uint64_t bytes);

/**
 * Sends a mail; it is kept and sent again until the broker has answered for it.
 *
 * @param seq  out: its number, for on_receipt; may be NULL.  Before on_registered it is not final:
 *             an earlier agent of that name may have sent mails, and the count goes on after them.
 * @return MU_OK; MU_MALFORMED: a field is missing or too long, or priority or level are none;
 *         MU_FULL: as many mails as the process's options allow, or as many bytes as they are given
 *         room for, are not answered for yet; MU_REFUSED: the agent has left
 */
MU_MUST_USE mu_result mu_agent_send(mu_agent *a, const struct mu_mail *mail, uint64_t *seq);

/** Sends content to all active agents.  Results as mu_agent_send. */
MU_MUST_USE mu_result mu_agent_broadcast(mu_agent *a, const char *content);

/** Sets the speed that the body aims at.  @return MU_OK, or MU_REFUSED: NaN or infinite */
MU_MUST_USE mu_result mu_agent_drive(mu_agent *a, double forward_m_s, double turn_rad_s);

/**
 * Says which sensors the body is to read from the next step on; the others report nothing, and
 * cost nothing.  An agent that never calls this reads sonar.
 *
 * @param senses  bits of enum mu_sense; others are ignored, as is a sensor that the body has not
 */
void mu_agent_senses(mu_agent *a, uint32_t senses);

/**
 * Orders the gripper; KEEP leaves an earlier order of this step.  The gripper takes time:
 * percept->gripper has its state.  A body without one does nothing.
 *
 * @return MU_OK, or MU_MALFORMED: not values of their enumerations
 */
MU_MUST_USE mu_result mu_agent_grip(mu_agent *a, enum mu_paddles paddles, enum mu_lift lift);

/** Says which rules fired in this step, for the run's hash; names separated by spaces, copied. */
void mu_agent_fired(mu_agent *a, uint32_t firings, const char *rules);

/** The same of rules that fired behind them, in the same step. */
void mu_agent_fired_also(mu_agent *a, uint32_t firings, const char *rules);

/**
 * Adds text, copied, to the execution trace of this agent's step in a recording.  It is not in the
 * run's hash.  A step has room for MU_NOTE_MAX bytes; more is cut off.
 */
void mu_agent_note(mu_agent *a, const char *text);

/**
 * Sets the agent's goal, for people at a console or page; it is not in the run's hash.
 *
 * @param goal  in words, copied: "gohome 3000.0 0.0"; cut at MU_FIELD_MAX bytes
 */
void mu_agent_want(mu_agent *a, const char *goal);

/** @return the name, as long as the process is open */
const char *mu_agent_name(const mu_agent *a);

/** @return why the broker has refused the agent's name; MU_REFUSAL_NONE: it has not */
enum mu_refusal mu_agent_refusal(const mu_agent *a);

/** @return the state; MU_GONE for ever when it was disposed of */
enum mu_state mu_agent_state(const mu_agent *a);

/** Changes the state, as a directive would; the white pages follow.  MU_GONE is final: the agent is
 * disposed of, and its name ends. */
void mu_agent_set_state(mu_agent *a, enum mu_state state);

/**
 * Suspends an agent that runs and finds that it had better not; the white pages say why.
 *
 * @param reason  cut at MU_FIELD_MAX bytes
 */
void mu_agent_suspend(mu_agent *a, const char *reason);

/** @return the line of a name, valid until the next spin; NULL: not in the white pages */
const struct mu_member *mu_process_lookup(const mu_process *p, const char *name);

/** @return the index-th line in order of name, valid until the next spin; NULL past the last */
const struct mu_member *mu_process_member(const mu_process *p, size_t index);

/* The structs that a program and the library share, as the program has them. */
static inline const uint32_t *mu_process_sizes(void)
{
    static const uint32_t sizes[] = {(uint32_t)sizeof(struct mu_process_options),
                                     (uint32_t)sizeof(struct mu_handlers),
                                     (uint32_t)sizeof(struct mu_mail),
                                     (uint32_t)sizeof(struct mu_percept),
                                     (uint32_t)sizeof(struct mu_blob),
                                     (uint32_t)sizeof(struct mu_fiducial),
                                     (uint32_t)sizeof(struct mu_passage),
                                     (uint32_t)sizeof(struct mu_member),
                                     (uint32_t)sizeof(struct mu_service),
                                     (uint32_t)sizeof(struct mu_layer_handler),
                                     (uint32_t)sizeof(struct mu_agent_kind),
                                     0};
    return sizes;
}

#define mu_process_open(...) mu_process_open_built(__VA_ARGS__, MU_VERSION, mu_process_sizes())

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
