/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file process.h
 * A process on the bus and the agents in it, which the parts of the runtime share.
 */
#ifndef MUSTER_RUNTIME_PROCESS_H
#define MUSTER_RUNTIME_PROCESS_H

#include "bus/bus.h"
#include "core/text.h"
#include "muster/agent.h"
#include "runtime/ack_delay.h"
#include "runtime/dedup.h"
#include "runtime/directory.h"
#include "runtime/inbox.h"
#include "runtime/kind.h"
#include "runtime/life.h"
#include "runtime/link.h"
#include "runtime/members.h"
#include "runtime/outbox.h"
#include "runtime/probes.h"
#include "runtime/queue.h"
#include "runtime/resolver.h"
#include "runtime/returns.h"
#include "runtime/roll.h"
#include "runtime/transfers.h"
#include "wire.h"

#include <stdatomic.h>
#include <sys/types.h>

enum {
    PROCESS_UP_MAILS = 256,       /* mails in one Up; in the answer to a step, of each agent */
    PROCESS_UP_ACKS = 1024,       /* acknowledgements in one Up, or one of each agent */
    PROCESS_ITEMS = 64 * 1024,    /* items in one Delivery; more come again */
    PROCESS_UP_BYTES = 48 * 1024, /* of mail content beside the first mail, likewise */
    PROCESS_RULES_MAX = 8 * 1024, /* names of fired rules, in bytes */
};

/* The speeds that an agent wants for its body. */
struct agent_speed {
    bool set; /* in this step */
    double forward_m_s, turn_rad_s;
};

struct mu_agent {
    mu_process *process;
    char name[MU_NAME_MAX + 1];
    enum mu_kind kind;
    enum mu_state state;
    struct mu_handlers handlers;
    struct kind_part part; /* the state of its kind */
    struct resolver resolver;
    struct probes_handlers probes;
    returns_handler *on_return;    /* NULL: none */
    uint64_t since_wall_ns;        /* since when it has its name */
    uint64_t epoch;                /* how often it has set out for another process */
    char reason[MU_FIELD_MAX + 1]; /* why it is suspended, if it suspended itself */
    enum life_name name_state;
    enum mu_refusal refusal; /* why its name was refused, if it was */
    uint64_t refused;        /* verdicts that its state did not allow */
    bool no_broadcasts;
    enum mu_box_policy box_policy; /* when its box is full, */
    uint32_t box_mails;            /* which holds so many mails, */
    uint64_t box_bytes;            /* of so many bytes; 0: the broker's own limit */
    uint64_t broker_incarnation;   /* of the broker that has accepted it; 0: none yet */
    uint64_t accepted_serial;      /* of the Delivery that has said so last, or of one before it */
    struct mu_link links[QUEUES];
    enum life_exit exit;      /* EXIT_PRESENT until it is MU_GONE */
    enum mu_state last_state; /* which its registration has while it is leaving */
    struct outbox outbox;
    uint64_t progress_ns;    /* wall: when the broker last answered for mail, or mail went out */
    uint64_t earlier_end;    /* mails below this number were there before that one came */
    bool in_order;           /* the box's numbers go on after last_number, without gaps */
    uint64_t last_number;    /* of its box that it got */
    uint64_t acked_number;   /* told the broker */
    uint64_t handed;         /* items that reached its handlers */
    uint32_t senses;         /* bits of enum mu_sense: that its body is to read */
    enum mu_paddles paddles; /* this step */
    enum mu_lift lift;
    bool embodied;             /* this step: the simulator has sent what its body feels */
    struct mu_percept percept; /* this step */
    struct agent_speed speed;
    uint32_t firings; /* this step */
    char goal[MU_FIELD_MAX + 1];
    uint64_t repeats; /* mails that came again through another broker, and were dropped */
    struct dedup *dedup;
    char *rules;         /* PROCESS_RULES_MAX + 1 bytes; NULL: the process has no bodies */
    struct mu_text note; /* for recordings, until it is sent; likewise */
    uint32_t act;        /* where it stands in the Up that is being put together */
};

