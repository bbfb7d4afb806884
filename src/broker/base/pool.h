/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pool.h
 * The pool of mails, whose share of it a mail takes, and the lists and heaps in which mails stand.
 */
#ifndef MUSTER_BROKER_POOL_H
#define MUSTER_BROKER_POOL_H

#include "core/list.h"
#include "muster/limits.h"
#include "muster/result.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

/** Places for names.  The broker itself stands first in the white pages, its parts after it
 * (metrics.h). */
enum {
    REGISTRY_BROKER = 0,
    REGISTRY_OWN = MU_BROKER_LINES,
    REGISTRY_ORDINARY = MU_AGENTS_MAX + REGISTRY_OWN,
    REGISTRY_KEPT = 64, /* places beyond, for commands that come when all others are taken */
    REGISTRY_MAX = REGISTRY_ORDINARY + REGISTRY_KEPT
};

/* --- quota.c --------------------------------------------------------------------------------- */

/*
 * A sender's fair share of what all of them use together.
 *
 * The rule is the dynamic threshold of A. K. Choudhury and E. L. Hahne, "Dynamic queue length
 * thresholds for shared-memory packet switches", IEEE/ACM Transactions on Networking 6(2), 1998,
 * with a factor of 1: a holder may hold as much as is left free.  So a lone sender
 * gets one half, two get a third each, and there is always room for one that has nothing yet.
 */

/* What a sender holds, or wants to. */
struct quota_use {
    uint32_t mails;
    uint32_t bytes; /* of the store */
    uint32_t posts; /* places in boxes */
};

enum quota_answer {
    QUOTA_FITS,
    QUOTA_FULL, /* all senders together leave no room */
    QUOTA_OVER  /* there may be room, but this sender has had its share */
};

/**
 * @param own    what the sender holds
 * @param all    what all hold together
 * @param want   what it wants besides
 * @param most   what all may hold together
 * @param floor  so much is within a sender's share whatever is free
 */
enum quota_answer quota_ask(const struct quota_use *own, const struct quota_use *all,
                            const struct quota_use *want, const struct quota_use *most,
                            const struct quota_use *floor);

static inline void quota_add(struct quota_use *use, const struct quota_use *more)
{
    use->mails += more->mails;
    use->bytes += more->bytes;
    use->posts += more->posts;
}

static inline void quota_subtract(struct quota_use *use, const struct quota_use *less)
{
    MU_ASSERT(use->mails >= less->mails && use->bytes >= less->bytes && use->posts >= less->posts);
    use->mails -= less->mails;
    use->bytes -= less->bytes;
    use->posts -= less->posts;
}

/* The store's accounts.  Those inside a run are apart: what others send by the wall clock does
 * not change what a sender in it may send. */
enum quota_side { QUOTA_OUTSIDE, QUOTA_INSIDE, QUOTA_SIDES };

/* What both sides can hold together: others may have filled the store when a run begins, and
 * that has its half all the same. */
enum {
    QUOTA_MAILS_MAX = MU_MAILS_MAX + MU_MAILS_MAX / 2,
    QUOTA_BYTES_MAX = MU_MAIL_BYTES_MAX + MU_MAIL_BYTES_MAX / 2,
    QUOTA_POSTS_MAX = MU_POSTS_MAX + MU_POSTS_MAX / 2
};

struct quota_accounts {
    struct quota_use senders[QUOTA_SIDES][REGISTRY_MAX];
    struct quota_use all[QUOTA_SIDES];
};

/* --- pool.c ---------------------------------------------------------------------------------- */

/*
 * The mails themselves: each is kept once, however many receivers it has.
 *
 * The memory, for mails that wait in boxes and for those that wait for the end of a step, is
 * cut into slabs; a slab holds records of one size class, from its
 * first use until the last of them goes.  Nothing is touched before it is needed, so that an idle
 * broker stays small.
 */

enum {
    POOL_SLAB_BYTES = 64 * 1024,
    POOL_SLABS = (QUOTA_BYTES_MAX + MU_STEP_BYTES_MAX) / POOL_SLAB_BYTES,
    POOL_CLASSES = 8,
    POOL_RECORD_MAX = 21824, /* bytes that the largest mail takes: three to a slab */
};

