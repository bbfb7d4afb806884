/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file history.h
 * A random history of a broker: processes with a few agents each, a network, a disk, a clock that
 * only the history moves, and a ledger of what was promised to whom.
 *
 * The agents are written anew from docs/broker.md, not taken from the runtime: what both sides get
 * wrong in the same way would not be seen.  A history is nothing but its seed.
 *
 *   history.c         the world: its steps, the quiet at its end, what must hold then
 *   history_acts.c    what happens, by the dice
 *   history_agent.c   processes and agents: numbers, sending again, taking, acknowledging
 *   history_net.c     registrations, Ups and Deliveries on their way
 *   history_many.c    multicasts on their way
 *   history_inbox.c   what has come to a process, and in which order it takes that
 *   history_life.c    the lives of a broker
 *   history_disk.c    its disk
 *   history_ledger.c  every mail: who is to have it, who has it, what its sender was told
 *   history_pages.c   groups and services as they ought to be
 */
#ifndef MUSTER_TESTS_HISTORY_H
#define MUSTER_TESTS_HISTORY_H

#include "../brokers.h"
#include "../samples.h"

#include <stdbool.h>
#include <stdint.h>

#define MS 1000000ull

enum {
    NAMES = 20,
    PROCESSES = 12,
    SEATS = 3, /* agents of a process */
    GROUPS = 4,
    SERVICES = 3,
    MAILS = 2048,
    LIVES = 2048, /* of agents */
    OUTBOX = 40,
    TAKEN = 256,
    QUEUE = 6,     /* Ups, or Deliveries, on their way to or from a process */
    INBOX = 16,    /* Deliveries and multicasts together */
    CHAIRS = 4096, /* what the broker calls seats: of processes, in one life of it */
    UP_MAILS = 12,
    PARCELS = MU_WINDOW_MAX,
    RECEIPTS = 256,
    VERDICTS = 64,
    PRIORITIES = 4, /* low, normal, high, directives */
    NOBODY = -1
};

typedef uint32_t names; /* a set: a bit for each */

/* --- the ledger ------------------------------------------------------------------------------- */

enum to_whom { TO_NAMES, TO_ALL, TO_ROBOTS, TO_GROUP, TO_BROKER };

/* What a mail to the broker asks for. */
enum asks { ASK_CREATE, ASK_JOIN, ASK_LEAVE, ASK_ADVERTISE, ASK_WITHDRAW, ASK_FIND, ASKS };

struct entry {
    int src;
    uint32_t sender_life;
    uint64_t seq; /* under which it went out last */
    enum to_whom to;
    names addressed; /* of TO_NAMES */
    bool to_unknown; /* a name that nobody has is among them */
    int key;         /* the group, or the service */
    enum asks asks;
    muster_Level level;
    uint32_t layer;
    int32_t priority;
    uint64_t ttl_ns;
    int64_t due_ns;
    /* at the broker */
    uint32_t accepted; /* how often it was new to a life of the broker */
    uint32_t life;     /* the last one that took it as new, or on whose disk it is */
    names meant;       /* all for whom it was, ever */
    names expected;    /* of them, whoever may have it */
    names live;        /* of the last time that it was new: they are to have it */
    names taken;
    bool committed;      /* it was on the disk once */
    bool unknown_some;   /* and so on: the broker's counters said so when it was new */
    bool refused_some;   /* a box or the store had no room */
    bool forbidden_some; /* a directive */
    bool undone;         /* the disk did not take it */
    bool vague;          /* a later life said how it ended, which that life cannot know */
    /* at its sender */
    bool stored, told;
    bool heard;                      /* either, in a life before the last one that took it as new */
    uint32_t told_life, stored_life; /* of the broker that said so */
    bool closed;                     /* nobody is to get it any more */
    uint64_t answer;                 /* hash of the right answer, 0: none is wanted */
};

/* --- processes -------------------------------------------------------------------------------- */

struct slot {
    uint32_t mail;
    uint64_t seq;
    bool sent, confirmed, again;
};