/* The purpose of a process; mu_process_open fixes it. */
enum process_role {
    PROCESS_PLAIN,
    PROCESS_BODY,  /* the simulator's steps move its agents' bodies */
    PROCESS_WATCH, /* the simulator's steps show it all bodies */
};

/* A process and the simulator's steps. */
enum process_steps {
    PROCESS_FREE,     /* no simulator is known */
    PROCESS_GREETED,  /* a simulator's first Sense has come, which is no step */
    PROCESS_READY,    /* all that lock step needs has matched */
    PROCESS_STEPPING, /* a step of a lock step has come */
    PROCESS_LIVED,    /* its agents have lived through one */
    PROCESS_DONE,     /* the simulator has ended the run */
    PROCESS_STEPS
};

enum process_step_event {
    STEP_GREETING, /* samples of the simulator */
    STEP_LOCKSTEP,
    STEP_FREE, /* a step without lock step */
    STEP_LAST, /* the run is over */
    STEP_OWN_EVENTS,
    STEP_MATCHED = STEP_OWN_EVENTS, /* all that lock step needs has matched, */
    STEP_UNMATCHED,                 /* and no longer */
    STEP_LIVED,
    STEP_OVER, /* the run is over, or its simulator is gone: the next one may come */
    STEP_EVENTS
};

/* The Up that is being put together. */
enum process_up {
    UP_NONE,
    UP_ANSWERING, /* the answer to a step is put together, and is about to go out */
    UP_PENDING,   /* it goes out as soon as the network takes it */
    UP_STATES
};

/* Why the agents are asked before an Up goes out. */
enum process_up_due {
    UP_DUE,                 /* they may save what they are */
    UP_AGAIN_FOR_BROKER,    /* it lacks an answer that the simulator has */
    UP_AGAIN_FOR_SIMULATOR, /* it lacks an answer that the broker has */
    UP_WAS_SAID,            /* both have it: what the broker answers to its mail is to come */
};

enum process_up_event {
    UP_ANSWERS, /* the answer to a step is put together */
    UP_GOES,    /* it may go out */
    UP_WRITTEN, /* the network has it */
    UP_DROPPED, /* it was for another broker */
    UP_EVENTS
};

