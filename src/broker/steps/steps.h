/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file steps.h
 * A run that goes in lock step: what is collected of a step before it takes effect, and the rules
 * that keep it apart from everything else.
 */
#ifndef MUSTER_BROKER_STEPS_H
#define MUSTER_BROKER_STEPS_H

#include "broker/steps/scope.h"

/* --- role.c ---------------------------------------------------------------------------------- */

/* What a process is to a run that goes by steps; _OWED: the Delivery of the last step has not gone
 * out to it. */
enum role {
    ROLE_OUTSIDE,
    ROLE_SIMULATOR,
    ROLE_SIMULATOR_OWED,
    ROLE_AWAITED, /* a member: its answer to the step is to come */
    ROLE_AWAITED_OWED,
    ROLE_ANSWERED,
    ROLE_ANSWERED_OWED,
    ROLES
};

enum role_event {
    ROLE_JOINS,
    ROLE_SIMULATES,
    ROLE_ANSWERS,
    ROLE_STEP_ENDS,
    ROLE_IS_OWED,
    ROLE_IS_TOLD,
    ROLE_LEAVES,
    ROLE_EVENTS
};

/** @return the next role, or ROLES: the event is illegal */
enum role role_next(enum role role, enum role_event event);

/** @return the scope of a process with that role */
static inline enum scope role_scope(enum role role)
{
    static const enum scope scopes[ROLES] = {
        [ROLE_OUTSIDE] = SCOPE_OPEN,          [ROLE_SIMULATOR] = SCOPE_BESIDE,
        [ROLE_SIMULATOR_OWED] = SCOPE_BESIDE, [ROLE_AWAITED] = SCOPE_RUN,
        [ROLE_AWAITED_OWED] = SCOPE_RUN,      [ROLE_ANSWERED] = SCOPE_RUN,
        [ROLE_ANSWERED_OWED] = SCOPE_RUN};
    return scopes[role];
}

/* --- barrier.c ------------------------------------------------------------------------------- */

/*
 * The step barrier: what the processes of the roster do in a step is collected, and takes effect
 * in one fixed order when the last of them has answered, whatever the order of arrival.
 *
 * The order: mails of a recording come in, acknowledgements, expiry of mail and leases, states,
 * mails by (src, seq), mails from outside by (src, seq), addresses that were not resolved in time,
 * mails that have become due. Only which mails from outside have arrived by then depends on the
 * clock, and the simulator is told which.
 */

/* Mails from outside that take effect in one step; the others wait for the next one. */
enum { STEPS_OUTSIDE_MAX = 1024 };

/* Of the mails that wait for the end of a step, in bytes of the store, those from outside. */
enum { STEPS_OUTSIDE_BYTES = MU_STEP_BYTES_MAX / 4 };

/* What is collected of one agent. */
struct turn {
    struct mail_list mails;   /* in order of seq */
    struct mail_list outside; /* likewise: mails that did not come with an answer to the step */
    struct quota_use outside_use;
    uint32_t many;    /* among the mails from outside: those that are not for one name */
    uint32_t awaited; /* mails from outside for it alone, */
    uint32_t relayed; /* and those of them that another broker still has on disk */
    bool active;      /* in the list of agents with something collected */
    bool has_ack, has_state;
    uint64_t ack;
    muster_State state;
};

struct member {
    enum role role;
    int64_t step_had; /* the step of its last Delivery in this run */
};

struct steps {
    struct member members[MU_PROCESSES_MAX]; /* one for each process */
    bool held;          /* the step does not end: a process of the roster is to come yet */
    bool awaits_moves;  /* the last step has no end yet: agents are on their way */
    int64_t step;       /* whose Ups are collected */
    uint32_t simulator; /* its process */
    uint32_t roster[MU_PROCESSES_MAX];
    uint32_t roster_count;
    uint32_t answered;
    uint64_t start_version; /* of the white pages when it began */
    uint64_t version;       /* of the white pages, when the last step ended */
    struct turn turns[REGISTRY_MAX];
    uint32_t active[REGISTRY_MAX]; /* agents with something collected */
    uint32_t active_count;
    struct quota_use outside_use; /* of mails from outside, until they take effect */
    uint32_t turn_bytes;          /* what the Up that is being taken may still bring */
    /* Mails from outside that took effect, in order, until the simulator has been told. */
    struct mail *told[STEPS_OUTSIDE_MAX];
    uint32_t told_count;
    muster_LockstepEnd end;    /* of the last lock step */
    muster_LockstepEnd so_far; /* as of the last step of this one */
};

