/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file broker.h
 * The broker without its network: samples go in, deliveries come out.
 *
 * It decides; main.c does.  Pure: no DDS call, no clock, no file, no allocation after broker_open.
 * The same calls in the same order give the same deliveries.
 *
 * Time: `now_ns` is the broker's clock.  In lock step it is not used: there, time is
 * step * step_ns of the roster.
 */
#ifndef MUSTER_BROKER_BROKER_H
#define MUSTER_BROKER_BROKER_H

#include "muster/limits.h"
#include "muster/result.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

struct broker;

struct broker_options {
    const char *name;     /* of this broker, for the white pages */
    uint64_t incarnation; /* a number that no earlier broker of this network had */
    const char *host;     /* for its own line of the white pages */
    uint32_t pid;
    uint64_t wall_ns;         /* nanoseconds since 1970 at now_ns == 0, for since_wall_ns */
    uint64_t resend_after_ns; /* an unacknowledged parcel goes out again after this; 1 s when 0 */
    uint64_t hold_ns;         /* so long a new holder waits for the old one; 1.5 s when 0 */
    bool has_store;           /* somebody writes the journal (journal.h) to a disk */
    uint64_t number_base;     /* boxes count from here: above all that an earlier life gave out */
};

/** Takes all memory that the broker will ever use.  One broker in a process. */
struct broker *broker_open(const struct broker_options *options);

/** An agent says that it is there, or has changed its state.  The answer is in a later delivery. */
void broker_registration(struct broker *b, const muster_Registration *r, uint64_t now_ns);

/**
 * The registration of a name ended: it left (crashed false), or no process writes it any more
 * (crashed true).  A process that does not hold the name is ignored; NULL or "", as when the
 * network tells the key alone, stands for the holder.
 */
void broker_gone(struct broker *b, const char *name, const char *process, bool crashed,
                 uint64_t now_ns);

/**
 * The writer into a process's partition has gained (true) or lost (false) its reader.  Nothing is
 * handed to a process, and no registration of it is confirmed, before this says true; when it
 * says true again, everything unacknowledged goes out again.
 */
void broker_matched(struct broker *b, const char *process, bool matched, uint64_t now_ns);

/** The simulator names the processes of the lock step, or ends it (lockstep false). */
void broker_roster(struct broker *b, const muster_Roster *roster, uint64_t now_ns);

/** A process's mails, acknowledgements and states. */
void broker_up(struct broker *b, const muster_Up *up, uint64_t now_ns);

/** Lets time pass: due mails, expiry, resending, held names.  Call when nothing happens, too. */
void broker_tick(struct broker *b, uint64_t now_ns);

/**
 * Gives the next delivery that is ready to go.
 *
 * @param process  out: whose; owned by the broker
 * @param d        out: filled with pointers into the broker, valid until the next call into it
 * @return true, or false when there is none.  After a write that the network refused, call
 *         broker_undelivered and try again later; after a good one, broker_delivered.
 */
bool broker_next(struct broker *b, const char **process, muster_Delivery *d);
void broker_delivered(struct broker *b, uint64_t now_ns);
void broker_undelivered(struct broker *b);

/** The index-th process whose writer has not matched yet, or NULL past the last. */
const char *broker_process(const struct broker *b, uint32_t index);

/** @return whether the broker still has business with a process */
bool broker_serves(const struct broker *b, const char *process);

/** Fills the counters. */
void broker_status(const struct broker *b, muster_BrokerStatus *status);

/** The index-th line of the white pages in order of name.  @return false past the last */
bool broker_member(const struct broker *b, uint32_t index, muster_Member *out);

/**
 * Gives the next line of the white pages that has changed since it was last given.
 *
 * @return false when there is none
 */
bool broker_member_news(struct broker *b, muster_Member *out);

/** @return how many samples the broker needs before it can do much: in lock step, the answers that
 *          are missing; else 1 */
uint32_t broker_samples_wanted(const struct broker *b);

/** When broker_tick is needed next, in broker time; UINT64_MAX: not before something happens. */
uint64_t broker_deadline_ns(const struct broker *b);

#endif
