/* SPDX-License-Identifier: Apache-2.0 */

#include "broker/node/disk_parts.h"
#include "core/log.h"

#include <stdio.h>

/* The log grows to so many pages of 4 kB before it is copied into the file while mail pours in. */
enum { LOG_PAGES_MAX = 4096 };

/* So long nothing must have been written for the log to be copied in a quiet moment. */
static const uint64_t QUIET_NS = 1000000000;

/* --- transactions ----------------------------------------------------------------------------- */

static bool entry_write(struct disk *d, const struct journal_entry *e)
{
    enum disk_statement s = DISK_STATEMENTS;
    switch (e->kind) {
    case JOURNAL_MAIL: return disk_bundle_put(d, e);
    case JOURNAL_GONE: return disk_bundle_drop(d, e);
    case JOURNAL_AGENT: s = DISK_PUT_AGENT; break;
    case JOURNAL_WAITING: s = DISK_PUT_WAITS; break;
    case JOURNAL_LINE: s = e->line.key ? DISK_PUT_LINE : DISK_DROP_LINE; break;
    case JOURNAL_RESET: s = DISK_DROP_LINES; break;
    case JOURNAL_CLOCK: s = DISK_PUT_CLOCK; break;
    case JOURNAL_SNAPSHOT: s = e->snapshot[0] ? DISK_PUT_SNAPSHOT : DISK_DROP_SNAPSHOT; break;
    }
    return disk_row_put(d->statements[s], e);
}

static bool entries_write(struct disk *d, struct broker *b)
{
    struct journal_entry e;
    disk_bundle_begin(d);
    while (journal_next(b, &e)) {
        if (!entry_write(d, &e)) {
            return false;
        }
    }
    return disk_bundle_end(d);
}

/* The pragma means nothing inside a transaction, so it comes before. */
static bool sync_set(struct disk *d, bool full)
{
    if (d->full_sync != full &&
        !disk_run(d, full ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL")) {
        return false;
    }
    d->full_sync = full;
    return true;
}

static void trouble_tell(struct disk *d, bool ok, const char *why)
{
    if (!ok && !d->troubled) {
        mu_log(MU_LOG_ERROR, "store-cannot-write",
               "file=%s error=\"%s\" durable mail is refused until it can", d->path, why);
    } else if (ok && d->troubled) {
        mu_log(MU_LOG_WARNING, "store-writes-again", "file=%s", d->path);
    }
    d->troubled = !ok;
}

/* @return whether the log is there */
static bool log_stat(const struct disk *d, struct stat *out)
{
    char path[PATH_MAX + sizeof "-wal"];
    snprintf(path, sizeof path, "%s-wal", d->path);
    return stat(path, out) == 0;
}

/* It comes with the first commit, and stays until the store is closed. */
static void log_note(struct disk *d)
{
    if (d->log.st_ino == 0 && !log_stat(d, &d->log)) {
        d->log.st_ino = 0;
    }
}

static bool is_same(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

static bool disk_has_moved(struct disk *d)
{
    struct stat now;
    if (stat(d->path, &now) != 0 || !is_same(&now, &d->file)) {
        return true;
    }
    return d->log.st_ino != 0 && (!log_stat(d, &now) || !is_same(&now, &d->log));
}

static void log_copy(struct disk *d, int how)
{
    /* What cannot be copied now stays in the log, where it is as safe. */
    if (sqlite3_wal_checkpoint_v2(d->db, NULL, how, NULL, NULL) == SQLITE_OK) {
        d->log_pages = 0;
    }
}

bool disk_commit(struct disk *d, struct broker *b, muster_Level level, uint64_t now_ns)
{
    char why[128] = "";
    bool written = sync_set(d, level == muster_LEVEL_SYNCED) &&
                   disk_step(d->statements[DISK_BEGIN]) &&
                   (!d->unbegun || disk_incarnation_put(d)) && entries_write(d, b);
    bool moved = written && disk_has_moved(d);
    bool ok = written && !moved && disk_step(d->statements[DISK_COMMIT]);
    if (ok) {
        d->unbegun = false;
        log_note(d);
    } else {
        snprintf(why, sizeof why, "%s",
                 moved ? "it was removed or replaced while it was in use" : sqlite3_errmsg(d->db));
        if (!sqlite3_get_autocommit(d->db)) {
            (void)disk_step(d->statements[DISK_ROLLBACK]);
        }
    }
    trouble_tell(d, ok, why);
    d->wrote_ns = now_ns;
    if (ok && d->log_pages > LOG_PAGES_MAX) {
        log_copy(d, SQLITE_CHECKPOINT_PASSIVE);
    }
    durable_committed(b, ok, now_ns);
    return ok;
}

void disk_rest(struct disk *d, uint64_t now_ns)
{
    if (d->log_pages > 0 && now_ns - d->wrote_ns > QUIET_NS) {
        log_copy(d, SQLITE_CHECKPOINT_TRUNCATE);
        d->wrote_ns = now_ns;
    }
}

void disk_close(struct disk *d)
{
    for (int i = 0; i < DISK_STATEMENTS; i++) {
        sqlite3_finalize(d->statements[i]);
    }
    if (d->file.st_ino != 0 && disk_has_moved(d)) { /* what bears its name now is not ours */
        (void)sqlite3_db_config(d->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    }
    sqlite3_close(d->db); /* copies the log into the file, and removes it */
}

bool disk_incarnation_put(struct disk *d)
{
    char sql[160];
    snprintf(sql, sizeof sql,
             "INSERT OR REPLACE INTO meta VALUES ('incarnation', %lld), ('number_base', %lld)",
             (long long)d->incarnation, (long long)d->number_base);
    return disk_run(d, sql);
}
