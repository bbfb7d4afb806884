/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file parts.h
 * The broker as one struct of all floors.  A floor calls itself and the floors below it:
 *
 *   node        the process: DDS, the store, files
 *   control     the pure broker from outside; the end of a step; what the disk answers
 *   membership  names come, move and go; the other brokers
 *   services    what the broker answers by mail, news of changes, the way of one mail
 *   delivery    what is ready for a process, as one Delivery
 *   mail        receivers, quota, boxes, outcomes; snapshots and probes; the journal
 *   directory   groups, services, standing queries; the trust policy and its audit log
 *   steps       what is collected of a step; the rules that keep a run apart
 *   names       names and their bearers, in which process, beyond which broker
 *   base        time, versions, limits, the rules of the wire, the pool of mails, boxes
 */
#ifndef MUSTER_BROKER_PARTS_H
#define MUSTER_BROKER_PARTS_H

#include "broker/control/broker.h"
#include "broker/services/services.h"

/* A line of the white pages as text, in bytes. */
enum { BROKER_LINE_MAX = 384 };

struct broker {
    char name[MU_FIELD_MAX + 1];
    char place[MU_PROCESS_MAX + sizeof "broker."]; /* what it is to other brokers */
    uint64_t incarnation;
    struct clock clock;
    struct registry registry;
    struct processes processes;
    struct claims claims;
    struct pool pool;
    struct quota_accounts quotas; /* of the store */
    struct timers due, expiry;
    struct timers replays; /* mails of a recording, which were told to no process yet */
    struct mailbox mailbox;
    struct receipts receipts;
    struct steps steps;
    struct dispatch dispatch;
    struct multicast multicast;
    struct pacing pacing;
    struct snapshots snapshots;
    struct probes probes;
    struct pages pages;
    struct resolve resolve;
    struct mail_list arrivals; /* mails that wait in boxes: the oldest is always at hand */
    struct trust trust;
    struct audit audit;
    struct journal journal;
    struct federation federation;
    struct retirement retirement;
    muster_BrokerStatus counters; /* what is known elsewhere, broker_status adds; besides: */
    uint64_t gaps;     /* mails that came before an earlier one of their sender, and not taken */
    uint64_t astray;   /* acknowledgements of the boxes of an earlier life */
    uint64_t directed; /* directives let through, one a receiver, and changes in another's name */
    uint64_t unspoken; /* changes in another's name that were refused: no mails */
    struct bus_ways ways; /* to the processes */
    struct alerts alerts;
    struct limiter bad_news, good_news;
    uint64_t orders;           /* mails routed */
    uint64_t answers[2];       /* of the broker itself: to agents inside, to others */
    char *page[REGISTRY_PAGE]; /* of the white pages, as it is published */
    char page_text[REGISTRY_PAGE][BROKER_LINE_MAX];
    muster_Counter part_counters[METRICS_MAX]; /* of the PartStatus given last */
    char text[MU_CONTENT_MAX + 1];             /* in which an answer is put together */
};

/** Every call that changes something begins here. */
static inline void broker_enter(struct broker *b, uint64_t now_ns)
{
    MU_ASSERT(b->dispatch.open == MU_NONE); /* the last Delivery's fate is not known yet */
    clock_set_now(&b->clock, now_ns);
}

#endif