/* The two schedules that a mail may stand in; see timers.h. */
enum timers_kind { TIMERS_DUE, TIMERS_EXPIRY, TIMERS_KINDS };

/* What the sender of a mail was told of it: nothing, that it waits, or the last word.  It only
 * rises. */
enum mail_told { TOLD_NOTHING, TOLD_STORED, TOLD_LAST, TOLD_STATES };

/* The worst that became of a mail so far, over all its receivers: it only rises, too. */
enum mail_fate { FATE_TAKEN, FATE_PASSED_ON, FATE_EXPIRED, FATE_DROPPED, FATES };

/* Whether a mail has a row on disk, and whether the next commit is to write or change that. */
enum mail_durable {
    DURABLE_NOT,
    DURABLE_MARKED,
    DURABLE_WRITTEN,
    DURABLE_MARKED_AGAIN,
    DURABLE_STATES
};
enum mail_durable_event {
    DURABLE_MARKS,
    DURABLE_COMMITS,
    DURABLE_RESTORES,
    DURABLE_UNDOES,
    DURABLE_EVENTS
};

/* The lists that a mail may stand in at the same time: of what waits for the end of a step, or
 * later of what is to be written to disk; and of all that wait in boxes. */
enum mail_lists { MAIL_KEPT, MAIL_BOXED, MAIL_LISTS };

struct mail {
    muster_Mail letter; /* its strings lie behind this record */
    struct mail *prev[MAIL_LISTS], *next[MAIL_LISTS];
    struct mail *journal_same;    /* in a chain of durable mails whose names have one hash */
    uint64_t row;                 /* on disk; 0: it is not durable */
    uint64_t at_ns[TIMERS_KINDS]; /* of the run; of the broker's clock */
    uint32_t place[TIMERS_KINDS]; /* in the schedule's heap; MU_NONE: not there */
    uint64_t order;               /* in which mails were routed */
    uint32_t sender;              /* an index of the registry */
    uint32_t only;        /* its one receiver, by another broker's word; MU_NONE: as dst says */
    uint32_t kept_for;    /* the one that a step keeps it for; MU_NONE: for many, or unknown */
    uint32_t payer;       /* whose share it takes: the sender's, or the asker's */
    struct mu_list posts; /* its places in boxes: receivers that have neither acknowledged it nor
                             let it expire */
    uint32_t veiled;      /* of them, outside a run that the sender is in */
    uint32_t uses;        /* freed at 0 */
    uint32_t bytes;
    uint64_t came_ns;               /* into boxes, on the mail clock */
    struct quota_use booked;        /* on its sender's account */
    struct quota_use booked_veiled; /* for those outside, on its sender's account there */
    uint8_t size_class;             /* of the pool */
    uint8_t side;                   /* enum quota_side: the account on which it is booked */
    uint8_t answer;                 /* muster_Outcome: the last word, if its sender was told that */
    enum mail_told told : 8;
    enum mail_fate fate : 8;
    enum mail_durable durable : 8;
    bool tell_stored;    /* its sender is told that it is stored, once it is on disk */
    bool stored_ends_it; /* that is then the last word */
};

/* Mails that wait for one thing, in order; zeroed memory is an empty list of MAIL_KEPT. */
struct mail_list {
    struct mail *first, *last;
    uint32_t count;
    enum mail_lists kind;
};

struct pool_slab {
    struct mu_link link; /* in the list of its class's slabs with room */
    uint32_t size_class;
    uint32_t live;   /* records in use */
    uint32_t carved; /* records ever used since the class took it */
    void *free;      /* records given back */
};

struct pool {
    unsigned char *memory;
    struct pool_slab slabs[POOL_SLABS];
    struct mu_pool slabs_pool;
    struct mu_list open[POOL_CLASSES];
    uint32_t mails;
};

/* Bytes of a record of each class. */
extern const uint32_t pool_class_bytes[POOL_CLASSES];

void pool_init(struct pool *s);

/** Copies a mail that the border has let through, with one use.  @return NULL when full */
struct mail *pool_put(struct pool *s, const muster_Mail *letter);

