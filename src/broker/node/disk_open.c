/* SPDX-License-Identifier: Apache-2.0 */

#include "broker/node/disk_parts.h"
#include "core/log.h"
#include "core/paths.h"
#include "muster/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Comments stand in the file, too: `.schema` shows them. */
static const char schema[] =
    "PRAGMA application_id = 1836413812;"
    "CREATE TABLE meta (key TEXT PRIMARY KEY, value) WITHOUT ROWID;"
    "CREATE TABLE agents (name TEXT PRIMARY KEY, kind TEXT,\n"
    "  durable_seq INTEGER,  -- the last of its mails that was stored\n"
    "  reserved_seq INTEGER, -- a later process of that name goes on after this number\n"
    "  failed_seq INTEGER    -- the last that was meant for the store and not delivered\n"
    ") WITHOUT ROWID;"
    "CREATE TABLE lines (kind TEXT, slot INTEGER, key TEXT, agent TEXT, present INTEGER,\n"
    "  attributes TEXT, lease_ns INTEGER, stamp_ns INTEGER, origin TEXT,\n"
    "  PRIMARY KEY (kind, slot)) WITHOUT ROWID;"
    "INSERT INTO meta VALUES ('schema', 3), ('store', lower(hex(randomblob(8)))),"
    "  ('incarnation', 0), ('run_wall_ns', 0);";

/* Not in the first stores of this version. */
static const char snapshots[] =
    "CREATE TABLE IF NOT EXISTS capsules (agent TEXT PRIMARY KEY, epoch INTEGER,\n"
    "  text TEXT -- a passport and the capsule: an agent on its way, to be restored\n"
    ") WITHOUT ROWID;";

/* Version 2 had a row for each mail. */
static const char rename_mails[] = "ALTER TABLE mails RENAME TO mails_2;";
static const char upgraded[] =
    "DROP TABLE mails_2; UPDATE meta SET value = 3 WHERE key = 'schema';";

static const char *const statements[DISK_STATEMENTS] = {
    [DISK_BEGIN] = "BEGIN IMMEDIATE",
    [DISK_COMMIT] = "COMMIT",
    [DISK_ROLLBACK] = "ROLLBACK",
    [DISK_PUT_AGENT] = "INSERT OR REPLACE INTO agents VALUES (?, ?, ?, ?, ?)",
    [DISK_PUT_BUNDLE] = "INSERT INTO bundles VALUES (?, ?, ?)",
    [DISK_FIND_BUNDLE] = "SELECT b.id, count, alive FROM bundles AS b LEFT JOIN settled AS s"
                         " ON s.id = b.id WHERE b.id BETWEEN 1 AND ? ORDER BY b.id DESC LIMIT 1",
    [DISK_DROP_BUNDLE] = "DELETE FROM bundles WHERE id = ?",
    [DISK_PUT_SETTLED] = "INSERT OR REPLACE INTO settled VALUES (?, ?)",
    [DISK_DROP_SETTLED] = "DELETE FROM settled WHERE id = ?",
    [DISK_PUT_WAITS] = "INSERT OR REPLACE INTO waits VALUES (?, ?)",
    [DISK_DROP_WAITS] = "DELETE FROM waits WHERE id BETWEEN ? AND ?",
    [DISK_PUT_LINE] = "INSERT OR REPLACE INTO lines VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
    [DISK_DROP_LINE] = "DELETE FROM lines WHERE kind = ? AND slot = ?",
    [DISK_DROP_LINES] = "DELETE FROM lines WHERE kind = ?",
    [DISK_PUT_CLOCK] = "INSERT OR REPLACE INTO meta VALUES ('run_wall_ns', ?)",
    [DISK_PUT_SNAPSHOT] = "INSERT OR REPLACE INTO capsules VALUES (?, ?, ?)",
    [DISK_DROP_SNAPSHOT] = "DELETE FROM capsules WHERE agent = ?",
};

/* --- what can be wrong ------------------------------------------------------------------------ */

static mu_result complain(mu_result result, const char *path, const char *what, const char *advice)
{
    fprintf(stderr, "muster broker: %s: %s\n  %s\n", path, what, advice);
    return result;
}

static mu_result complain_damaged(const struct disk *d, const char *what)
{
    return complain(MU_FAULT_FILE, d->path, what,
                    "it was left as it is: move it away, or save what can be read with"
                    " `sqlite3 FILE .recover | sqlite3 NEW`, or give another --store FILE");
}

/* What SQLite has against the file. */
static mu_result complain_of(const struct disk *d)
{
    static const char where[] = "give another --store FILE, or --store none";
    switch (sqlite3_errcode(d->db) & 0xff) {
    case SQLITE_NOTADB:
        return complain(MU_FAULT_FILE, d->path, "this is no store of a broker",
                        "it was left as it is: give another --store FILE");
    case SQLITE_CORRUPT: return complain_damaged(d, "the store is damaged");
    case SQLITE_BUSY:
        return complain(MU_FAULT_OS, d->path, "the store is in use by another process",
                        "a broker that runs, or an open sqlite3 shell: end it, or give another"
                        " --store FILE");
    case SQLITE_ERROR: return complain_damaged(d, sqlite3_errmsg(d->db));
    default: return complain(MU_FAULT_OS, d->path, sqlite3_errmsg(d->db), where);
    }
}

