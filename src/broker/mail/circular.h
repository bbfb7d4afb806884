/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file circular.h
 * Mail for many processes goes out once for all of them: one sample instead of one for each.
 *
 * A circular has mails that are next in the box of everybody whom it names.  Whoever has something
 * else to be told before, whose mail is kept on a disk, or who is in a lock step gets a Delivery of
 * its own.  Those whom it does not concern hear it, too, so that there are no more of them than of
 * the others.
 */
#ifndef MUSTER_BROKER_CIRCULAR_H
#define MUSTER_BROKER_CIRCULAR_H

#include "broker/base/store.h"
#include "broker/mail/audience.h"
#include "bus/bus.h"
#include "wire.h"

struct broker;

enum {
    CIRCULAR_PLACES_MIN = 4, /* fewer have a Delivery each */
    CIRCULAR_WAITING = 64,   /* mails to many that have not gone out; others go as any mail does */
    CIRCULAR_BOXES = 1024,   /* in one circular; the others have a Delivery */
    CIRCULAR_BYTES = 32 * 1024,   /* of mail in one */
    CIRCULAR_PAUSE_NS = 10000000, /* after the network has refused one */
};

/* A box that the open circular goes to. */
struct circular_box {
    uint32_t agent, place, seat;
};

struct circulars {
    struct mail *waiting[CIRCULAR_WAITING]; /* in the order in which they came */
    uint32_t count;
    uint64_t retry_ns; /* none goes out before */
    uint32_t hearers;  /* places that hear them, */
    uint32_t readers;  /* and processes, those of other brokers among them */
    /* The open one: */
    struct circular_box boxes[CIRCULAR_BOXES]; /* in order of seats */
    uint32_t boxes_count, places_count, letters_count;
    uint32_t seats[CIRCULAR_BOXES], slots[CIRCULAR_BOXES];
    uint64_t serials[CIRCULAR_BOXES], numbers[CIRCULAR_BOXES];
    muster_Mail letters[BUS_CIRCULAR_LETTERS];
};

/** A place hears circulars from now on (true), or no longer. */
void circulars_hears(struct broker *b, uint32_t place, bool hears);

/** So many processes read what goes to all, whoever their broker is. */
void circulars_read_by(struct broker *b, uint32_t readers);

/** A mail has gone into the boxes of many: it may go out in a circular. */
void circulars_note(struct broker *b, struct mail *m);

/**
 * Puts the next one together.
 *
 * @return whether there is one; then circulars_sent or circulars_unsent is to be called
 */
bool circulars_next(struct broker *b, muster_Delivery *d);

/** It is out.  @return how many parcels that were */
uint32_t circulars_sent(struct broker *b);

/** The network has refused it: its mails go as any mail does. */
void circulars_unsent(struct broker *b);

#endif
