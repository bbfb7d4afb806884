/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mailbox.h
 * The boxes in which mails wait for their receivers, and what their senders are told of them.
 */
#ifndef MUSTER_BROKER_MAILBOX_H
#define MUSTER_BROKER_MAILBOX_H

#include "broker/base/pool.h"

/* --- mailbox.c ------------------------------------------------------------------------------- */

/*
 * What each sender has in each box: a quota for each pair of them.
 *
 * A pair stands here as long as the sender has a post in the box, so that there are never more
 * pairs than posts.  They are found by a hash that keeps the pairs of one box close together:
 * little memory is touched while there are few.
 */

/* The queues of mail that waits, apart from directives: low, normal, high. */
enum { MAILBOX_QUOTA_QUEUES = 3 };

/* A list of posts, and what they take. */
struct post_queue {
    struct mu_list posts;
    uint32_t bytes;
};

struct mailbox_quota {
    uint32_t box, sender;
    uint32_t next; /* with the same hash */
    struct quota_use use;
    struct post_queue waiting[MAILBOX_QUOTA_QUEUES]; /* the sender's part of the box's queues */
};

struct mailbox_quotas {
    struct mailbox_quota *at; /* QUOTA_POSTS_MAX of them */
    struct mu_pool pool;
    uint32_t heads[MU_POSTS_MAX]; /* of the lists of each hash: an index and one, or 0 */
};

/* Fibonacci hashing scatters the boxes; neighbours among the senders stay neighbours. */
static inline uint32_t *mailbox_quota_head(struct mailbox_quotas *p, uint32_t box, uint32_t sender)
{
    return &p->heads[(box * 2654435769u ^ sender) % MU_POSTS_MAX];
}

/** @return the pair, or MU_NONE: the sender has nothing there */
static inline uint32_t mailbox_quota_find(struct mailbox_quotas *p, uint32_t box, uint32_t sender)
{
    uint32_t next = *mailbox_quota_head(p, box, sender);
    while (next != 0 && (p->at[next - 1].box != box || p->at[next - 1].sender != sender)) {
        next = p->at[next - 1].next;
    }
    return next != 0 ? next - 1 : MU_NONE;
}

/*
 * A box for each agent: what waits for it, what was handed out, and what it has acknowledged.
 *
 * A post is a mail's place in one box.  It waits in the urgent queue (directives) or in that of its
 * priority, is then handed out, which gives it the box's next number, and goes when it is
 * acknowledged.  A number that has gone out on the network stays with its mail for ever.
 *
 * A box has a limit in mails and bytes; mailbox_room.h says what happens at it.
 */

/* Handed out beyond MU_WINDOW_MAX, and for directives alone: they reach an agent that has stopped
 * acknowledging its mail.  And so many have room in a box that other mail has filled. */
enum { MAILBOX_RESERVE = 8 };

/* What may be handed out just now. */
enum mailbox_gate { GATE_SHUT, GATE_URGENT, GATE_OPEN };

enum post_list { POST_HELD, POST_LOW, POST_NORMAL, POST_HIGH, POST_URGENT, POST_FLIGHT };

/* The lists that a post stands in at the same time. */
enum post_links { LINKS_BOX, LINKS_PAIR, LINKS_MAIL, LINKS };

struct post {
    struct mail *mail;
    struct mu_link
        links[LINKS]; /* in its list of the box, that of the pair, and of its mail's posts */
    uint32_t agent;
    uint32_t pair; /* of box and sender */
    uint8_t list;  /* enum post_list */
    bool sent;     /* has gone out on the network */
    bool veiled;   /* see struct mail */
};

/* What a box may hold, and what happens when it is full; of one box, BOX_REFUSE_NEW and 0 are the
 * broker's defaults. */
struct box_limits {
    muster_BoxPolicy policy;
    uint32_t mails, bytes;
};

