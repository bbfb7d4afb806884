/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file delivery.h
 * What is ready for a process, as one Delivery.
 */
#ifndef MUSTER_BROKER_DELIVERY_H
#define MUSTER_BROKER_DELIVERY_H

#include "broker/mail/mail.h"
#include "bus/bus.h"

/* --- multicast.c ----------------------------------------------------------------------------- */

/*
 * Mail for many processes goes out once for all of them: one sample instead of one for each.
 *
 * A multicast has mails that are next in the box of every agent that it names. A process gets a
 * Delivery of its own if it has something else to be told before, if its mail is kept on a disk, or
 * if it goes by steps. Processes that it does not concern hear it, too, so that there are no
 * more of them than of the others.
 */

enum {
    MULTICAST_PROCESSES_MIN = 4, /* fewer have a Delivery each */
    MULTICAST_WAITING = 64, /* mails to many that have not gone out; others go as any mail does */
    MULTICAST_BOXES = 1024, /* in one multicast; the others have a Delivery */
    MULTICAST_BYTES = 32 * 1024,   /* of mail in one */
    MULTICAST_PAUSE_NS = 10000000, /* after the network has refused one */
};

/* A box that the open multicast goes to. */
struct multicast_box {
    uint32_t agent, place, seat;
};

struct multicast {
    struct mail *waiting[MULTICAST_WAITING]; /* in the order in which they came */
    uint32_t count;
    uint64_t retry_ns; /* none goes out before */
    uint32_t readers;  /* processes that read them, those of other brokers among them */
    /* The open one: */
    struct multicast_box boxes[MULTICAST_BOXES]; /* in order of seats */
    uint32_t boxes_count, processes_count, letters_count;
    uint32_t seats[MULTICAST_BOXES], slots[MULTICAST_BOXES];
    uint64_t serials[MULTICAST_BOXES], numbers[MULTICAST_BOXES];
    muster_Mail letters[BUS_CIRCULAR_LETTERS];
};

/**
 * Puts the next one together.
 *
 * @return whether there is one; then multicast_sent or multicast_unsent is to be called
 */
bool multicast_next(struct broker *b, muster_Delivery *d);

/** It is out.  @return how many delivery items that were */
uint32_t multicast_sent(struct broker *b);

/** The network has refused it: its mails go as any mail does. */
void multicast_unsent(struct broker *b);

/** A mail has gone into the boxes of many: it may go out in a multicast. */
void multicast_note(struct broker *b, struct mail *m);

/* --- pacing.c -------------------------------------------------------------------------------- */

/*
 * Mail that pours into a process does not disturb the others.
 *
 * Sender, broker and receiver of a flood want more processors than there are, and a process that
 * exchanges a mail now and then waits for its turn. So, while any process but these two has mail
 * under way, a
 * process that gets many mails at once is handed PACING_MAILS every PACING_PAUSE_NS at most.  The
 * others wait in its boxes, and with them their sender, which has a bounded number of mails without
 * an answer. Where there is no other process, nothing is held, nor what other brokers get, which
 * serve many.
 */

enum {
    PACING_MANY = 16, /* mails in one Delivery that make a flood */
    PACING_MAILS = 64,
    PACING_PAUSE_NS = 1000000,
    PACING_QUIET_NS =
        20000000,        /* a process that has sent nothing for so long has no mail under way */
    PACING_SPEAKERS = 3, /* at both ends of a flood, and one more */
};

struct pacing_speaker {
    uint32_t place;
    uint64_t spoke_ns; /* 0: none has */
};

struct pacing {
    struct pacing_speaker speakers[PACING_SPEAKERS]; /* each once, the last sender first */
    struct mu_list held;                             /* processes, the first to be woken first */
};

void pacing_bring_forward(struct pacing *f, uint32_t place);

/** An agent of this process has sent mail. */
static inline void pacing_note_speaker(struct pacing *f, uint32_t place, uint64_t now_ns)
{
    if (f->speakers[0].place != place) {
        pacing_bring_forward(f, place);
    }
    f->speakers[0].spoke_ns = now_ns;
}

/** @return whether the last Delivery to a process may have been a part of a flood */
static inline bool pacing_is_due(const struct process *at)
{
    return at->mails_had >= PACING_MANY;
}

/** @return whether it was, and disturbs others: then the next one has PACING_MAILS mails at most */
bool pacing_is_flooded(const struct broker *b, uint32_t place);

/** @return whether a process gets nothing now; it is woken later */
bool pacing_hold(struct broker *b, uint32_t place);