struct mu_process {
    struct bus bus;
    char name[MU_PROCESS_MAX + 1];  /* also its partition */
    char host[MU_FIELD_MAX + 1];    /* the machine's name */
    char platform[MU_NAME_MAX + 1]; /* the agent of kind host in it; "": it is no host */
    enum process_role role;
    enum process_steps steps;
    enum process_up up_state;
    uint64_t refused; /* samples of a simulator that its state did not allow */
    struct link link;
    struct bus_writer registration;
    struct bus_writer up; /* closed while no broker is known */
    struct bus_reader delivery, multicasts, sense;
    uint64_t incarnation;
    uint32_t handlers_size;  /* in the program, which may know fewer */
    uint32_t forks;          /* mu_forks() where it was opened: a child has no threads of DDS */
    bool spins;              /* in mu_process_spin, and so in handlers */
    bool runs;               /* in mu_process_run */
    struct mu_agent *agents; /* agents_max of them; one that has left keeps its place */
    uint32_t agents_max, agent_count;
    struct mu_table names;                 /* of agents */
    const struct mu_agent_kind *base_kind; /* of all agents that are of no other */
    uint32_t outbox_mails;                 /* of each agent */
    struct outbox_slot *outbox_slots;
    char *outbox_text;
    char *rules_text;    /* NULL: no bodies */
    char *note_text;     /* likewise */
    struct dedup *dedup; /* one for each agent */
    struct mu_list queues[QUEUES];
    struct roll roll;
    struct transfers transfers;
    struct probes probes;
    struct inbox inbox;
    struct members members;
    struct directory directory;
    uint64_t broker_incarnation; /* 0: none has answered yet */
    uint64_t heartbeat_ns;       /* when the last registrations went out, */
    uint64_t said_ns;            /* and the last Up */
    int64_t lockstep_step;       /* the newest one of this lock step, or of the last one */
    const muster_Sense *step;    /* a step that waits for its mail */
    void *step_kept;             /* its sample, for the reader when the next one comes */
    const muster_Delivery *mail; /* the first delivery of the inbox, in hand; NULL: none is */
    uint64_t step_wall_ns;       /* when the last step came */
    struct ack_delay ack_delay;  /* acknowledgements that wait for mail to go with */
    uint32_t leaving;            /* so many agents have begun to, and are to be seen out */
    uint64_t leaving_ns;         /* since when their last words are awaited; 0: they are not */
    uint64_t now_ns;             /* when the last spin began, or its wait was over */
    uint64_t works_ns;           /* since when the handlers of one step, or one delivery, run */
    char
        busy[MU_FIELD_MAX + 1]; /* that they have run for long, and since when; "": they have not */
    uint64_t busy_since_wall_ns; /* the same; 0: they have not */
    atomic_bool stopped;
    void (*round)(void *self); /* after each round of mu_process_run; NULL: none */
    void *round_self;
    void (*before_up)(void *self, enum process_up_due due, int64_t step); /* NULL: none */
    void *before_up_self;
    bool (*sees)(const void *self, int64_t step); /* process_see_first; NULL: nothing is awaited */
    const void *sees_self;
    muster_Up out;                /* the Up that is being put together */
    struct mu_agent **out_agents; /* whose acts are in it */
    muster_Act *acts;             /* agents_max, or PROCESS_UP_MAILS if that is more */
    muster_Ack *acks;             /* acks_max */
    struct mu_agent **out_ackers; /* whose they are */
    uint32_t acks_max, mails_max;
    muster_Mail *mails;
    struct mu_percept *bodies; /* MU_ROBOTS_MAX; NULL: it does not watch */
    bool fresh[PROCESS_ITEMS]; /* items of the Delivery in hand that are no duplicates */
};

/* process.c */

/** A process that has had a step expects the next one within this time. */
static const uint64_t PROCESS_STEP_PATIENCE_NS = 300000000;

/** @return whether the simulator's steps are for it */
static inline bool process_takes_steps(const mu_process *p)
{
    return p->role == PROCESS_BODY || p->role == PROCESS_WATCH;
}

/** @return whether a lock step is under way */
static inline bool process_in_lockstep(const mu_process *p)
{
    return p->steps == PROCESS_STEPPING || p->steps == PROCESS_LIVED;
}

/* process_states.c */

/** Applies an event.  @return false: the state refuses it; our own events abort then */
bool process_step_on(mu_process *p, enum process_step_event event);

/** Applies an event of our own. */
void process_up_on(mu_process *p, enum process_up_event event);

/** Takes all memory that a process needs for its agents; 0 stands for the usual number. */
void process_take_memory(mu_process *p, uint32_t agents, uint32_t outbox_mails);

/**
 * Has before called whenever the agents' actions or acknowledgements are about to go out: what is
 * on disk by then is never behind what others have heard.  It is called, too, when an earlier life
 * of the process died while its answer to that step was with the broker or the simulator alone: its
 * agents say again what they did.
 */
void process_before_up(mu_process *p,
                       void (*before)(void *self, enum process_up_due due, int64_t step),
                       void *self);

/** Holds each step of a lock step until its agents have seen how the one before it went: until
 * sees(self, that step).  Before the first one, -1, the process is not ready.  NULL: no more. */
void process_see_first(mu_process *p, bool (*sees)(const void *self, int64_t step),
                       const void *self);

/* process_look.c */

