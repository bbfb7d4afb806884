/* SPDX-License-Identifier: Apache-2.0 */

#include "broker/node/disk_parts.h"

#include <string.h>

/* --- the tables ------------------------------------------------------------------------------- */

/* What stands where in a mail's list: first what every mail has; where nothing rare follows, the
 * list ends. */
#define SELECT_MAILS                                                                           \
    "SELECT b.id + j.key AS id,\n"                                                             \
    "  j.value ->> 0 AS sender, j.value ->> 1 AS seq,\n"                                       \
    "  coalesce(w.waiting, j.value ->> 2) AS waiting, -- who has not acknowledged it;\n"       \
    "    -- behind a slash, what its sender was told for good, or will be\n"                   \
    "  j.value ->> 3 AS level,           -- 1 logged, 2 synced;\n"                             \
    "    -- 0 ram: sent before one of those\n"                                                 \
    "  j.value ->> 8 AS expires_wall_ns, -- since 1970\n"                                      \
    "  j.value ->> 4 AS dst, j.value ->> 5 AS layer, j.value ->> 6 AS performative,\n"         \
    "  j.value ->> 9 AS language, j.value ->> 10 AS ontology, j.value ->> 11 AS reply_with,\n" \
    "  j.value ->> 12 AS in_reply_to, j.value ->> 13 AS conversation,\n"                       \
    "  j.value ->> 14 AS reply_by_ns, j.value ->> 15 AS priority, j.value ->> 16 AS hops,\n"   \
    "  j.value ->> 17 AS due_1_ns,       -- not before this time of the run, plus 1\n"         \
    "  j.value ->> 18 AS ttl_ns, j.value ->> 7 AS content\n"                                   \
    "FROM bundles AS b JOIN json_each(b.mails) AS j\n"                                         \
    "  LEFT JOIN settled AS s ON s.id = b.id LEFT JOIN waits AS w ON w.id = b.id + j.key\n"    \
    "WHERE s.alive IS NULL OR substr(s.alive, j.key + 1, 1) = '1'"

const char disk_bundle_tables[] =
    "CREATE TABLE bundles (\n"
    "  id INTEGER PRIMARY KEY,  -- the number of its first mail; the others follow\n"
    "  count INTEGER, mails TEXT);  -- JSON: a list of lists\n"
    "CREATE TABLE settled (\n"
    "  id INTEGER PRIMARY KEY,  -- of a bundle that has mails nobody waits for\n"
    "  alive TEXT);             -- 0 for each of those, 1 for the others\n"
    "CREATE TABLE waits (\n"
    "  id INTEGER PRIMARY KEY,  -- the number of a mail that some receivers have acknowledged\n"
    "  waiting TEXT);           -- the others, and how it ends\n"
    "CREATE VIEW mails AS " SELECT_MAILS ";";

const char disk_bundle_select[] =
    "SELECT id, sender, seq, waiting, level, dst, layer, performative, content, expires_wall_ns,"
    "  language, ontology, reply_with, in_reply_to, conversation, reply_by_ns, priority, hops,"
    "  due_1_ns, ttl_ns FROM (" SELECT_MAILS " ORDER BY b.id, j.key)";

const char disk_bundle_upgrade[] =
    "INSERT INTO bundles SELECT id, 1, json_array(json_array(sender, seq, waiting, level, dst,"
    "  layer, performative, content, expires_wall_ns, language, ontology, reply_with, in_reply_to,"
    "  conversation, reply_by_ns, priority, hops, due_1_ns, ttl_ns)) FROM mails_2;";

/* --- writing ---------------------------------------------------------------------------------- */

void disk_bundle_begin(struct disk *d)
{
    mu_text_clear(&d->bundle.text);
    d->bundle.count = 0;
}

