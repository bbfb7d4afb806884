/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pairs.h
 * What each sender has in each box.
 *
 * A pair stands here as long as the sender has a post in the box, so that there are never more
 * pairs than posts.  They are found by a hash that keeps the pairs of one box close together:
 * little memory is touched while there are few.
 */
#ifndef MUSTER_BROKER_PAIRS_H
#define MUSTER_BROKER_PAIRS_H

#include "broker/share.h"
#include "core/table.h"

/* The queues of mail that waits, apart from directives: low, normal, high. */
enum { PAIR_QUEUES = 3 };

/* A list of posts, and what they take. */
struct post_queue {
    uint32_t head, tail, count, bytes;
};

struct pair {
    uint32_t box, sender;
    uint32_t next; /* with the same hash, or free */
    struct share_use use;
    struct post_queue waiting[PAIR_QUEUES]; /* the sender's part of the box's queues */
};

struct pairs {
    struct pair *pool; /* SHARE_POSTS_MAX of them */
    uint32_t used;     /* high-water mark */
    uint32_t free;
    uint32_t live;
    uint32_t *heads; /* of the lists of each hash: an index and one, or 0 */
    uint32_t mask;
};

void pairs_init(struct pairs *p);

/** @return the pair, or MU_NONE: the sender has nothing there */
uint32_t pairs_find(const struct pairs *p, uint32_t box, uint32_t sender);

/** Finds a pair or enters it. */
uint32_t pairs_get(struct pairs *p, uint32_t box, uint32_t sender);

/** Forgets a pair whose use is nothing. */
void pairs_drop(struct pairs *p, uint32_t pair);

#endif