struct actor {
    int name; /* NOBODY: the seat is free */
    uint32_t life;
    muster_State state;
    bool registered, refused, leaving;
    muster_BoxPolicy policy;
    uint32_t box_mails;
    uint64_t incarnation;     /* of the broker that has accepted it */
    uint64_t accepted_serial; /* of the Delivery that said so */
    struct slot outbox[OUTBOX];
    uint32_t waiting, unsent; /* mails in it; the first that is to go out */
    uint64_t first_seq, next_seq, own_seq, earlier_end;
    bool begun;
    uint64_t progress_ns;
    uint64_t last_number, acked_number, handed;
    bool in_order;
    struct {
        int src;
        uint64_t since, seq;
    } ring[TAKEN];
    uint32_t ring_next;
    uint8_t had[MAILS]; /* of the ledger: how often it was handed over */
    uint32_t last_life[NAMES][PRIORITIES];
    uint64_t last_seq[NAMES][PRIORITIES];
};

struct up_mail {
    int seat;
    uint32_t mail;
    uint64_t seq, first_seq; /* of the outbox: all before it are answered for */
    bool again;
};

struct up_ack {
    int name;
    uint64_t number, handed;
    uint64_t incarnation; /* of the broker whose box it is of */
};

struct up {
    struct up_mail mails[UP_MAILS];
    uint32_t mails_count;
    struct up_ack acks[SEATS];
    uint32_t acks_count;
};

struct item {
    int box, src; /* src NOBODY: the broker; box NOBODY: a multicast's, */
    int seat;     /* where it has this instead */
    uint64_t number, since, seq;
    uint32_t mail;
    int32_t priority;
    uint32_t layer;
    bool again;
    uint64_t text; /* hash of its content */
};

struct delivery {
    uint32_t life; /* of the broker */
    uint64_t incarnation;
    uint32_t chair; /* the process, by the broker's count */
    uint64_t serial;
    uint64_t comes_ns;
    bool has_come, is_circular;
    struct item parcels[PARCELS];
    uint32_t parcels_count;
    struct {
        int name;
        uint64_t first, last;
        muster_Outcome result;
    } receipts[RECEIPTS];
    uint32_t receipts_count;
    struct {
        int name;
        bool accepted;
        uint64_t last_seq, incarnation;
    } verdicts[VERDICTS];
    uint32_t verdicts_count;
};

struct history_process {
    char name[16];
    bool alive;
    bool reaches; /* the broker's network has it */
    uint64_t incarnation, beat_ns;
    bool registration_due;
    struct actor seats[SEATS];
    struct up ups[QUEUE];
    uint32_t ups_count;
    bool has_ears; /* for multicasts */
    bool hears;    /* and the broker knows */
    struct delivery deliveries[INBOX];
    uint32_t deliveries_count;
    uint64_t comes_ns; /* the last Delivery */
    struct {
        uint64_t incarnation, serial;
        uint32_t chair;
        uint64_t lacks_ns; /* since when something is missing */
    } inbox;
    uint64_t copied_from;     /* the broker's incarnation */
    muster_State seen[NAMES]; /* its copy of the white pages */
    names members[GROUPS];    /* its copies of groups and services */
    names offers[SERVICES];
};

/* --- pages ------------------------------------------------------------------------------------ */

struct offer_due {
    bool offered;
    uint64_t until_ns; /* of the history's clock; UINT64_MAX: until withdrawn */
};

struct book {
    bool exists[GROUPS];
    names members[GROUPS];
    struct offer_due offers[SERVICES][NAMES];
};

/* --- the world -------------------------------------------------------------------------------- */

struct life {
    struct broker *b; /* NULL: dead */
    uint32_t number;
    uint64_t incarnation, began_ns;
    uint64_t highest[NAMES]; /* number handed out */
    uint64_t acked[NAMES];   /* number acknowledged */
    struct chair {
        const struct history_process *of;
        uint64_t serial; /* of what went there last */
    } chairs[CHAIRS];
    bool disk_fails;
};