/* --- opening ---------------------------------------------------------------------------------- */

static bool value_read(struct disk *d, const char *sql, int64_t *out)
{
    sqlite3_stmt *s = NULL;
    bool got =
        sqlite3_prepare_v2(d->db, sql, -1, &s, NULL) == SQLITE_OK && sqlite3_step(s) == SQLITE_ROW;
    *out = got ? sqlite3_column_int64(s, 0) : 0;
    return sqlite3_finalize(s) == SQLITE_OK && got;
}

/* Those that the next life goes on from.  Receivers take no number from its upper half.  A store
 * that notes no base has had lives that counted from their incarnation. */
static mu_result numbers_read(struct disk *d)
{
    int64_t last, base;
    if (!value_read(d, "SELECT value FROM meta WHERE key = 'incarnation'", &last) ||
        !value_read(d,
                    "SELECT coalesce((SELECT value FROM meta WHERE key = 'number_base'),"
                    " (SELECT value FROM meta WHERE key = 'incarnation'))",
                    &base)) {
        return complain_of(d);
    }
    d->incarnation = (uint64_t)last;
    d->number_base = (uint64_t)base;
    return d->incarnation <= JOURNAL_NUMBER_MAX && d->number_base <= JOURNAL_NUMBER_MAX
               ? MU_OK
               : complain_damaged(d, "the store is damaged");
}

/* Is this file ours, and whole?  Nothing in it is changed.  version: 0 for a new one */
static mu_result file_check(struct disk *d, int64_t *version)
{
    int64_t application, tables;
    if (!value_read(d, "PRAGMA application_id", &application) ||
        !value_read(d, "SELECT count(*) FROM sqlite_schema", &tables)) {
        return complain_of(d);
    }
    *version = 0;
    if (application == 0 && tables == 0) {
        return MU_OK;
    }
    if (application != DISK_APPLICATION) {
        return complain(MU_FAULT_FILE, d->path, "this is a database of another program",
                        "it was left as it is: give another --store FILE");
    }
    if (!value_read(d, "SELECT value FROM meta WHERE key = 'schema'", version)) {
        return complain_of(d);
    }
    if (*version != DISK_SCHEMA && *version != DISK_SCHEMA_OLD) {
        char what[96];
        snprintf(what, sizeof what, "a store of version %lld; this broker knows version %d",
                 (long long)*version, DISK_SCHEMA);
        return complain(MU_FAULT_FILE, d->path, what,
                        "it was left as it is: use the broker that wrote it, or give another"
                        " --store FILE");
    }
    return numbers_read(d);
}

static mu_result pages_check(struct disk *d)
{
    int64_t whole;
    bool read = value_read(d, "SELECT quick_check = 'ok' FROM pragma_quick_check(1)", &whole);
    return read && whole ? MU_OK : complain_damaged(d, "the store is damaged");
}

static int on_commit(void *self, sqlite3 *db, const char *name, int pages)
{
    (void)db;
    (void)name;
    ((struct disk *)self)->log_pages = pages;
    return SQLITE_OK;
}

