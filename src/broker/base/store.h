/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file store.h
 * The mails themselves: each is kept once, however many receivers it has.
 *
 * The memory, for mails that wait in boxes and for those that wait for the end of a lock step, is
 * cut into slabs; a slab holds records of one size class, from its
 * first use until the last of them goes.  Nothing is touched before it is needed, so that an idle
 * broker stays small.
 */
#ifndef MUSTER_BROKER_STORE_H
#define MUSTER_BROKER_STORE_H

#include "broker/base/share.h"
#include "core/table.h"
#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STORE_SLAB_BYTES = 64 * 1024,
    STORE_SLABS = (SHARE_BYTES_MAX + MU_STEP_BYTES_MAX) / STORE_SLAB_BYTES,
    STORE_CLASSES = 8,
    STORE_RECORD_MAX = 21824, /* bytes that the largest mail takes: three to a slab */
};

/* The two schedules that a mail may stand in; see schedule.h. */
enum schedule_kind { SCHEDULE_DUE, SCHEDULE_EXPIRY, SCHEDULE_KINDS };

struct mail {
    muster_Mail letter;             /* its strings lie behind this record */
    struct mail *next;              /* in a list of mails that wait for the end of a step */
    struct mail *journal_next;      /* in the list of what is to be written to disk */
    struct mail *journal_same;      /* in a chain of durable mails whose names have one hash */
    uint64_t row;                   /* on disk; 0: it is not durable */
    uint64_t at_ns[SCHEDULE_KINDS]; /* of the run; of the broker's clock */
    uint32_t place[SCHEDULE_KINDS]; /* in the schedule's heap; MU_NONE: not there */
    uint64_t order;                 /* in which mails were routed */
    uint32_t sender;                /* an index of the registry */
    uint32_t only;      /* its one receiver, by another broker's word; MU_NONE: as dst says */
    uint32_t kept_for;  /* the one that a lock step keeps it for; MU_NONE: for many, or unknown */
    uint32_t payer;     /* whose share it takes: the sender's, or who asked for it */
    uint32_t posts;     /* the first of its places in boxes; MU_NONE: none */
    uint32_t unsettled; /* receivers that have neither acknowledged it nor let it expire */
    uint32_t veiled;    /* of them, outside a lock step that the sender is in */
    uint32_t uses;      /* freed at 0 */
    uint32_t bytes;
    uint32_t size_class;
    struct mail *older, *newer;     /* of those that wait in boxes; see ages.h */
    uint64_t came_ns;               /* on the mail clock */
    struct share_use booked;        /* on its sender's account */
    struct share_use booked_veiled; /* for those outside, on its sender's account there */
    uint8_t side;                   /* enum share_side: the account on which it is booked */
    uint8_t answer;                 /* muster_Outcome: */
    bool answered;                  /* the last receipt for it is out */
    bool journal_listed;            /* in the journal's list */
    bool journal_written;           /* its row is on disk */
    bool tell_stored;               /* when it is: the sender is told */
    bool stored_ends_it;            /* who sent it is told no more than that */
    bool stored_told;               /* the sender has been told that it waits */
    bool passed_on;                 /* another broker has taken it over for one receiver at least */
    bool expired;                   /* for one receiver at least */
    bool dropped;                   /* likewise */
};

struct store_slab {
    uint32_t next, prev; /* in the list of its class's slabs with room, or (next) of free slabs */
    uint32_t size_class;
    uint32_t live;   /* records in use */
    uint32_t carved; /* records ever used since the class took it */
    void *free;      /* records given back */
};

struct store {
    unsigned char *memory;
    struct store_slab *slabs;
    uint32_t slabs_used; /* high-water mark */
    uint32_t slabs_free; /* list of slabs given back */
    uint32_t open[STORE_CLASSES];
    uint32_t mails;
};

void store_init(struct store *s);

/** Copies a mail that the border has let through, with one use.  @return NULL when full */
struct mail *store_put(struct store *s, const muster_Mail *letter);

/** @return the bytes of the store that a mail takes */
uint32_t store_bytes(const struct mail *m);

void store_keep(struct mail *m);

/** Ends one use; the last one frees the mail. */
void store_release(struct store *s, struct mail *m);

#endif
