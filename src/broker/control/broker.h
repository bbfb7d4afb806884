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

#include "broker/directory/directory.h"
#include "bus/bus.h"

struct journal_entry;

struct broker_options {
    const char *name;     /* of this broker, for the white pages */
    uint64_t incarnation; /* a number that no earlier broker of this network had */
    uint32_t pid;
    uint64_t wall_ns;              /* nanoseconds since 1970 at now_ns == 0, for since_wall_ns */
    uint64_t delivery_interval_ns; /* between two rounds of the dispatcher; 0: at once */
    uint64_t receipt_pause_ns;     /* so long a receipt waits for mail to go with; 0: it does not */
    bool audit;                    /* directives are recorded for audit_next */
    uint32_t names;                /* so many at a time; MU_AGENTS_MAX when 0 */
    uint64_t name_expiry_ns;       /* a name that is absent for so long may end; 10 min when 0 */
    struct box_limits boxes;       /* of those whose agents ask for nothing else; 0: the most */
    bool has_store;                /* the journal (journal.h) is written to a disk */
    uint64_t number_base; /* boxes count from here: above all that an earlier life gave out */
};

/** Takes all memory that the broker will ever use.  One broker in a process. */
struct broker *broker_open(const struct broker_options *options);

/** A process says which agents are in a part of it.  The answers are in later deliveries. */
void broker_registration(struct broker *b, const muster_Registration *r, uint64_t now_ns);

/**
 * A part of a process's registration ended: the process took it back (crashed false), or it is not
 * written any more (crashed true), and that goes for the whole process.
 */
void broker_gone(struct broker *b, const char *process, uint32_t part, bool crashed,
                 uint64_t now_ns);

/**
 * The writer into a process's partition has gained (true) or lost (false) its reader.  Nothing is
 * handed to a process, and no registration of it is confirmed, before this says true; when it
 * says true again, everything unacknowledged goes out again.
 */
void broker_matched(struct broker *b, const char *process, bool matched, uint64_t now_ns);

/** A process that has matched reads multicasts, too: Deliveries to many, in partition BUS_TO_ALL.
 */
void broker_hears(struct broker *b, const char *process);

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

/* --- other brokers, each as it were a process "broker.NAME" ------------------------------------
 */

/** So many other brokers are there now; nothing is announced while there are none. */
void broker_peers(struct broker *b, uint32_t count, uint64_t now_ns);

/** Another broker delivers mail, receipts, lines of groups and services to this one. */
void broker_delivery(struct broker *b, const muster_Delivery *d, uint64_t now_ns);

/**
 * Gives the next part of what this broker says to the others of the agents that it knows.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false when there is none; after a good write, broker_announced; after another one, stop
 *         and ask again later
 */
bool broker_announcement(struct broker *b, muster_Registration *out);
void broker_announced(struct broker *b);

/**
 * Gives the next acknowledgements for another broker: after the commit of what they stand for.
 *
 * @param peer  out: the broker's name
 * @return as broker_announcement; after a good write, broker_up_sent
 */
bool broker_up_next(struct broker *b, const char **peer, muster_Up *out);
void broker_up_sent(struct broker *b);

/** @return whether an agent with a new name would be taken: names are kept when their agents go */
bool broker_takes_names(const struct broker *b);

/** Fills the counters; what only the process knows (processor time, memory) stays 0. */
void broker_status(const struct broker *b, muster_BrokerStatus *status);

/**
 * Fills the counters of one of the broker's parts, which are numbered from 1.
 *
 * @param status  out: valid until the next call
 * @return false past the last part
 */
bool broker_part(struct broker *b, uint32_t part, muster_PartStatus *status);

/**
 * Gives the next page of the white pages in which a line has changed since it was last given.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false when there is none; after a write that the network refused, call
 *         registry_mark_page and try again later
 */
bool broker_page_news(struct broker *b, muster_Page *out);

/**
 * Gives what has gone wrong with mail; alerts_next in alerts.h says how often.
 *
 * @return false when there is nothing to tell now
 */
bool broker_event_next(struct broker *b, muster_BrokerEvent *out);

/** @return how many samples the broker needs before it can do much: in lock step, the answers that
 *          are missing; else 1 */
uint32_t broker_samples_wanted(const struct broker *b);

/** When broker_tick is needed next, in broker time; UINT64_MAX: not before something happens. */
uint64_t broker_deadline_ns(const struct broker *b);

/* --- for the disk: see journal_wanted in mail.h ------------------------------------------------
 */

/** All that journal_next gave since journal_wanted is on disk, or nothing of it is. */
void durable_committed(struct broker *b, bool ok, uint64_t now_ns);

/**
 * Takes in what an earlier life has left: names, then lines, clock and mails in order of row, and
 * before anything else happens.
 *
 * @return false: it is malformed, or there is no room; a mail stays on disk, a line until the lines
 *         of its kind are written again
 */
bool durable_restore(struct broker *b, const struct journal_entry *entry);

#endif
