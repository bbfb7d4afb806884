/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file journal.h
 * What must be on disk before anybody is told.
 *
 * The broker's parts say what has changed; whoever has the disk takes it from here, in one
 * transaction, and says how that went:
 *
 *     while (journal_wanted(b, &level)) {       at most once a round, before anything is delivered
 *         begin; while (journal_next(b, &entry)) write entry; commit;
 *         journal_committed(b, ok, now_ns);
 *     }
 *
 * Nothing is copied: a change is a mark on a mail, a name or a line, and what is written is how
 * that stands at the commit.  So the journal is bounded by what it keeps account of, and a mail
 * that came and went in one round costs nothing.
 *
 * After a failure new durable mail is refused and the rest stays marked; it is tried again a
 * second later.
 */
#ifndef MUSTER_BROKER_JOURNAL_H
#define MUSTER_BROKER_JOURNAL_H

#include "broker/base/store.h"
#include "broker/names/registry.h"
#include "wire.h"

struct broker;

enum {
    JOURNAL_BUCKETS = 65536,
    JOURNAL_WAITING_BYTES = REGISTRY_MAX * (MU_NAME_MAX + 1) + 32,
    JOURNAL_RESERVE = 1 << 20, /* numbers of a sender that are reserved at once */
};

/* No row, stamp or incarnation of a broker goes so far; what stands in a file may. */
#define JOURNAL_NUMBER_MAX ((uint64_t)INT64_MAX / 2)

/* Lines of other parts: each part numbers its own from 0. */
enum journal_lines { JOURNAL_GROUPS, JOURNAL_SERVICES, JOURNAL_LINE_KINDS };

struct journal_line {
    const char *key;        /* the group, the service */
    const char *agent;      /* "": the line is of the key alone */
    bool present;           /* false: joined no more, withdrawn */
    const char *attributes; /* "" when it has none */
    const char *origin;     /* the broker that it was said to */
    uint64_t lease_ns, stamp_ns;
};

/* A part that has lines. */
struct journal_source {
    uint32_t capacity; /* its slots */
    /** Fills a line with pointers into the part.  @return false: the slot is free */
    bool (*line)(struct broker *b, uint32_t slot, struct journal_line *out);
    /** Takes in a line of an earlier life, at any slot.  @return false: it does not fit */
    bool (*restore)(struct broker *b, const struct journal_line *line);
};

enum journal_kind {
    JOURNAL_AGENT,   /* name, kind, durable_seq, failed_seq, reserved_seq */
    JOURNAL_MAIL,    /* row, letter, waiting, expires_wall_ns */
    JOURNAL_WAITING, /* row, waiting: some receivers have settled it */
    JOURNAL_GONE,    /* row to last_row: nobody waits for these */
    JOURNAL_LINE,    /* lines, slot, line; present false and no key: the slot is free */
    JOURNAL_RESET,   /* lines: all earlier ones of that kind are void */
    JOURNAL_CLOCK,   /* run_wall_ns */
    JOURNAL_CAPSULE, /* name, epoch, capsule */
};

/* One row on its way to the disk, or from it. */
struct journal_entry {
    enum journal_kind kind;
    const char *name; /* of an agent */
    muster_Kind agent_kind;
    uint64_t durable_seq, failed_seq, reserved_seq;
    uint64_t row, last_row;
    muster_Mail letter;
    const char *waiting;      /* names, joined by commas; behind a slash, outcome_so_far */
    uint64_t expires_wall_ns; /* nanoseconds since 1970; 0: never */
    enum journal_lines lines;
    uint32_t slot;
    struct journal_line line;
    uint64_t run_wall_ns; /* when the run's time was 0; 0: no run goes on by the wall */
    uint64_t epoch;
    const char *capsule; /* of that agent; "": it has none any more */
};

struct journal_slots {
    const struct journal_source *source; /* NULL: nobody has such lines */
    uint32_t *marked;
    bool *is_marked; /* for each slot */
    uint32_t count;
    bool reset; /* lines of an earlier life are still on disk */
};

