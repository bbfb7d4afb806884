/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pages.h
 * Groups and services among the other parts of the broker: who is shown what, and who is told.
 *
 * A service is shown while its agent is not absent and its lease is not over.  To members of a lock
 * step only services of members are shown, and groups as groups.h says: what others do by the wall
 * clock changes nothing inside.
 */
#ifndef MUSTER_BROKER_PAGES_H
#define MUSTER_BROKER_PAGES_H

#include "broker/directory/groups.h"
#include "broker/directory/services.h"
#include "broker/directory/subscriptions.h"

struct broker;
struct place;

/* Lines in one Delivery out of lock step; the others come in the next one. */
enum { PAGES_MEMBERSHIPS = 4096, PAGES_OFFERS = 1024 };

struct pages {
    struct groups groups;
    struct services services;
    struct subscriptions subscriptions;
    uint64_t groups_seen, services_seen; /* the versions that everybody was woken for */
    uint64_t groups_open, services_open; /* the versions that the open Delivery leads to */
    muster_Membership *memberships;      /* of the open Delivery */
    muster_Offer *offers;
    bool asked_inside; /* a policy asks because of a directive from inside the lock step */
};

void pages_init(struct pages *p);

/** @return whether the agent is in a lock step that is on */
bool pages_inside(const struct broker *b, uint32_t agent);

/** @return whether a line of the services is shown, to members of the lock step or to others */
bool pages_shows(const struct broker *b, uint32_t line, bool inside);

/** What is said now: its stamp, and whether it takes effect inside.  Call before each change. */
struct said pages_said(struct broker *b);

/** Something may have changed: processes are woken, subscribers are sent what is news to them. */
void pages_tell(struct broker *b);

/** Tells a subscriber all that is news to him; silently: it counts as told. */
void pages_review(struct broker *b, struct subscription *s, bool silently);

/** An agent has come or gone. */
void pages_presence(struct broker *b, uint32_t agent);

/** Ends leases.  @param mail_ns  the mail clock */
void pages_expire(struct broker *b, uint64_t mail_ns);

/** @return when pages_expire is needed next, on the mail clock; UINT64_MAX: never */
uint64_t pages_deadline_mail_ns(const struct broker *b);

/** A lock step begins, ends, takes in an agent. */
void pages_freeze(struct broker *b);
void pages_thaw(struct broker *b);
void pages_enter(struct broker *b, uint32_t agent);

/** A process is to be told everything again. */
void pages_forget_told(struct place *at);

/** Adds to a Delivery what has changed since the last one. */
void pages_fill(struct broker *b, const struct place *at, muster_Delivery *d);

/** Before anything is restored: the journal keeps the lines. */
void pages_journal_attach(struct broker *b);

/** Policies may ask for groups and roles from now on. */
void pages_trust_attach(struct broker *b);

/** Lines that have changed since these versions are to be on disk. */
void pages_journal_mark(struct broker *b, uint64_t groups_since, uint64_t services_since);

/** @return whether there is nothing of it that a place has not been told */
bool pages_has_told(const struct broker *b, const struct place *at);

/** @return the lease of a line as others are to have it, who count it from its stamp by the wall */
uint64_t pages_lease_ns(const struct broker *b, uint32_t line);

/** The Delivery has gone out. */
void pages_delivered(struct broker *b, struct place *at);

#endif
