/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file resolve.h
 * Addresses SCHEME:REST that an agent resolves: the mail waits while that one is asked.
 *
 * Asked is the first agent in order of name that is there and offers the service `resolver` with
 * the attribute scheme=SCHEME; in a lock step, only members of it are asked.  The question is a
 * mail of the broker in layer 2:
 *
 *   resolve  "SCHEME:REST" SENDER  ->  inform   NAME NAME ...   who the mail is for
 *                                      failure                  the address makes no sense
 *
 * A failure, or no answer in time, is the outcome unknown-name.  Mails of a sender that come after
 * an address wait until it is resolved, so that they arrive in order; mail to the broker does not.
 */
#ifndef MUSTER_BROKER_RESOLVE_H
#define MUSTER_BROKER_RESOLVE_H

#include "broker/base/share.h"
#include "broker/base/store.h"

struct broker;

/* How long an answer may take: out of lock step, and in it. */
enum { RESOLVE_PATIENCE_MS = 1000, RESOLVE_PATIENCE_STEPS = 10 };

enum resolve_state {
    RESOLVE_FOLLOWS, /* its receivers are known, or nobody resolves them */
    RESOLVE_ASKED,
    RESOLVE_ANSWERED,
};

/* A mail that waits. */
struct resolve_wait {
    struct mail *mail;
    struct mail *answer;       /* kept; NULL: none, or a failure */
    uint32_t next;             /* of the same sender; also the free list */
    uint32_t asked_next, prev; /* of those that wait for an answer, in the order of asking */
    uint32_t resolver;         /* who is asked */
    uint8_t state;             /* enum resolve_state */
    uint64_t ticket;
    uint64_t since_ns, until_ns; /* mail clock */
};

struct resolve_queue {
    uint32_t first, last, count;
};

struct resolve {
    struct resolve_wait *waits; /* MU_RESOLVE_MAX for members of the lock step, and for others */
    uint32_t used, free;        /* high-water mark; list of those given back */
    uint32_t side_count[SHARE_SIDES];
    struct resolve_queue *queues; /* of each agent of the registry */
    uint32_t asked_first, asked_last;
    uint64_t soonest_ns;     /* no patience ends before this, mail clock */
    uint64_t tickets[2];     /* given for questions to others, to members of the lock step */
    uint32_t waiting;        /* mails */
    uint64_t asked, refused; /* questions; answers that nobody had asked for, or not any more */
};

void resolve_init(struct resolve *r, uint32_t agents);

/** @return whether there is somebody to ask about an address SCHEME:REST */
bool resolve_is_possible(const struct broker *b, const char *dst);

/* What is to be done with a mail that takes effect. */
enum resolve_need {
    RESOLVE_NOTHING, /* it need not wait */
    RESOLVE_WAIT,    /* its address is to be resolved, or it follows one that is */
    RESOLVE_FULL,    /* it would have to wait, and there is no room */
};

enum resolve_need resolve_needs(const struct broker *b, const struct mail *m);

/** Keeps a mail that has to wait, booked with one place, and asks if it is the one to resolve. */
void resolve_wait(struct broker *b, struct mail *m);

/** @return whether a mail to the broker is an answer, to be given to resolve_take_answer */
bool resolve_is_answer(const struct mail *m);

/*
 * Each of the next three ends one wait, and returns the sender whose mails the caller then takes by
 * resolve_next_ready; MU_NONE: no wait ended.
 */

/** Takes the answer of a resolver. */
uint32_t resolve_take_answer(struct broker *b, struct mail *m);

/** Ends a wait for an answer that is overdue.  @param mail_ns  the mail clock */
uint32_t resolve_overdue(struct broker *b, uint64_t mail_ns);

/** Ends a wait, because a lock step begins: no question from before has a place in it. */
uint32_t resolve_give_up(struct broker *b);

/**
 * Takes the next mail of a sender that need not wait any more.
 *
 * @param answer  the resolver's answer, which the caller releases; NULL: none
 * @return it, or NULL
 */
struct mail *resolve_next_ready(struct broker *b, uint32_t sender, struct mail **answer);

/** @return when resolve_overdue is needed next, mail clock; UINT64_MAX: never */
uint64_t resolve_deadline_mail_ns(const struct broker *b);

#endif
