/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file disk_parts.h
 * What the files of the store share.
 */
#ifndef MUSTER_BROKER_DISK_PARTS_H
#define MUSTER_BROKER_DISK_PARTS_H

#include "broker/node/node.h"

#include <limits.h>
#include <sqlite3.h>
#include <sys/stat.h>

enum {
    DISK_BUNDLE_MAILS = 256,
    DISK_BUNDLE_BYTES = 32 * 1024, /* a bundle that has so much takes no more mail */
    /* The largest mail: a byte of a string is six in JSON at most. */
    DISK_MAIL_BYTES = 6 * POOL_RECORD_MAX + JOURNAL_WAITING_BYTES + 1024,
};

enum { DISK_SCHEMA = 3, DISK_SCHEMA_OLD = 2, DISK_APPLICATION = 0x6d757374 /* "must" */ };

enum disk_statement {
    DISK_BEGIN,
    DISK_COMMIT,
    DISK_ROLLBACK,
    DISK_PUT_AGENT,
    DISK_PUT_BUNDLE,
    DISK_FIND_BUNDLE,
    DISK_DROP_BUNDLE,
    DISK_PUT_SETTLED,
    DISK_DROP_SETTLED,
    DISK_PUT_WAITS,
    DISK_DROP_WAITS,
    DISK_PUT_LINE,
    DISK_DROP_LINE,
    DISK_DROP_LINES,
    DISK_PUT_CLOCK,
    DISK_PUT_SNAPSHOT,
    DISK_DROP_SNAPSHOT,
    DISK_STATEMENTS
};

/* New mails of one transaction whose numbers follow each other. */
struct disk_bundle {
    struct mu_text text; /* JSON, without the last bracket */
    char buffer[DISK_BUNDLE_BYTES + DISK_MAIL_BYTES];
    uint64_t first;
    uint32_t count;
};

struct disk {
    sqlite3 *db;
    sqlite3_stmt *statements[DISK_STATEMENTS];
    char path[PATH_MAX];
    uint64_t
        incarnation; /* above all that earlier brokers on this store had; the time if it can be */
    uint64_t number_base; /* far above all that boxes of earlier brokers on it have counted */
    struct disk_bundle bundle;
    struct stat file, log; /* what was opened; log.st_ino 0: there was none yet */
    bool unbegun;          /* its incarnation is not on disk yet: the next commit has it */
    bool full_sync;        /* as PRAGMA synchronous stands */
    bool troubled;         /* the last commit failed, and the log has it */
    int log_pages;         /* in the write-ahead log, not yet in the file */
    uint64_t wrote_ns;
};

/** @return whether the script ran; if not, sqlite3_errmsg says why */
static inline bool disk_run(struct disk *d, const char *sql)
{
    return sqlite3_exec(d->db, sql, NULL, NULL, NULL) == SQLITE_OK;
}

/** @return whether a statement without rows ran; it can be bound anew */
static inline bool disk_step(sqlite3_stmt *statement)
{
    int result = sqlite3_step(statement);
    (void)sqlite3_reset(statement); /* says again what the step has said */
    return result == SQLITE_DONE;
}

/** Notes this life in the store.  @return whether it went */
bool disk_incarnation_put(struct disk *d);

/* --- disk_rows.c ----------------------------------------------------------------------------- */

/** Runs a statement with as many fields of an entry as it has parameters.  @return whether it ran
 */
bool disk_row_put(sqlite3_stmt *statement, const struct journal_entry *e);

/** Reads a row into an entry of its kind; its texts are valid until the next row. */
void disk_row_take(sqlite3_stmt *statement, struct journal_entry *e);

/** Adds a new mail to the JSON of a bundle. */
void disk_row_add_mail(struct mu_text *t, const struct journal_entry *e);

/* --- disk_bundle.c --------------------------------------------------------------------------- */

/*
 * Mails on disk: those of one transaction lie in few rows.
 *
 * A row for each mail costs more than all else that the store does for it.  So mails whose numbers
 * follow each other are a bundle: one text, a JSON list, that is written once, and beside it a
 * short row that says which of them are still waited for.  The bundle goes with the last of
 * them.  The view `mails` shows one line a mail all the same.
 */

/** Makes the tables, and a view that shows a line a mail; for sqlite3_exec. */
extern const char disk_bundle_tables[];

/** Gives the lines of that view in order of number, as disk_row_take reads them. */
extern const char disk_bundle_select[];

/** Moves the mails of a store of version 2 from their rows into bundles. */
extern const char disk_bundle_upgrade[];

/** A transaction begins: nothing is in hand. */
void disk_bundle_begin(struct disk *d);

/** Takes a new mail into the bundle in hand, and writes that when it is full.  @return whether
 *  nothing failed */
bool disk_bundle_put(struct disk *d, const struct journal_entry *e);

/** Writes what is in hand; before the transaction ends.  @return whether nothing failed */
bool disk_bundle_end(struct disk *d);

/** The mails e->row to e->last_row are not waited for.  @return whether nothing failed */
bool disk_bundle_drop(struct disk *d, const struct journal_entry *e);

#endif
