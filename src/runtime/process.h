/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file process.h
 * What the parts of the runtime share: a process on the bus and the agents in it.
 */
#ifndef MUSTER_RUNTIME_PROCESS_H
#define MUSTER_RUNTIME_PROCESS_H

#include "bus/bus.h"
#include "muster/agent.h"
#include "runtime/members.h"
#include "runtime/outbox.h"
#include "runtime/taken.h"
#include "wire.h"

#include <stdatomic.h>

enum {
    PROCESS_UP_MAILS = 256,       /* mails in one Up */
    PROCESS_PARCELS = 16 * 1024,  /* parcels in one Delivery; more come again */
    PROCESS_UP_BYTES = 48 * 1024, /* of mail content in one Up, beside the first mail */
    PROCESS_RULES_MAX = 8 * 1024, /* names of fired rules, in bytes */
};

struct mu_agent {
    mu_process *process;
    char name[MU_NAME_MAX + 1];
    enum mu_kind kind;
    enum mu_state state;
    struct mu_handlers handlers;
    uint64_t incarnation;
    bool registered, refused;
    bool no_broadcasts;
    bool gone; /* has left */
    struct outbox outbox;
    uint64_t progress_ns;  /* wall: when the broker last answered for mail, or mail went out */
    uint64_t broker;       /* incarnation of the broker that answered last; 0: none has */
    uint64_t earlier_end;  /* mails below this number were there before that one came */
    bool in_order;         /* the box's numbers go on after last_number, without gaps */
    uint64_t last_number;  /* taken from the box */
    uint64_t acked_number; /* told the broker */
    uint64_t handed;       /* parcels that reached its handlers */
    bool drives;           /* this step */
    double forward_m_s, turn_rad_s;
    uint32_t firings; /* this step */
    char rules[PROCESS_RULES_MAX + 1];
    uint64_t repeats; /* mails that came again through another broker, and were dropped */
    struct taken taken;
};

struct mu_process {
    struct bus bus;
    char name[MU_PROCESS_MAX + 1]; /* also its partition */
    char host[MU_FIELD_MAX + 1];
    bool with_body;
    struct bus_writer registration, up;
    struct bus_reader delivery, sense;
    struct mu_agent *agents; /* MU_LOCAL_AGENTS_MAX of them */
    uint32_t agent_count;
    struct members members;
    uint64_t broker_incarnation; /* 0: none has answered yet */
    uint64_t heartbeat_ns;       /* when the last registrations went out */
    bool greeted;                /* the simulator's first Sense has come, which is no step */
    bool ready;                  /* all that lock step needs has matched */
    bool in_lockstep;
    bool lived_in_lockstep;      /* a step of it, at least */
    const muster_Sense *step;    /* a step that waits for its mail, on loan */
    const muster_Delivery *mail; /* a delivery not handled yet, on loan */
    uint64_t step_wall_ns;       /* when the last step came */
    bool done;                   /* the simulator has ended the run */
    atomic_bool stopped;
    /* The Up that is being put together; pending: refused by the network, to be tried again. */
    muster_Up out;
    bool out_pending;
    uint32_t out_mails[MU_LOCAL_AGENTS_MAX]; /* how many of each agent's mails are in it */
    muster_Act acts[MU_LOCAL_AGENTS_MAX];
    muster_Ack acks[MU_LOCAL_AGENTS_MAX];
    muster_Mail mails[PROCESS_UP_MAILS];
    bool fresh[PROCESS_PARCELS]; /* of the Delivery in hand: parcels that were not had before */
};

/* process.c */

/** Takes the next delivery, on loan, into p->mail; NULL: there is none. */
void process_next_delivery(mu_process *p);

/* agent.c */

/** Tells the broker of an agent's name and state. */
void agent_register(struct mu_agent *a);

/** Takes the broker's answer to a registration. */
void agent_verdict(struct mu_agent *a, const muster_Verdict *v);

/** Carries out a directive, or hands it to the agent. */
void agent_directive(struct mu_agent *a, const muster_Parcel *parcel);

/** Hands a mail to the agent. */
void agent_mail(struct mu_agent *a, const muster_Parcel *parcel);

/** @return the agent of that name in this process, or NULL */
struct mu_agent *agent_find(mu_process *p, const char *name);

/* step.c */

/** Takes the parcels, receipts, verdicts and members of a delivery. */
void step_take_delivery(mu_process *p, const muster_Delivery *d, const muster_Sense *sense);

/** Lets the agents live through one control step and answers the simulator. */
void step_live(mu_process *p, const muster_Sense *sense, const muster_Delivery *d);

/** The same without lock step: all the mail that is there belongs to the step. */
void step_live_freely(mu_process *p, const muster_Sense *sense);

/** Sends an Up with nothing in it: the first sample of a writer can be late, so it is not a step's.
 */
void step_hello(mu_process *p);

/** Sends the mails and acknowledgements that wait, outside of lock step. */
void step_flush(mu_process *p);

/** Tries again to send what the network refused.  @return whether nothing is pending any more */
bool step_retry(mu_process *p);

#endif
