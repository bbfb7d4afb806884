/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file journal.h
 * What is to be on disk, and how its owner gets it from there and back.
 */
#ifndef MUSTER_BROKER_JOURNAL_H
#define MUSTER_BROKER_JOURNAL_H

#include "broker/directory/directory.h"

/* --- journal.c ------------------------------------------------------------------------------- */

/*
 * What must be on disk before any process is told.
 *
 * The broker's parts say what has changed; the owner of the disk takes it from here, in one
 * transaction, and says how that went:
 *
 *     while (journal_wanted(b, &level)) {       at most once a round, before anything is delivered
 *         begin; while (journal_next(b, &entry)) write entry; commit;
 *         durable_committed(b, ok, now_ns);
 *     }
 *
 * Nothing is copied: a change is a mark on a mail, a name or a line, and what is written is how
 * that stands at the commit.  So the journal is bounded by what it keeps account of, and a mail
 * that came and went in one round costs nothing.
 *
 * After a failure new durable mail is refused and the rest stays marked; it is tried again a
 * second later.
 */

enum {
    JOURNAL_BUCKETS = 65536,
    JOURNAL_WAITING_BYTES = REGISTRY_MAX * (MU_NAME_MAX + 1) + 32,
    JOURNAL_RESERVE = 1 << 20, /* numbers of a sender that are reserved at once */
};

/* No row, stamp or incarnation of a broker goes so far; what stands in a file may. */
#define JOURNAL_NUMBER_MAX ((uint64_t)INT64_MAX / 2)

enum journal_kind {
    JOURNAL_AGENT,    /* name, kind, durable_seq, failed_seq, reserved_seq */
    JOURNAL_MAIL,     /* row, letter, waiting, expires_wall_ns */
    JOURNAL_WAITING,  /* row, waiting: some receivers have settled it */
    JOURNAL_GONE,     /* row to last_row: these are not waited for */
    JOURNAL_LINE,     /* lines, slot, line; present false and no key: the slot is free */
    JOURNAL_RESET,    /* lines: all earlier ones of that kind are void */
    JOURNAL_CLOCK,    /* run_wall_ns */
    JOURNAL_SNAPSHOT, /* name, epoch, snapshot */
};

/* One row on its way to the disk, or from it. */
/* The kind of an agent whose name has ended. */
#define JOURNAL_ENDED ((muster_Kind)255)

struct journal_entry {
    enum journal_kind kind;
    const char *name;       /* of an agent */
    muster_Kind agent_kind; /* or JOURNAL_ENDED */
    uint64_t durable_seq, failed_seq, reserved_seq;
    uint64_t row, last_row;
    muster_Mail letter;
    const char *waiting;      /* names, joined by commas; behind a slash, pool_mail_standing */
    uint64_t expires_wall_ns; /* nanoseconds since 1970; 0: never */
    enum lines_kind lines;
    uint32_t slot;
    struct line_word line;
    uint64_t run_wall_ns; /* when the run's time was 0; 0: no run goes on by the wall */
    uint64_t epoch;
    const char *snapshot; /* of that agent; "": it has none any more */
};

struct journal_lines {
    uint64_t saved; /* their version that is on disk */
    bool reset;     /* lines of an earlier life are still there */
};

/* Where journal_next goes on. */
struct journal_cursor {
    uint32_t agent;
    struct mail *mail;
    enum lines_kind lines;
    uint32_t line, gone; /* the next one that has changed, or is no more */
    uint32_t snapshot;
    bool clock_done, begun;
};

struct journal {
    bool on;
    bool failing;
    uint64_t awaits_ns; /* until then the first of the agents that are not there may still come
                           back: see struct agent; UINT64_MAX: none may */
    uint64_t retry_ns;
    uint64_t rows;                 /* the last row of a mail */
    struct mail_list mails;        /* that are marked, in order of routing */
    uint32_t agents[REGISTRY_MAX]; /* marked names */
    uint32_t agents_count;
    struct journal_lines lines[LINES_KINDS];
    uint64_t run_wall_ns;                  /* as it is on disk */
    struct mail *buckets[JOURNAL_BUCKETS]; /* durable mails by sender and number */
    struct journal_cursor at;
    char text[JOURNAL_WAITING_BYTES]; /* for the names of a mail's receivers */
    uint64_t commits, failures;       /* counters */
};

/** @return whether the state has changed */
bool mail_durable_on(struct mail *m, enum mail_durable_event event);

/* --- for the parts of the broker -------------------------------------------------------------- */

/** @return whether durable mail can be taken now */
bool journal_takes(const struct broker *b);

/** A mail stands in boxes.  It is marked if it is durable, and with it what its sender has sent
 * before, and still waits; other mail is passed over. */
void journal_put(struct broker *b, struct mail *m);

/** The next durable mail of its sender takes this one, which is in RAM, along to the store. */
void journal_note_ram(struct broker *b, const struct mail *m);

/** An agent has acknowledged a mail that is on disk. */
void journal_acknowledged(struct broker *b, uint32_t agent);

uint32_t journal_room_left(const struct journal *j, const struct mailbox *m, uint32_t agent);

/**
 * A receiver need not remember more than a window of mails that may come again, so no more go out
 * before its acknowledgements are on disk.
 *
 * @return how many mails of the store the agent may be handed now
 */
static inline uint32_t journal_room(const struct journal *j, const struct mailbox *m,
                                    uint32_t agent)
{
    return j->failing ? journal_room_left(j, m, agent) : UINT32_MAX;
}

/** A mail was not delivered, whether it stood in boxes or not: later lives do not say that it was.
 */
void journal_failed(struct broker *b, uint32_t sender, const muster_Mail *letter);

/** A receiver is through with a durable mail: m->posts says which are not.  Call before the last
 * use of it ends. */
void journal_settled(struct broker *b, struct mail *m);

/** A name is there, or its kind has changed. */
void journal_agent(struct broker *b, uint32_t agent);

/** A name has ended: its numbers stay.  @return whether the disk knows that, if it knew the name */
bool journal_end(struct broker *b, uint32_t agent);

/** A sender's mails have come up to another number. */
void journal_seq(struct broker *b, uint32_t agent);

/** A durable mail that is on disk can be found. */
void journal_enter(struct journal *j, struct mail *m);

struct mail *journal_look(struct journal *j, uint32_t sender, uint64_t seq);

/** @return a durable mail that waits, or NULL */
static inline struct mail *journal_find(struct journal *j, uint32_t sender, uint64_t seq)
{
    return j->on ? journal_look(j, sender, seq) : NULL;
}

/** @return the groups or the services */
struct lines *journal_table(struct broker *b, enum lines_kind lines);

/* --- for the owner of the disk ---------------------------------------------------------------- */

/**
 * @param level  out: what the transaction has to survive
 * @return whether there is anything to write now
 */
bool journal_wanted(struct broker *b, muster_Level *level);

/** Gives the next change, valid until the next call.  @return false when that was all */
bool journal_next(struct broker *b, struct journal_entry *entry);

void journal_remove(struct journal *j, struct mail *m);

/** When the run that goes on by the wall was at 0; the time of steps stands still without us. */
uint64_t journal_run_wall_ns(const struct broker *b);

#endif