static uint64_t greater(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* What is stored can be handed out all the same. */
static bool is_full(struct disk *d)
{
    int code = sqlite3_extended_errcode(d->db);
    return code == SQLITE_FULL || code == SQLITE_IOERR_WRITE || code == SQLITE_IOERR_FSYNC ||
           code == SQLITE_IOERR_TRUNCATE;
}

/* Of two brokers with one name the higher incarnation gives way: it is the time, and hardly ever
 * more.  Boxes count on beyond all that the last life can have given out, though a wall clock may
 * go back. */
static bool incarnation_begin(struct disk *d, uint64_t wall_ns)
{
    static const uint64_t NUMBERS_OF_A_LIFE = 1ull << 40;
    d->incarnation = greater(wall_ns, d->incarnation + 1);
    d->number_base = greater(wall_ns, d->number_base ? d->number_base + NUMBERS_OF_A_LIFE : 1);
    d->unbegun = !disk_incarnation_put(d);
    return !d->unbegun || is_full(d);
}

static bool statements_prepare(struct disk *d)
{
    for (int i = 0; i < DISK_STATEMENTS; i++) {
        if (sqlite3_prepare_v3(d->db, statements[i], -1, SQLITE_PREPARE_PERSISTENT,
                               &d->statements[i], NULL) != SQLITE_OK) {
            return false;
        }
    }
    return true;
}

/* @param scripts  up to NULL */
static bool scripts_run(struct disk *d, const char *const *scripts)
{
    bool good = disk_run(d, "BEGIN IMMEDIATE");
    for (; *scripts && good; scripts++) {
        good = disk_run(d, *scripts);
    }
    return good && disk_run(d, "COMMIT");
}

/* Makes a new file a store, or one of the version before a store of this one.  @return false: it
 * is as it was */
static bool schema_set(struct disk *d, int64_t version)
{
    static const char *const make[] = {schema, disk_bundle_tables, NULL};
    static const char *const upgrade[] = {rename_mails, disk_bundle_tables, disk_bundle_upgrade,
                                          upgraded, NULL};
    return version == DISK_SCHEMA || scripts_run(d, version == 0 ? make : upgrade);
}

/* A broker that was killed holds its store until the kernel has freed its files. */
enum { HANDOVER_MS = 2000 };

static mu_result store_begin(struct disk *d, uint64_t wall_ns)
{
    int64_t version;
    sqlite3_busy_timeout(d->db, HANDOVER_MS);
    /* Exclusive locking keeps a second broker out, and the log's index in our own memory. */
    bool is_set = disk_run(d, "PRAGMA locking_mode = EXCLUSIVE; PRAGMA mmap_size = 0;"
                              "PRAGMA cache_size = -1024; PRAGMA temp_store = MEMORY");
    mu_result checked = is_set ? file_check(d, &version) : complain_of(d);
    if (checked != MU_OK) {
        return checked;
    }
    if (version != 0 && pages_check(d) != MU_OK) {
        return MU_FAULT_FILE;
    }
    if (sqlite3_db_readonly(d->db, "main")) {
        return complain(MU_FAULT_OS, d->path, "the store cannot be written",
                        "see its permissions, or give another --store FILE, or --store none");
    }
    d->full_sync = true;
    bool begun = disk_run(d, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL") &&
                 schema_set(d, version) && disk_run(d, snapshots) &&
                 incarnation_begin(d, wall_ns) && statements_prepare(d) &&
                 sqlite3_db_release_memory(d->db) == SQLITE_OK;
    if (d->unbegun) {
        mu_log(MU_LOG_ERROR, "store-cannot-write",
               "file=%s durable mail is refused until it can: the disk is full", d->path);
        d->troubled = true;
    }
    sqlite3_wal_hook(d->db, on_commit, d); /* in place of checkpoints at SQLite's own times */
    return begun && stat(d->path, &d->file) == 0 ? MU_OK : complain_of(d);
}

mu_result disk_open(struct disk **out, const char *path, uint64_t wall_ns)
{
    struct disk *d = mu_startup_alloc(sizeof *d);
    mu_text_init(&d->bundle.text, d->bundle.buffer, sizeof d->bundle.buffer);
    if (!mu_text_copy(d->path, sizeof d->path, path) || !mu_path_make_folders(d->path, 0700)) {
        return complain(MU_FAULT_OS, path, strerror(errno),
                        "give another --store FILE, or --store none");
    }
    sqlite3_config(SQLITE_CONFIG_SINGLETHREAD); /* one thread uses it */
    sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0);
    int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
    mu_result result = sqlite3_open_v2(path, &d->db, flags, NULL) == SQLITE_OK
                           ? store_begin(d, wall_ns)
                           : complain_of(d);
    if (result != MU_OK) {
        /* Another program's log is its own affair. */
        (void)sqlite3_db_config(d->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
        disk_close(d);
        return result;
    }
    *out = d;
    return MU_OK;
}

bool disk_default_path(char *path, size_t size, int domain, const char *broker)
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    struct mu_text t = mu_text_in(path, size);
    if (state && state[0] == '/') {
        mu_text_add(&t, state);
    } else if (home && home[0] == '/') {
        mu_text_format(&t, "%s/.local/state", home);
    } else {
        return false;
    }
    mu_text_format(&t, "/muster/%d-%s.db", domain, broker);
    return !t.cut;
}

mu_result disk_load(struct disk *d, struct broker *b, uint64_t *refused)
{
    const struct {
        const char *sql;
        enum journal_kind kind;
    } tables[] = {
        {"SELECT * FROM agents", JOURNAL_AGENT},
        {"SELECT * FROM lines", JOURNAL_LINE},
        {"SELECT value FROM meta WHERE key = 'run_wall_ns' AND value != 0", JOURNAL_CLOCK},
        {"SELECT * FROM capsules", JOURNAL_SNAPSHOT},
        {disk_bundle_select, JOURNAL_MAIL},
    };
    *refused = 0;
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
        sqlite3_stmt *s = NULL;
        int result = sqlite3_prepare_v2(d->db, tables[i].sql, -1, &s, NULL);
        while (result == SQLITE_OK && sqlite3_step(s) == SQLITE_ROW) {
            struct journal_entry e = {.kind = tables[i].kind};
            disk_row_take(s, &e);
            *refused += !durable_restore(b, &e);
        }
        if (sqlite3_finalize(s) != SQLITE_OK || result != SQLITE_OK) {
            fprintf(stderr, "muster broker: %s: %s\n", d->path, sqlite3_errmsg(d->db));
            return MU_FAULT_FILE;
        }
    }
    return MU_OK;
}
