/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file disk_parts.h
 * What the files of the store share.
 */
#ifndef MUSTER_BROKER_DISK_PARTS_H
#define MUSTER_BROKER_DISK_PARTS_H

#include "broker/node/node.h"
#include "core/text.h"

#include <limits.h>
#include <sqlite3.h>
#include <sys/stat.h>

/* Mails in one bundle. */
enum { DISK_BUNDLE_MAILS = 256 };

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
    DISK_PUT_META,
    DISK_PUT_CAPSULE,
    DISK_DROP_CAPSULE,
    DISK_STATEMENTS
};

/* New mails of one transaction whose numbers follow each other; see disk_bundle.h. */
struct disk_bundle {
    struct mu_text text; /* JSON, without the last bracket */
    uint64_t first;
    uint32_t count;
};

struct disk {
    sqlite3 *db;
    sqlite3_stmt *statements[DISK_STATEMENTS];
    char path[PATH_MAX];
    uint64_t incarnation, number_base;
    struct disk_bundle bundle;
    struct stat file, log; /* what was opened; log.st_ino 0: there was none yet */
    bool unbegun;          /* its incarnation is not on disk yet: the next commit has it */
    bool full_sync;        /* as PRAGMA synchronous stands */
    bool troubled;         /* the last commit failed, and the log has it */
    int log_pages;         /* in the write-ahead log, not yet in the file */
    uint64_t wrote_ns;
};

/** The kind of a name that has ended, in the store. */
#define DISK_ENDED "ended"

/** The words for lines in the store, one for each enum lines_kind. */
extern const char *const disk_line_words[LINES_KINDS];

/** @return whether the script ran; if not, sqlite3_errmsg says why */
bool disk_run(struct disk *d, const char *sql);

/** @return whether a statement without rows ran; it can be bound anew */
bool disk_step(sqlite3_stmt *statement);

/** Notes this life in the store.  @return whether it went */
bool disk_incarnation_put(struct disk *d);

#endif
