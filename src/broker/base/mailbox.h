/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mailbox.h
 * A box for each agent: what waits for it, what was handed out, and what it has acknowledged.
 *
 * A post is a mail's place in one box.  It waits in the urgent queue (directives) or in that of its
 * priority, is then handed out, which gives it the box's next number, and goes when it is
 * acknowledged.  A number that has gone out on the network stays with its mail for ever.
 *
 * A box has a limit in mails and bytes; boxroom.h says what happens at it.
 */
#ifndef MUSTER_BROKER_MAILBOX_H
#define MUSTER_BROKER_MAILBOX_H

#include "broker/base/boxshare.h"
#include "broker/base/store.h"
#include "muster/result.h"

/* Handed out beyond MU_WINDOW_MAX, and for directives alone: they reach an agent that has stopped
 * acknowledging its mail.  And so many have room in a box that other mail has filled. */
enum { MAILBOX_RESERVE = 8 };

/* What may be handed out just now. */
enum mailbox_gate { GATE_SHUT, GATE_URGENT, GATE_OPEN };

enum post_list { POST_HELD, POST_LOW, POST_NORMAL, POST_HIGH, POST_URGENT, POST_FLIGHT };

/* The lists that a post stands in at the same time. */
enum post_links { LINKS_BOX, LINKS_PAIR, LINKS };

struct post_link {
    uint32_t next, prev;
};

struct post {
    struct mail *mail;
    struct post_link links[LINKS]; /* in its list of the box, also the free list; in the pair's */
    uint32_t sibling_next, sibling_prev; /* posts of the same mail */
    uint32_t agent;
    uint32_t pair; /* of box and sender */
    uint8_t list;  /* enum post_list */
    bool sent;     /* has gone out on the network */
    bool veiled;   /* see struct mail */
};

/* What a box may hold, and what happens when it is full. */
struct box_limits {
    muster_BoxPolicy policy;
    uint32_t mails, bytes;
};

struct box {
    bool begun;
    bool watched; /* in the list of boxes that wait for an acknowledgement */
    struct post_queue lists[POST_FLIGHT + 1]; /* POST_HELD: its count alone */
    uint64_t acked;                           /* the number before the first one in flight */
    uint32_t out;     /* the first in flight that is to go out (again); or MU_NONE */
    uint32_t written; /* how many in flight stand before it */
    uint64_t progress_ns;
    uint32_t unsaved;         /* mails of the store, acknowledged since */
    uint64_t unsaved_commits; /* so many commits had been made; see journal_room */
    uint32_t watch_next, watch_prev;
    struct share_use use;     /* waiting, held and in flight */
    struct box_limits limits; /* 0: the broker's */
};

struct mailbox {
    struct post *posts;  /* SHARE_POSTS_MAX of them */
    uint32_t posts_used; /* high-water mark */
    uint32_t posts_free;
    uint32_t posts_live;
    uint64_t base;                   /* every box counts from here */
    struct box *boxes;               /* one for each agent of the registry */
    uint32_t watch_head, watch_tail; /* the box without progress for longest is the head */
    struct boxshares shares;
    struct box_limits limits; /* of boxes that have none of their own */
};

void mailbox_init(struct mailbox *m, uint32_t agents);

/** @return the box of an agent; it begins if it has not, which is for who puts mail into it alone:
 *          another broker is told where (presence_tell_number) */
struct box *mailbox_box(struct mailbox *m, uint32_t agent);

/** @return whether the agent's box was ever used: memory of others stays untouched */
bool mailbox_is_begun(const struct mailbox *m, uint32_t agent);

/**
 * Sets the limits of all boxes that have none of their own.
 *
 * @param mails  at most MU_BOX_MAX; 0: that many
 * @param bytes  at most MU_BOX_BYTES_MAX; 0: that many
 */
void mailbox_set_defaults(struct mailbox *m, muster_BoxPolicy policy, uint32_t mails,
                          uint32_t bytes);

/**
 * Sets the limits of one box; what is in it already stays.
 *
 * @param policy  BOX_REFUSE_NEW: the broker's default
 * @param mails   0: the broker's default
 * @param bytes   0: the broker's default
 */
void mailbox_set_limits(struct mailbox *m, uint32_t agent, muster_BoxPolicy policy, uint32_t mails,
                        uint32_t bytes);

/** @return the limits of a box, its own or the broker's */
struct box_limits mailbox_limits(const struct mailbox *m, const struct box *box);

/** @return the queue in which a mail waits */
enum post_list mailbox_queue(const struct mail *mail);

/** @return the post behind this one in its list of the box, or MU_NONE */
uint32_t mailbox_next(const struct mailbox *m, uint32_t post);

/**
 * Puts a mail into a box, or holds it until mailbox_admit, whatever the box's limits say.
 *
 * @return MU_OK, or MU_FULL: there are no more posts
 */
mu_result mailbox_put(struct mailbox *m, uint32_t agent, struct mail *mail, bool held);

/** The post that a mail was given last is for one outside the lock step that its sender is in. */
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

/**
 * The next count posts from box->out on have gone out.
 *
 * @return how many of them not for the first time
 */
uint32_t mailbox_mark_written(struct mailbox *m, uint32_t agent, uint32_t count);

/** Everything in flight is to go out again. */
void mailbox_repeat(struct mailbox *m, uint32_t agent);

/** @return whether the receiver can have had this number */
bool mailbox_number_valid(const struct mailbox *m, uint32_t agent, uint64_t number);

/** @return the highest number that was handed out, or the one before the first */
uint64_t mailbox_last_number(const struct mailbox *m, uint32_t agent);

/** Takes out the oldest post in flight, as acknowledged.  @return its mail */
struct mail *mailbox_pop(struct mailbox *m, uint32_t agent);

/** The box has made progress now, or is to be watched from now on, if anything is in flight. */
void mailbox_watch(struct mailbox *m, uint32_t agent, uint64_t now_ns);
void mailbox_unwatch(struct mailbox *m, uint32_t agent);

#endif