/** So many mails have gone out to a process; from: where the last came from, or MU_NONE */
static inline void pacing_note_delivery(struct process *at, uint32_t mails, uint32_t from,
                                        uint64_t now_ns)
{
    at->mails_had = mails;
    at->flooded_from = from;
    at->flooded_until_ns = now_ns + PACING_PAUSE_NS;
}

/** Wakes processes that were held long enough. */
void pacing_tick(struct broker *b);

/** @return when pacing_tick is needed next, or UINT64_MAX */
uint64_t pacing_deadline_ns(const struct broker *b);

/* --- compose.c ------------------------------------------------------------------------------- */

/** @return whether there is anything to say */
bool compose_fill(struct broker *b, uint32_t place, muster_Delivery *d);

/** A word about an agent on its way, or of a probe, waits for nothing, and goes alone.
 * @return whether there is one */
bool compose_fill_word(struct broker *b, uint32_t place, muster_Delivery *d);

/* --- dispatcher.c ---------------------------------------------------------------------------- */

/*
 * Puts together what is ready for a process.  Nothing is taken from anywhere before the network
 * has taken it.
 *
 * With a delivery interval the dispatcher sleeps between its rounds.  A process that something
 * ordinary is ready for is held until it wakes; then it gets everything, in one Delivery if that
 * can hold it.
 */

enum {
    DISPATCH_BYTES = 128 * 1024,     /* of mail in one Delivery */
    DISPATCH_BOX_BYTES = 256 * 1024, /* of mail in one Delivery of a step, for one box */
    DISPATCH_AGENTS = 1024,          /* in one Delivery; the others are in the next one */
    DISPATCH_RECEIPTS = 8192,
    DISPATCH_ITEMS = 64 * 1024, /* as many as a process takes */
    DISPATCH_VERDICTS = DISPATCH_AGENTS + PROCESSES_REFUSALS,
    DISPATCH_MEMBERS = 2048, /* changes of the white pages */
    DISPATCH_INTERVAL_MAX_MS = 60000,
    DISPATCH_RETRY_NS = 1000000, /* after the network has refused */
};

/* What it has done; see metrics.c. */
struct dispatch_counts {
    uint64_t deliveries, multicasts, items, most_items, blocked, wakings, delay_ns;
};

/* What of one agent is in the open Delivery. */
struct dispatch_part {
    uint32_t agent; /* first: see registry_compare */
    uint32_t items;
    uint32_t receipts;
    bool verdict;
    bool passed_by; /* there was no room to look at all that it may have */
};

/* Room that is left in a Delivery. */
struct dispatch_room {
    uint32_t items;
    size_t bytes;
};

/* A Delivery may have one word alone: of a migration, or of a probe. */
enum dispatch_word { WORD_NONE, WORD_TRIP, WORD_PROBE };

struct dispatch {
    uint32_t
        open; /* whose Delivery is out with the caller; PROCESSES_ALL: a multicast; or MU_NONE */
    struct steps_view view; /* from which it is filled */
    uint64_t open_version;
    uint64_t open_delay_ns; /* that the interval has added to the mails in it, together */
    uint64_t interval_ns;   /* between two wakings; 0: it never sleeps */
    uint64_t wake_ns;       /* of the broker's clock: it does not wake before this */
    uint64_t slept_ns;      /* of the mail clock: since when */
    bool awake;             /* ordinary mail goes out just now */
    bool worked;            /* something has gone out since it woke */
    struct dispatch_counts count;
    uint64_t retry_ns;            /* when blocked processes are tried again */
    enum dispatch_word open_word; /* that it has alone: trip, or probe */
    muster_Trip trip;
    muster_Glance probe;
    struct dispatch_part parts[DISPATCH_AGENTS];
    uint32_t parts_count;
    muster_Parcel items[DISPATCH_ITEMS];
    muster_Receipt receipts[DISPATCH_RECEIPTS];
    muster_Verdict verdicts[DISPATCH_VERDICTS];
    muster_Member members[DISPATCH_MEMBERS];
    muster_Mail outside[STEPS_OUTSIDE_MAX];
};

/** @return whether ordinary mail may go out to processes that do not go by steps */
static inline bool dispatch_is_awake(const struct dispatch *c)
{
    return c->interval_ns == 0 || c->awake;
}

/**
 * Sets the delivery interval: from now on ordinary mail goes to a process at most once in so long;
 * directives and answers to registrations go at once.  Inside, it is rounded up to whole steps
 * of simulated time.
 */
void dispatch_set_interval(struct broker *b, uint64_t interval_ns);

/** Tries blocked processes again, when it is time. */
void dispatch_tick(struct broker *b);

/** @return when dispatch_tick is needed next, or UINT64_MAX */
uint64_t dispatch_deadline_ns(const struct broker *b);

#endif