struct history {
    uint64_t seed, now_ns;
    bool has_store, loses; /* the network refuses deliveries now and then */
    uint32_t box_mails;
    muster_BoxPolicy box_policy;
    uint32_t asked_most[NAMES]; /* mails in a box, of all its bearers */
    names drops; /* whose box has dropped mail when it was full, in some life of theirs */
    uint32_t lives, sender_lives; /* begun */
    bool forgot; /* a disk had failed when its broker died: it does not say which numbers were taken
                  */
    bool is_quiet;
    struct life life;
    struct history_process processes[PROCESSES];
    struct entry ledger[MAILS];
    uint32_t mails;
    struct book book, book_on_disk;
    uint32_t hasty[LIVES]; /* the life of the broker to which a sender spoke before it had heard of
                              it: should that die, too, a later one takes what it never had for
                              what it knew */
    bool cut[LIVES];       /* senders that were absent once: who is absent is told nothing */
    bool contested[LIVES]; /* senders whose name another one had while they lived: their numbers
                              are not theirs alone */
    struct {
        uint64_t taken, receipts, kills, repeats, again, expired, dropped, refused;
        uint64_t multicasts, by_circular, early, late, lost, astray;
    } seen; /* that the history was worth something */
};

extern struct history history;

/** Writes a line into the account of what happened last. */
void history_note(const char *format, ...) __attribute__((format(printf, 1, 2)));

/** Prints the seed and what happened last, and ends the process. */
_Noreturn void history_fail(const char *what, const char *file, int line);

#define HOLD(condition) ((condition) ? (void)0 : history_fail(#condition, __FILE__, __LINE__))

/** Lives one history through.  Returns if all promises were kept. */
void history_live(uint64_t seed, uint32_t steps);

uint32_t history_roll(uint32_t sides);
bool history_chance(uint32_t one_in);

/** The name of that index, and back; NOBODY: it is none. */
const char *history_name(int index);
int history_name_index(const char *name);

/* history_acts.c */
void acts_one(void);

/* history_agent.c */
void agent_join(struct history_process *p, int seat, int name);
bool agent_send(struct actor *a, uint32_t mail);
void process_begin(struct history_process *p);
void process_forget(struct history_process *p);
void process_take(struct history_process *p, const struct delivery *d);
void process_flush(struct history_process *p);
void process_beat(struct history_process *p);
struct actor *process_agent(struct history_process *p, int name);
/** @return the agent that lives and bears that name by the broker's leave, or NULL */
struct actor *agent_of(int name);

/* history_net.c */
void net_register(struct history_process *p);
void net_feed(struct history_process *p);
void net_match(void);
void net_lose(struct history_process *p, bool crashed);
void net_deliver(void);
void net_parcel_copy(const muster_Mail *from, uint64_t number, struct item *to);
/** A number goes out to a box for the first time, or as it was. */
void net_parcel_check(const struct history_process *p, int box, const struct item *item);

/* history_many.c */
void many_hear(void);
void many_deliver(const muster_Delivery *d);
/** Something with that serial goes to a process. */
void many_count(struct history_process *p, uint32_t chair, uint64_t serial);

/* history_inbox.c */
/** @return room for one more; it comes later, perhaps; NULL: there is none */
struct delivery *inbox_add(struct history_process *p, bool is_circular);
/** The broker is dead: what has not come never will. */
void inbox_orphan(struct history_process *p);
/** Takes what is next.  @return whether there was any */
bool inbox_take(struct history_process *p);

/* history_life.c */
void life_begin(void);
void life_kill(void);
void life_round(void);
uint64_t life_now_ns(void);
muster_BrokerStatus life_status(void);
/** Looks a name up in the broker's white pages.  @return whether it is there */
bool life_member(int name, muster_Member *out);
/** The counters add up, and no limit is passed. */
void life_check(void);
/** Nothing is kept that nobody waits for. */
void life_check_empty(void);

/* history_disk.c */
void disk_clear(void);
void disk_write(void);
void disk_restore(void);

/* history_ledger.c */
uint32_t ledger_open(int src, uint32_t sender_life);
/** Who gets the mail if it is new to the broker now.  @return how many names are not known */
uint32_t ledger_audience(const struct entry *e, names *to);
void ledger_offer(uint32_t mail, bool again, const muster_BrokerStatus *was,
                  const muster_BrokerStatus *is);
void ledger_committed(bool ok);
void ledger_killed(void);
void ledger_hand(struct actor *a, const struct item *p, uint32_t life);
void ledger_told(struct actor *a, uint64_t seq, muster_Outcome result, uint32_t life);
void ledger_check_end(void);

/* history_pages.c */
void book_change(const struct entry *e);
void book_expire(void);
/** @return the hash of the right answer to a find-service now */
uint64_t book_answer(int service);
void book_check_copies(void);
names book_group(int group);
names book_shown(int service);

#endif