struct box {
    bool begun; /* it was ever used: memory of others stays untouched */
    struct post_queue lists[POST_FLIGHT + 1]; /* POST_HELD: its count alone */
    uint64_t base;                            /* the number before the first one of all, */
    uint64_t acked;                           /* and before the first one in flight */
    uint32_t out;     /* the first in flight that is to go out (again); or MU_NONE */
    uint32_t written; /* how many in flight stand before it */
    uint64_t progress_ns;
    uint32_t unsaved;         /* mails of the store, acknowledged since */
    uint64_t unsaved_commits; /* so many commits had been made; see journal_room */
    struct mu_link watch;     /* of the boxes that wait for an acknowledgement */
    struct quota_use use;     /* waiting, held and in flight */
    struct box_limits limits; /* 0: the broker's */
};

struct mailbox {
    struct post *posts; /* QUOTA_POSTS_MAX of them */
    struct mu_pool posts_pool;
    uint64_t base; /* every box counts from here */
    struct box boxes[REGISTRY_MAX];
    struct mu_list watched; /* those that wait for an acknowledgement; the one without progress for
                               longest is the first */
    struct mailbox_quotas quotas;
    struct box_limits limits; /* of boxes that have none of their own */
};

void mailbox_init(struct mailbox *m);

/** @return the box of an agent; it begins if it has not, which is only for code that puts mail into
 * it: another broker is told where (names_tell_number) */
static inline struct box *mailbox_box(struct mailbox *m, uint32_t agent)
{
    struct box *box = &m->boxes[agent];
    if (!box->begun) {
        *box = (struct box){.begun = true, .base = m->base, .acked = m->base, .out = MU_NONE};
    }
    return box;
}

/** An agent's name ends, whose box is empty.  Boxes that begin later count from beyond its numbers:
 * a receiver that comes back drops none of them as had. */
void mailbox_end(struct mailbox *m, uint32_t agent);

/** @return what is wanted, or what holds otherwise, and at most the most */
static inline uint32_t mailbox_limit(uint32_t wanted, uint32_t otherwise, uint32_t most)
{
    uint32_t limit = wanted ? wanted : otherwise;
    return limit > 0 && limit < most ? limit : most;
}

/** @return the limits of a box, its own or the broker's */
static inline struct box_limits mailbox_limits(const struct mailbox *m, const struct box *box)
{
    struct box_limits own = box->limits;
    return (struct box_limits){
        .policy = own.policy != muster_BOX_REFUSE_NEW ? own.policy : m->limits.policy,
        .mails = mailbox_limit(own.mails, m->limits.mails, MU_BOX_MAX),
        .bytes = mailbox_limit(own.bytes, m->limits.bytes, MU_BOX_BYTES_MAX)};
}

/** @return the queue in which a mail waits */
enum post_list mailbox_queue(const struct mail *mail);

/** @return the post behind this one in its list of the box, or MU_NONE */
static inline uint32_t mailbox_next(const struct mailbox *m, uint32_t post)
{
    return mu_list_next(MU_LINKS(m->posts, links[LINKS_BOX]), post);
}

/** @return the next post of the same mail, or MU_NONE */
static inline uint32_t mailbox_sibling(const struct mailbox *m, uint32_t post)
{
    return mu_list_next(MU_LINKS(m->posts, links[LINKS_MAIL]), post);
}

/**
 * Puts a mail into a box, or holds it until mailbox_admit, whatever the box's limits say.
 *
 * @return MU_OK, or MU_FULL: there are no more posts
 */
mu_result mailbox_put(struct mailbox *m, uint32_t agent, struct mail *mail, bool held);

/** The post that a mail was given last is for one outside the run that its sender is in. */
void mailbox_veil(struct mailbox *m, struct mail *mail);

/** A held post may be handed out from now on. */
void mailbox_admit(struct mailbox *m, uint32_t post);

/** Takes a post out that is not in flight; its mail remains. */
void mailbox_withdraw(struct mailbox *m, uint32_t post);

/**
 * Hands out as much as the gate and the window allow.
 *
 * @param written  so many mails that are on disk at most; those behind them wait, too
 */
void mailbox_hand_out(struct mailbox *m, uint32_t agent, enum mailbox_gate gate, uint32_t written);

/** @return whether this mail is what would be handed out next, if the gate is open */
bool mailbox_next_is(struct mailbox *m, uint32_t agent, const struct mail *mail);

/** Hands out that mail alone. */
void mailbox_hand_next(struct mailbox *m, uint32_t agent, const struct mail *mail);

