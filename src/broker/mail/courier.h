/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file courier.h
 * Puts together what is ready for a process.  Nothing is taken from anywhere before the network
 * has taken it.
 *
 * With a delivery interval the courier sleeps between its rounds.  A process that something
 * ordinary is ready for is held until it wakes; then it gets everything, in one Delivery if that
 * can hold it.
 */
#ifndef MUSTER_BROKER_COURIER_H
#define MUSTER_BROKER_COURIER_H

#include "broker/base/mailbox.h"
#include "broker/control/lockstep.h"
#include "broker/names/places.h"
#include "broker/names/registry.h"

struct broker;

enum {
    COURIER_BYTES = 128 * 1024,     /* of mail in one Delivery, out of lock step */
    COURIER_BOX_BYTES = 256 * 1024, /* of mail in one Delivery for one box, in lock step */
    COURIER_AGENTS = 1024,          /* in one Delivery; the others are in the next one */
    COURIER_RECEIPTS = 8192,
    COURIER_PARCELS = 64 * 1024, /* as many as a process takes */
    COURIER_MEMBERS = 2048,      /* changes of the white pages */
    COURIER_INTERVAL_MAX_MS = 60000,
    COURIER_RETRY_NS = 1000000, /* after the network has refused */
};

/* What it has done; see counters.c. */
struct courier_counts {
    uint64_t deliveries, circulars, parcels, most_parcels, blocked, wakings, delay_ns;
};

/* What of one agent is in the open Delivery. */
struct courier_part {
    uint32_t agent;
    uint32_t parcels;
    uint32_t receipts;
    bool verdict;
    bool passed_by; /* there was no room to look at all that it may have */
};

/* Room that is left in a Delivery. */
struct courier_room {
    uint32_t parcels;
    size_t bytes;
};

struct courier {
    uint32_t open; /* whose Delivery is out with the caller; PLACES_ALL: a circular; or MU_NONE */
    bool open_lockstep;
    uint64_t open_version;
    uint64_t open_delay_ns; /* that the interval has added to the mails in it, together */
    uint64_t interval_ns;   /* between two wakings; 0: it never sleeps */
    uint64_t wake_ns;       /* of the broker's clock: it does not wake before this */
    uint64_t slept_ns;      /* of the mail clock: since when */
    bool awake;             /* ordinary mail goes out just now */
    bool worked;            /* something has gone out since it woke */
    uint32_t held;          /* processes that wait for it to wake, at most */
    struct courier_counts count;
    uint64_t retry_ns; /* when blocked processes are tried again */
    bool open_trip;    /* it has this alone: */
    muster_Trip trip;
    bool open_glance; /* likewise */
    muster_Glance glance;
    struct courier_part parts[COURIER_AGENTS];
    uint32_t parts_count;
    muster_Parcel *parcels;
    muster_Receipt *receipts;
    muster_Verdict verdicts[COURIER_AGENTS + PLACES_REFUSALS];
    muster_Member members[COURIER_MEMBERS];
    muster_Mail outside[LOCKSTEP_OUTSIDE_MAX];
};

void courier_init(struct courier *c);

/** As broker_next, broker_delivered and broker_undelivered. */
bool courier_next(struct broker *b, const char **process, muster_Delivery *d);
void courier_delivered(struct broker *b);
void courier_undelivered(struct broker *b);

/**
 * Sets the delivery interval: from now on ordinary mail goes to a process at most once in so long;
 * directives and answers to registrations go at once.  In lock step it is rounded up to whole steps
 * of simulated time.
 */
void courier_set_interval(struct broker *b, uint64_t interval_ns);

/** Tries blocked processes again, when it is time. */
void courier_tick(struct broker *b);

/** @return when courier_tick is needed next, or UINT64_MAX */
uint64_t courier_deadline_ns(const struct broker *b);

#endif