/** @return whether the agents have seen how that step went, if process_see_first holds them for it
 */
bool process_has_seen(const mu_process *p, int64_t step);

/** @return how many samples are worth waking up for */
uint64_t process_samples_wanted(const mu_process *p);

/** Handles a step or a Delivery, if one is there that may be.  @return whether one was handled */
bool process_handle_one(mu_process *p);

/* process_spin.c */

/** An agent that is gone leaves the white pages when the broker has its last mails and
 * acknowledgements: the broker takes no mail from an agent that has left, and the agent's next life
 * must not get the same mail again. @param closes  the whole process does, and waits for no more */
void process_see_out(mu_process *p, bool closes);

/** Handles all that has come, and sends all that is due. */
void process_turn(mu_process *p);

/**
 * For handlers that may take long: called now and then, it says in the white pages since when the
 * process has been busy, once that is half a second.  Sends nothing else, and waits for nothing.
 */
void process_work(mu_process *p);

/* agent.c */

/** Takes the broker's answer to a registration. */
void agent_verdict(struct mu_agent *a, const muster_Verdict *v);

/** @return whether mail or acknowledgements of it are still to go out, and can */
bool agent_has_last_words(const struct mu_agent *a);

/** Its mail went out, or was answered for. */
void agent_progress(struct mu_agent *a);

/**
 * Sends a mail of a recording with the number that it had; from now on all mails of this agent are
 * a recording's.  Numbers must grow.
 *
 * @return as mu_agent_send, MU_MALFORMED also of a number that was had; MU_BUSY: what it sent
 *         before has no answer yet, and must have one
 */
MU_MUST_USE mu_result agent_replay(struct mu_agent *a, uint64_t seq, const struct mu_mail *mail);

/** Applies a directive, or a mail of that word, to its life.  @param by  the sender */
void agent_live(struct mu_agent *a, enum life_event event, const char *by);

/** Carries out a directive, or hands it to the agent. */
void agent_directive(struct mu_agent *a, const muster_Parcel *item);

/** Hands a mail to the agent. */
void agent_mail(struct mu_agent *a, const muster_Parcel *item);

/** @return whether a mail is an answer, to which nothing is said unless it asks for that */
bool agent_mail_answers(const struct mu_mail *mail);

/** @return the agent of that name in this process, or NULL */
struct mu_agent *agent_find(mu_process *p, const char *name);

/* step.c */

/** Takes the items, receipts, verdicts and members of a delivery. */
void step_take_delivery(mu_process *p, const muster_Delivery *d, const muster_Sense *sense);

/**
 * Says again what an earlier life answered to a step.
 *
 * @param due  UP_AGAIN_FOR_SIMULATOR: the mail in hand is of the same step, and stays;
 *             UP_AGAIN_FOR_BROKER: it is of the step before, and is handed out
 */
void step_repeat(mu_process *p, enum process_up_due due);

/** Lets the agents live through one control step and answers the simulator. */
void step_live(mu_process *p, const muster_Sense *sense, const muster_Delivery *d);

/** The same without lock step: all the mail that is there belongs to the step. */
void step_live_freely(mu_process *p, const muster_Sense *sense);

/* step_up.c */

/** Asks the agents before an Up goes out. */
void step_announce(mu_process *p, enum process_up_due due, int64_t step);

/** Answers a step, to the simulator and to the broker. */
void step_answer(mu_process *p, int64_t step);

/** Sends an Up with nothing in it: the first sample of a writer can be late, so it is not a step's.
 */
void step_hello(mu_process *p);

/** Sends the mails that wait and the acknowledgements that are due, outside of lock step. */
void step_flush(mu_process *p);

/** Sends words about agents on their way, between the steps of a lock step. */
void step_say_transfers(mu_process *p);

/** Tries again to send an Up that the network refused.  @return whether none is pending */
bool step_retry(mu_process *p);

#endif
