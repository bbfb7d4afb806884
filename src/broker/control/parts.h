/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file parts.h
 * How the parts of the broker hang together.
 *
 *   presence   registrations: names come, are claimed, and go registry, places, tenants,
 *                                                             claims
 *   admission  a mail comes in from the wire, once            border, journal, store
 *   router     a mail's way, and its end                      audience, guard, resolve,
 *                                                             posting, outcome
 *   audience   whom a mail is for                             registry, groups
 *   posting    a mail goes into boxes                         mailbox, boxroom, booking,
 *                                                             desk, schedule
 *   booking    a mail goes on its sender's account            share, events
 *   outcome    what becomes of a mail, and who is told        receipts, pacer, booking,
 *                                                             journal
 *   resolve    mail to SCHEME:REST waits while one is asked   pages, query, router
 *   guard      whose directives go on to whom                 trust, audit
 *   desk       mail to the broker itself and its parts        directive, query, resolve,
 *                                                             counters
 *   lockstep   collects a step's mail; lets it take effect    router, presence, pages
 *   pages      groups, services, standing queries             groups, services, query
 *   courier    what is ready for a process, as one Delivery   mailbox, receipts, tenants,
 *                                                             pages
 *   circular   the same mail for many processes at once      mailbox, places, pages
 *   floods     who gets much mail at once, while others     places
 *              have some under way, gets it in small pieces
 *   liaison    the other brokers: who lives beyond which;     presence, router, pages
 *              announce says who is known here, relay takes
 *              their mail
 *   depot      agents on their way: their capsules, and      presence, lockstep
 *              who is told what
 *   glances    lines that only look, beside all mail          guard, places
 *   journal    what must be on disk before anybody is told    registry, store, router
 */
#ifndef MUSTER_BROKER_PARTS_H
#define MUSTER_BROKER_PARTS_H

#include "broker/base/ages.h"
#include "broker/base/events.h"
#include "broker/base/mailbox.h"
#include "broker/base/pacer.h"
#include "broker/base/receipts.h"
#include "broker/base/runclock.h"
#include "broker/base/schedule.h"
#include "broker/base/share.h"
#include "broker/base/store.h"
#include "broker/control/broker.h"
#include "broker/control/lockstep.h"
#include "broker/directory/audit.h"
#include "broker/directory/trust.h"
#include "broker/mail/circular.h"
#include "broker/mail/courier.h"
#include "broker/mail/floods.h"
#include "broker/mail/glances.h"
#include "broker/mail/journal.h"
#include "broker/mail/resolve.h"
#include "broker/membership/depot.h"
#include "broker/membership/liaison.h"
#include "broker/names/claims.h"
#include "broker/names/places.h"
#include "broker/names/registry.h"
#include "broker/names/tenants.h"
#include "broker/services/counters.h"
#include "broker/services/pages.h"

/* A line of the white pages as text, in bytes. */
enum { BROKER_LINE_MAX = 384 };

struct broker_counters {
    uint64_t sent, delivered, waiting, expired, box_full, unknown_name, refused;
    uint64_t duplicates_dropped, resent, malformed, dropped, over_share, no_store;
    uint64_t gaps;     /* mails that came before an earlier one of their sender, and not taken */
    uint64_t astray;   /* acknowledgements of the boxes of an earlier life */
    uint64_t directed; /* directives let through, one a receiver, and changes in another's name */
    uint64_t unspoken; /* changes in another's name that were refused: no mails */
};

struct broker {
    char name[MU_FIELD_MAX + 1];
    char place[MU_PROCESS_MAX + sizeof "broker."]; /* what it is to other brokers */
    uint64_t incarnation;
    uint64_t wall_ns; /* nanoseconds since 1970 when the clock shows 0 */
    uint64_t resend_after_ns;
    uint64_t hold_ns;
    struct runclock clock;
    struct registry registry;
    struct places places;
    struct claims claims;
    struct store store;
    struct share_accounts shares; /* of the store */
    struct schedule due, expiry;
    struct schedule replays; /* mails of a recording, which nobody has been told of yet */
    struct mailbox mailbox;
    struct receipts receipts;
    struct lockstep lockstep;
    struct courier courier;
    struct circulars circulars;
    struct floods floods;
    struct depot depot;
    struct glances glances;
    struct pages pages;
    struct resolve resolve;
    struct ages ages;
    struct trust trust;
    struct audit audit;
    struct journal journal;
    struct liaison liaison;
    struct broker_counters counters;
    muster_LockstepEnd lockstep_end;
    struct events events;
    struct pacer pacer;
    uint64_t orders;           /* mails routed */
    uint64_t answers[2];       /* of the broker itself: to members of the lock step, to others */
    char *page[REGISTRY_PAGE]; /* of the white pages, as it is published */
    char page_text[REGISTRY_PAGE][BROKER_LINE_MAX];
    muster_Counter part_counters[COUNTERS_MAX]; /* of the PartStatus given last */
    char text[MU_CONTENT_MAX + 1];              /* in which an answer is put together */
};

#endif