bool disk_bundle_end(struct disk *d)
{
    struct disk_bundle *in_hand = &d->bundle;
    sqlite3_stmt *s = d->statements[DISK_PUT_BUNDLE];
    if (in_hand->count == 0) {
        return true;
    }
    mu_text_add_bytes(&in_hand->text, "]", 1);
    MU_ASSERT(!in_hand->text.cut);
    sqlite3_bind_int64(s, 1, (int64_t)in_hand->first);
    sqlite3_bind_int64(s, 2, in_hand->count);
    sqlite3_bind_text(s, 3, in_hand->text.at, (int)in_hand->text.len, SQLITE_STATIC);
    bool written = disk_step(s);
    disk_bundle_begin(d);
    return written;
}

bool disk_bundle_put(struct disk *d, const struct journal_entry *e)
{
    struct disk_bundle *in_hand = &d->bundle;
    bool fits = in_hand->count < DISK_BUNDLE_MAILS && in_hand->text.len < DISK_BUNDLE_BYTES &&
                e->row == in_hand->first + in_hand->count;
    if (!fits && !disk_bundle_end(d)) {
        return false;
    }
    in_hand->first = in_hand->count ? in_hand->first : e->row;
    in_hand->count++;
    disk_row_add_mail(&in_hand->text, e);
    return true;
}

/* --- settling --------------------------------------------------------------------------------- */

/* A bundle on disk. */
struct bundle {
    uint64_t first;
    uint32_t count;                /* 0: there is none */
    bool marked;                   /* alive stands on disk, too */
    char alive[DISK_BUNDLE_MAILS]; /* 1 or 0 for each mail */
};

/* Finds the last bundle that begins at a number or before it.  @return whether nothing failed */
static bool bundle_find(struct disk *d, uint64_t row, struct bundle *b)
{
    sqlite3_stmt *s = d->statements[DISK_FIND_BUNDLE];
    b->count = 0;
    sqlite3_bind_int64(s, 1, (int64_t)row);
    if (sqlite3_step(s) == SQLITE_ROW) {
        int64_t count = sqlite3_column_int64(s, 1);
        const unsigned char *alive = sqlite3_column_text(s, 2);
        int bytes = sqlite3_column_bytes(s, 2);
        b->first = (uint64_t)sqlite3_column_int64(s, 0);
        b->count = count > 0 && count <= DISK_BUNDLE_MAILS ? (uint32_t)count : 0;
        b->marked = alive && bytes == (int)b->count;
        memset(b->alive, '1', sizeof b->alive);
        if (b->marked) {
            memcpy(b->alive, alive, b->count);
        }
    }
    return sqlite3_reset(s) == SQLITE_OK;
}

static bool step_from(sqlite3_stmt *s, uint64_t number)
{
    sqlite3_bind_int64(s, 1, (int64_t)number);
    return disk_step(s);
}

/* Writes which mails of a bundle live, or takes it out when none does. */
static bool bundle_write(struct disk *d, const struct bundle *b)
{
    sqlite3_stmt *settled = d->statements[DISK_PUT_SETTLED];
    if (memchr(b->alive, '1', b->count)) {
        sqlite3_bind_text(settled, 2, b->alive, (int)b->count, SQLITE_STATIC);
        return step_from(settled, b->first);
    }
    return step_from(d->statements[DISK_DROP_BUNDLE], b->first) &&
           (!b->marked || step_from(d->statements[DISK_DROP_SETTLED], b->first));
}

/* From the last one down: a number belongs to the last bundle that begins before it. */
bool disk_bundle_drop(struct disk *d, const struct journal_entry *e)
{
    struct bundle b = {.count = 0};
    for (uint64_t last = e->last_row; last >= e->row; last = b.first - 1) {
        if (!bundle_find(d, last, &b)) {
            return false;
        }
        if (b.count == 0 || b.first + b.count <= e->row) {
            break;
        }
        uint64_t from = e->row > b.first ? e->row - b.first : 0;
        uint64_t end = last - b.first + 1 < b.count ? last - b.first + 1 : b.count;
        memset(b.alive + from, '0', (size_t)(end - from));
        if (!bundle_write(d, &b)) {
            return false;
        }
    }
    sqlite3_stmt *waits = d->statements[DISK_DROP_WAITS];
    sqlite3_bind_int64(waits, 2, (int64_t)e->last_row);
    return step_from(waits, e->row);
}