/** @return the bytes of the store that a mail takes */
static inline uint32_t pool_bytes(const struct mail *m)
{
    return pool_class_bytes[m->size_class];
}

static inline void pool_keep(struct mail *m)
{
    m->uses++;
}

void pool_free(struct pool *s, struct mail *m);

/**
 * Goes through all mails that live.
 *
 * @param place  0 at first; moved on
 * @return the next one; NULL: there are no more
 */
struct mail *pool_each(const struct pool *s, uint32_t *place);

/** Ends one use; the last one frees the mail. */
static inline void pool_release(struct pool *s, struct mail *m)
{
    MU_ASSERT(m->uses > 0);
    if (--m->uses == 0) {
        pool_free(s, m);
    }
}

/** @return the text, for a member of a sample: idlc makes none const, and nothing is written there
 */
static inline char *sample_text(const char *text)
{
    return (char *)(uintptr_t)text;
}

/**
 * How it stands with a mail that a process still waits for, for the store.
 *
 * @return what its sender was told for good, or what it will be told; "" for nothing yet
 */
const char *pool_mail_standing(const struct mail *m);

/** The same of a mail that comes back from the store.  @return false: there is no such word */
bool pool_mail_go_on(struct mail *m, const char *word);

/** Puts a mail, which stands in no list of that kind, last into one. */
static inline void pool_list_append(struct mail_list *list, struct mail *m)
{
    m->prev[list->kind] = list->last;
    m->next[list->kind] = NULL;
    *(list->last ? &list->last->next[list->kind] : &list->first) = m;
    list->last = m;
    list->count++;
}

static inline void pool_list_remove(struct mail_list *list, struct mail *m)
{
    struct mail *prev = m->prev[list->kind], *next = m->next[list->kind];
    *(prev ? &prev->next[list->kind] : &list->first) = next;
    *(next ? &next->prev[list->kind] : &list->last) = prev;
    list->count--;
}

/** @return the first mail, which is taken out; NULL: there is none */
struct mail *pool_list_pop(struct mail_list *list);

/** Notes what the sender of a mail is told.  @return whether it is news */
static inline bool mail_tell(struct mail *m, enum mail_told told)
{
    bool is_news = told > m->told;
    if (is_news) {
        m->told = told;
    }
    return is_news;
}

/** Notes what became of a mail at one of its receivers. */
static inline void mail_meets(struct mail *m, enum mail_fate fate)
{
    if (fate > m->fate) {
        m->fate = fate;
    }
}

/** @return the outcome that the fate of a mail stands for, if all its receivers are through */
static inline muster_Outcome mail_outcome(const struct mail *m)
{
    static const muster_Outcome outcomes[FATES] = {[FATE_TAKEN] = muster_OUTCOME_DELIVERED,
                                                   [FATE_PASSED_ON] = muster_OUTCOME_STORED,
                                                   [FATE_EXPIRED] = muster_OUTCOME_EXPIRED,
                                                   [FATE_DROPPED] = muster_OUTCOME_DROPPED};
    return outcomes[m->fate];
}

/** @return whether the mail has a row on disk */
static inline bool mail_is_written(const struct mail *m)
{
    return m->durable >= DURABLE_WRITTEN;
}

/* --- timers.c -------------------------------------------------------------------------------- */

/* Mails in order of a time: when they are due, or when they expire. */

struct timers {
    struct mail *heap[QUOTA_MAILS_MAX]; /* a mail stands here once */
    uint32_t count;
    enum timers_kind kind;
};

/** Enters a mail for m->at_ns of this kind; equal times go by m->order. */
void timers_add(struct timers *s, struct mail *m);

void timers_take(struct timers *s, struct mail *m);

/** Takes a mail out, if it is in. */
static inline void timers_remove(struct timers *s, struct mail *m)
{
    if (m->place[s->kind] != MU_NONE) {
        timers_take(s, m);
    }
}

/** @return the earliest mail, or NULL */
static inline struct mail *timers_first(const struct timers *s)
{
    return s->count ? s->heap[0] : NULL;
}

#endif
