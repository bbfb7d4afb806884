/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file share.h
 * A sender's fair share of what all of them use together.
 *
 * The rule is the dynamic threshold of A. K. Choudhury and E. L. Hahne, "Dynamic queue length
 * thresholds for shared-memory packet switches", IEEE/ACM Transactions on Networking 6(2), 1998,
 * with a factor of 1: whoever holds something may hold as much as is left free.  So a lone sender
 * gets one half, two get a third each, and there is always room for one who has nothing yet.
 */
#ifndef MUSTER_BROKER_SHARE_H
#define MUSTER_BROKER_SHARE_H

#include "muster/limits.h"

#include <stdbool.h>
#include <stdint.h>

/* What somebody holds, or wants to. */
struct share_use {
    uint32_t mails;
    uint32_t bytes; /* of the store */
    uint32_t posts; /* places in boxes */
};

enum share_answer {
    SHARE_FITS,
    SHARE_FULL, /* all senders together leave no room */
    SHARE_OVER  /* there may be room, but this sender has had its share */
};

/**
 * @param own    what the sender holds
 * @param all    what all hold together
 * @param want   what it wants besides
 * @param most   what all may hold together
 * @param floor  so much is within a sender's share whatever is free
 */
enum share_answer share_ask(const struct share_use *own, const struct share_use *all,
                            const struct share_use *want, const struct share_use *most,
                            const struct share_use *floor);

void share_add(struct share_use *use, const struct share_use *more);
void share_subtract(struct share_use *use, const struct share_use *less);

/* The store's accounts.  Those of the lock step are apart: what others send by the wall clock does
 * not change what a sender in it may send. */
enum share_side { SHARE_OUTSIDE, SHARE_LOCKSTEP, SHARE_SIDES };

/* What both sides can hold together: others may have filled the store when a lock step begins, and
 * that has its half all the same. */
enum {
    SHARE_MAILS_MAX = MU_MAILS_MAX + MU_MAILS_MAX / 2,
    SHARE_BYTES_MAX = MU_MAIL_BYTES_MAX + MU_MAIL_BYTES_MAX / 2,
    SHARE_POSTS_MAX = MU_POSTS_MAX + MU_POSTS_MAX / 2
};

struct share_accounts {
    struct share_use *senders[SHARE_SIDES]; /* one for each agent of the registry */
    struct share_use all[SHARE_SIDES];
};

void share_init(struct share_accounts *a, uint32_t agents);

/**
 * Books a mail on its sender's account, if that may be.
 *
 * @param halved  both sides are in use, and have one half of the store each: the lock step never
 * has more
 * @param urgent  a directive: it has no share, and a reserve that no other mail can take
 */
enum share_answer share_book(struct share_accounts *a, enum share_side side, uint32_t sender,
                             const struct share_use *want, bool halved, bool urgent);

/**
 * Books a mail that had its room in an earlier life, on whichever account has room for it.
 *
 * @param side  out: that account
 * @return false: neither has
 */
bool share_restore(struct share_accounts *a, enum share_side *side, uint32_t sender,
                   const struct share_use *want);

/** Takes back some of what was booked. */
void share_unbook(struct share_accounts *a, enum share_side side, uint32_t sender,
                  const struct share_use *less);

#endif