/* Where journal_next goes on. */
struct journal_cursor {
    uint32_t agent;
    struct mail *mail;
    enum journal_lines lines;
    uint32_t line;
    uint32_t capsule;
    bool clock_done, begun;
};

struct journal {
    bool on;
    bool failing;
    bool awaits;        /* agents that are not there may still come back: see struct agent */
    uint64_t awaits_ns; /* until then, the first of them */
    uint64_t retry_ns;
    uint64_t rows;             /* the last row of a mail */
    struct mail *first, *last; /* mails that are marked, in order of routing */
    uint32_t *agents;          /* marked names: REGISTRY_MAX */
    uint32_t agents_count;
    struct journal_slots slots[JOURNAL_LINE_KINDS];
    uint64_t run_wall_ns;  /* as it is on disk */
    struct mail **buckets; /* durable mails by sender and number: JOURNAL_BUCKETS */
    struct journal_cursor at;
    char *text;                 /* for the names of a mail's receivers */
    uint64_t commits, failures; /* counters */
};

void journal_init(struct journal *j, bool on);

/* --- for the parts of the broker -------------------------------------------------------------- */

/** @return whether durable mail can be taken now */
bool journal_takes(const struct broker *b);

/** A mail stands in boxes.  It is marked if it is durable, and with it what its sender has sent
 * before, and still waits; other mail is passed over. */
void journal_put(struct broker *b, struct mail *m);

/** An agent has acknowledged a mail. */
void journal_acknowledged(struct broker *b, uint32_t agent, const struct mail *m);

/**
 * A receiver need not remember more than a window of mails that may come again, so no more go out
 * before its acknowledgements are on disk.
 *
 * @return how many mails of the store the agent may be handed now
 */
uint32_t journal_room(const struct broker *b, uint32_t agent);

/** A mail was not delivered, whether it stood in boxes or not: later lives do not say that it was.
 */
void journal_failed(struct broker *b, uint32_t sender, const muster_Mail *letter);

/** A receiver is through with a mail: m->unsettled says how many are not.  Call before the last
 *  use of it ends. */
void journal_settled(struct broker *b, struct mail *m);

/** A name is there, or its kind has changed. */
void journal_agent(struct broker *b, uint32_t agent);

/** A sender's mails have come up to another number. */
void journal_seq(struct broker *b, uint32_t agent);

/** A durable mail that is on disk can be found. */
void journal_enter(struct journal *j, struct mail *m);

/** @return a durable mail that waits, or NULL */
struct mail *journal_find(const struct journal *j, uint32_t sender, uint64_t seq);

/** A part will have lines.  Takes memory at start-up; source must stay. */
void journal_attach(struct broker *b, enum journal_lines lines,
                    const struct journal_source *source);

/** A line has changed, come or gone. */
void journal_line_changed(struct broker *b, enum journal_lines lines, uint32_t slot);

/** An agent has gone without a word: its receipts are kept until it is back, or for 10 s. */
void journal_await(struct broker *b, uint32_t agent);

/** Who has not come back by now is not awaited any more. */
void journal_tick(struct broker *b);

/** @return when journal_tick, or a failed commit, is due, or UINT64_MAX */
uint64_t journal_deadline_ns(const struct broker *b);

/* --- for whoever has the disk ----------------------------------------------------------------- */

/**
 * @param level  out: what the transaction has to survive
 * @return whether there is anything to write now
 */
bool journal_wanted(struct broker *b, muster_Level *level);

/** Gives the next change, valid until the next call.  @return false when that was all */
bool journal_next(struct broker *b, struct journal_entry *entry);

/** All that journal_next gave since journal_wanted is on disk, or nothing of it is. */
void journal_committed(struct broker *b, bool ok, uint64_t now_ns);

/**
 * Takes in what an earlier life has left: names, then lines, clock and mails in order of row, and
 * before anything else happens.
 *
 * @return false: it is malformed, or there is no room; a mail stays on disk, a line until the lines
 *         of its kind are written again
 */
bool journal_restore(struct broker *b, const struct journal_entry *entry);

#endif
