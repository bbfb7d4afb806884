/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file parts.h
 * How the parts of the broker hang together.
 *
 *   presence   registrations: names come, are claimed, and go     registry, places
 *   router     a mail's way into boxes, and what becomes of it     policy, query, store, mailbox
 *   lockstep   collects a step's mail and lets it take effect      router, presence
 *   courier    what is ready for a process, as one Delivery        mailbox, receipts
 *   journal    what must be on disk before anybody is told         registry, store, router
 */
#ifndef MUSTER_BROKER_PARTS_H
#define MUSTER_BROKER_PARTS_H

#include "broker/broker.h"
#include "broker/courier.h"
#include "broker/journal.h"
#include "broker/lockstep.h"
#include "broker/mailbox.h"
#include "broker/places.h"
#include "broker/receipts.h"
#include "broker/registry.h"
#include "broker/runclock.h"
#include "broker/schedule.h"
#include "broker/store.h"

struct broker_counters {
    uint64_t sent, delivered, waiting, expired, box_full, unknown_name, refused;
    uint64_t duplicates_dropped, resent, malformed, no_store;
};

struct broker {
    char name[MU_FIELD_MAX + 1];
    uint64_t incarnation;
    uint64_t wall_ns; /* nanoseconds since 1970 when the clock shows 0 */
    uint64_t resend_after_ns;
    uint64_t hold_ns;
    struct runclock clock;
    struct registry registry;
    struct places places;
    struct store store;
    struct schedule due, expiry;
    struct mailbox mailbox;
    struct receipts receipts;
    struct lockstep lockstep;
    struct courier courier;
    struct journal journal;
    struct broker_counters counters;
    uint64_t orders;     /* mails routed */
    uint64_t answers[2]; /* of the broker itself: to members of the lock step, to others */
    char text[MU_CONTENT_MAX + 1]; /* in which an answer is put together */
};

#endif