/** Takes back what was handed out but has never gone out. */
void mailbox_take_back(struct mailbox *m, uint32_t agent);

#define MAILBOX_UNWATCHED UINT64_MAX

/**
 * The next count posts from box->out on have gone out; the others that were handed out have not,
 * and are taken back.
 *
 * @param watch_ns  from now on their acknowledgement is awaited; MAILBOX_UNWATCHED: it is not
 * @return how many of them not for the first time
 */
uint32_t mailbox_mark_written(struct mailbox *m, uint32_t agent, uint32_t count, uint64_t watch_ns);

/** Everything in flight is to go out again. */
void mailbox_repeat(struct mailbox *m, uint32_t agent);

/** @return the highest number that was handed out, or the one before the first */
static inline uint64_t mailbox_last_number(const struct mailbox *m, uint32_t agent)
{
    const struct box *box = &m->boxes[agent];
    return box->begun ? box->acked + box->lists[POST_FLIGHT].posts.count : m->base;
}

/** Takes out the oldest post in flight, as acknowledged.  @return its mail */
struct mail *mailbox_pop(struct mailbox *m, uint32_t agent);

/** The box has made progress now, or is to be watched from now on, if anything is in flight. */
void mailbox_watch(struct mailbox *m, uint32_t agent, uint64_t now_ns);
void mailbox_unwatch(struct mailbox *m, uint32_t agent);

/* --- room in a box, in quota.c ---------------------------------------------------------------- */

/*
 * Whether a box has room for a mail, and what has to go if not.
 *
 * A sender has a fair share of each box (quota.h).  Where the box drops mail when it is full,
 * a sender over its share makes room with its own mail, so that a flood costs other senders
 * nothing; only a box that is full of fair shares drops the mail of others.
 *
 * Only ordinary mail that waits is dropped: never what is in flight, held for a time, or a
 * directive.
 */

enum mailbox_room {
    MAILBOX_ROOM_FITS,
    MAILBOX_ROOM_DROP, /* another mail has to go first; then ask again */
    MAILBOX_ROOM_FULL,
    MAILBOX_ROOM_OVER_QUOTA
};

/**
 * Says whether a mail may be put into a box.
 *
 * @param victim  out, with MAILBOX_ROOM_DROP: the post that has to go
 */
enum mailbox_room quota_box_ask(struct mailbox *m, uint32_t agent, const struct mail *mail,
                                uint32_t *victim);

/* --- receipts.c ------------------------------------------------------------------------------ */

/* What senders are still to be told of their mails. */

/* Receipts that wait for one sender; a sender is bound to have fewer mails unanswered. */
enum { RECEIPTS_EACH_MAX = 2 * MU_OUTBOX_MAX };

struct receipt {
    uint64_t first_seq, last_seq;
    muster_Outcome result;
    struct mu_link link;
};

struct receipts {
    struct receipt at[MU_MAILS_MAX];
    struct mu_pool pool;
    struct mu_list queues[REGISTRY_MAX];
    uint32_t told[REGISTRY_MAX]; /* so many of its oldest are out, and may have to go again */
    uint64_t lost;               /* receipts that were not told, for want of room */
};

/**
 * Adds an outcome; it joins the sender's last one if that is its neighbour and the same.
 *
 * Where there is no room a receipt is lost, and counted: the sender's oldest, or this one. A sender
 * that waits for it sends its mail again, and is told then.
 */
void receipts_add(struct receipts *r, uint32_t agent, uint64_t first_seq, uint64_t last_seq,
                  muster_Outcome result);

/** @return how many receipts wait for an agent */
static inline uint32_t receipts_count(const struct receipts *r, uint32_t agent)
{
    return r->queues[agent].count;
}

/** @return of how many mails, at least */
static inline uint64_t receipts_mails(const struct receipts *r, uint32_t agent)
{
    const struct mu_list *q = &r->queues[agent];
    const struct receipt *last = q->count > 0 ? &r->at[mu_list_last(q)] : NULL;
    return last ? q->count + (last->last_seq - last->first_seq) : 0;
}

/** Removes the oldest count receipts of an agent. */
void receipts_drop(struct receipts *r, uint32_t agent, uint32_t count);

#endif