/** Something happens to a process that has to do with the run; our own code aborts if it cannot. */
void steps_role_on(struct broker *b, uint32_t place, enum role_event event);

/** Gives the agents of a process their scopes anew. */
void steps_mark_residents(struct broker *b, uint32_t place);

/** An agent has come to a process, has left it, or is of another kind now. */
void steps_rescope(struct broker *b, uint32_t agent);

/* When what an Up says takes effect: STEPS_INSIDE, as an answer to the step; STEPS_OUTSIDE, with
 * it; STEPS_REPLAY, with the step that a recording says. */
enum steps_effect { STEPS_NOW, STEPS_INSIDE, STEPS_OUTSIDE, STEPS_REPLAY, STEPS_IGNORED };

static inline enum steps_effect steps_effect(const struct steps *l, uint32_t place, int64_t step)
{
    enum role role = l->members[place].role;
    if (!scope_is_inside(role_scope(role))) {
        return STEPS_NOW;
    }
    if (step == muster_STEP_NOW) {
        return STEPS_OUTSIDE;
    }
    bool awaited = role == ROLE_AWAITED || role == ROLE_AWAITED_OWED;
    return awaited && step == l->step ? STEPS_INSIDE : STEPS_IGNORED;
}

/** An Up begins: what it may bring depends on the roster alone, not on what came before it. */
static inline void steps_open_turn(struct steps *l)
{
    uint32_t all = MU_STEP_BYTES_MAX - STEPS_OUTSIDE_BYTES;
    uint32_t each = all / (l->roster_count > 0 ? l->roster_count : 1);
    l->turn_bytes = each > POOL_RECORD_MAX ? each : POOL_RECORD_MAX;
}

/**
 * Keeps an admitted mail for the end of the step; what the store has room for is decided then.
 *
 * @return false: it does not fit into its process's part of MU_STEP_BYTES_MAX, or, from outside,
 *         into its sender's share of a quarter of that
 */
bool steps_keep(struct broker *b, struct mail *m, bool from_outside);

void steps_keep_ack(struct steps *l, uint32_t agent, uint64_t number);
void steps_keep_state(struct steps *l, uint32_t agent, muster_State state);

/**
 * @return whether mail of the same sender waits here that a mail to that agent must not overtake:
 *         it is for many, or for that agent, which may have left the lock step since; or this one
 *         is for the disk, which is to have what was sent before
 */
bool steps_keeps_before(const struct broker *b, const struct mail *m, uint32_t receiver);

/** No agent is on its way any more: the step that was held ends. */
void steps_release(struct broker *b);

/* What a process may be told in its next Delivery. */
struct steps_view {
    enum scope scope;         /* of the process */
    int64_t step;             /* that the Delivery ends, or muster_STEP_NOW */
    uint64_t version;         /* it is told the white pages up to this one, */
    uint64_t start_version;   /* and what has not changed since this one like everybody */
    uint64_t round_ns;        /* the delivery interval, in whole steps */
    uint32_t told_count;      /* mails from outside of which the simulator is told, */
    struct mail *const *told; /* and those */
    bool is_round;            /* ordinary mail may go out */
};

/**
 * What a process that goes by steps may be told.
 *
 * @param interval_ns  between two rounds of ordinary mail; 0: there is always one
 * @param view         out: valid until the next step ends
 * @return false: it has had the Delivery of the last step
 */
bool steps_view(const struct broker *b, uint32_t place, uint64_t interval_ns,
                struct steps_view *view);

/** A process that goes by steps has its Delivery. */
void steps_delivered(struct broker *b, uint32_t place);

/** Releases the mails from outside of which the simulator has been told, or is to be told no more.
 */
void steps_told(struct broker *b);

void steps_owe_delivery(struct broker *b, uint32_t place);

/** Counts a mail from outside that is kept, or is kept no longer. */
void steps_count_outside(struct steps *l, const struct mail *m, bool kept);

#endif
