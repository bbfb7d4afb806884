/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file graveyard.h
 * The numbers of names that have ended.
 */
#ifndef MUSTER_BROKER_GRAVEYARD_H
#define MUSTER_BROKER_GRAVEYARD_H

#include "broker/base/base.h"

struct agent;

/*
 * The numbers of names that have ended, and may come back: by them mail that was sent before is
 * known to be a duplicate, and new mail is not taken for one.
 *
 * It holds the GRAVES_MAX names that have ended last.  A name that is not among them begins as one
 * that no agent has had.
 */
enum { GRAVES_MAX = 65536 };

/* Numbers of an agent's mail. */
struct mail_numbers {
    uint64_t seen;      /* the last that it has sent in this life of the broker */
    uint64_t came;      /* the last that has come in this life, taken or not */
    uint64_t durable;   /* the last that went to the store, in any life */
    uint64_t failed;    /* the last that was not delivered, in any life */
    uint64_t earlier;   /* no mail of an earlier life of the broker has a higher one */
    uint64_t reserved;  /* on disk: later lives count from here */
    uint64_t elsewhere; /* no mail that other brokers have had of it has a higher one */
};

struct grave {
    char name[MU_NAME_MAX + 1]; /* "": none */
    muster_Kind saved_kind;     /* as that of struct agent */
    struct mail_numbers seq;
};

struct graveyard {
    struct grave ring[GRAVES_MAX];
    uint32_t next;
    struct mu_table names;
};

/** @return the numbers of a name that has ended, or NULL; valid until the next call */
struct grave *graveyard_find(struct graveyard *g, const char *name);

/** Makes room for a name that has none there, if need be for the oldest one's. */
struct grave *graveyard_add(struct graveyard *g, const char *name);

/** An agent's name ends. */
void graveyard_bury(struct graveyard *g, const struct agent *a);

/** An agent's name has come back: it takes its numbers out. */
void graveyard_raise(struct graveyard *g, struct agent *a);

#endif
