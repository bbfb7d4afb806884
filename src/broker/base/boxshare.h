/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file boxshare.h
 * What each sender has in each box: a share for each pair of them.
 *
 * A pair stands here as long as the sender has a post in the box, so that there are never more
 * pairs than posts.  They are found by a hash that keeps the pairs of one box close together:
 * little memory is touched while there are few.
 */
#ifndef MUSTER_BROKER_BOXSHARE_H
#define MUSTER_BROKER_BOXSHARE_H

#include "broker/base/share.h"
#include "core/table.h"

/* The queues of mail that waits, apart from directives: low, normal, high. */
enum { BOXSHARE_QUEUES = 3 };

/* A list of posts, and what they take. */
struct post_queue {
    uint32_t head, tail, count, bytes;
};

struct boxshare {
    uint32_t box, sender;
    uint32_t next; /* with the same hash, or free */
    struct share_use use;
    struct post_queue waiting[BOXSHARE_QUEUES]; /* the sender's part of the box's queues */
};

struct boxshares {
    struct boxshare *pool; /* SHARE_POSTS_MAX of them */
    uint32_t used;         /* high-water mark */
    uint32_t free;
    uint32_t live;
    uint32_t *heads; /* of the lists of each hash: an index and one, or 0 */
    uint32_t mask;
};

void boxshare_init(struct boxshares *p);

/** @return the pair, or MU_NONE: the sender has nothing there */
uint32_t boxshare_find(const struct boxshares *p, uint32_t box, uint32_t sender);

/** Finds a pair or enters it. */
uint32_t boxshare_get(struct boxshares *p, uint32_t box, uint32_t sender);

/** Forgets a pair whose use is nothing. */
void boxshare_drop(struct boxshares *p, uint32_t pair);

#endif
