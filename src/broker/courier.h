/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file courier.h
 * Puts together what is ready for a process.  Nothing is taken from anywhere before the network
 * has taken it.
 */
#ifndef MUSTER_BROKER_COURIER_H
#define MUSTER_BROKER_COURIER_H

#include "broker/lockstep.h"
#include "broker/mailbox.h"
#include "broker/places.h"
#include "broker/registry.h"

struct broker;

enum {
    COURIER_BYTES = 128 * 1024,     /* of mail in one Delivery, out of lock step */
    COURIER_BOX_BYTES = 256 * 1024, /* of mail in one Delivery for one box, in lock step */
    COURIER_AGENTS = 1024,          /* in one Delivery; the others are in the next one */
    COURIER_RECEIPTS = 8192,
    COURIER_PARCELS = 64 * (MU_WINDOW_MAX + MAILBOX_RESERVE), /* of 64 full boxes */
    COURIER_MEMBERS = 2048,                                   /* changes of the white pages */
    COURIER_RETRY_NS = 1000000,                               /* after the network has refused */
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
    uint32_t open; /* whose Delivery is out with the caller, or MU_NONE */
    bool open_lockstep;
    uint64_t open_version;
    uint64_t retry_ns; /* when blocked processes are tried again */
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

/** Tries blocked processes again, when it is time. */
void courier_tick(struct broker *b);

/** @return when courier_tick is needed next, or UINT64_MAX */
uint64_t courier_deadline_ns(const struct broker *b);

#endif
