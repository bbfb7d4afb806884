/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/node/disk_parts.h"

#include <stdio.h>
#include <string.h>

/* A row whose columns are read one after the other. */
struct reading {
    sqlite3_stmt *statement;
    int count;
};

/* @return a string of the row, valid until the next one; "" for nothing */
static char *read_text(struct reading *r)
{
    static char none[1];
    const unsigned char *s = sqlite3_column_text(r->statement, r->count++);
    return s ? (char *)(uintptr_t)s : none; /* idlc has no const; nothing is written there */
}

static uint64_t read_number(struct reading *r)
{
    return (uint64_t)sqlite3_column_int64(r->statement, r->count++);
}

static void read_agent(struct reading *r, struct journal_entry *e)
{
    e->kind = JOURNAL_AGENT;
    e->name = read_text(r);
    const char *kind = read_text(r);
    if (strcmp(kind, DISK_ENDED) == 0) {
        e->agent_kind = JOURNAL_ENDED;
    }
    for (unsigned i = 0; validate_kind_word((muster_Kind)i); i++) {
        if (strcmp(validate_kind_word((muster_Kind)i), kind) == 0) {
            e->agent_kind = (muster_Kind)i;
        }
    }
    e->durable_seq = read_number(r);
    e->reserved_seq = read_number(r);
    e->failed_seq = read_number(r);
}

static void read_line(struct reading *r, struct journal_entry *e)
{
    e->kind = JOURNAL_LINE;
    const char *kind = read_text(r);
    e->lines = LINES_KINDS;
    for (unsigned i = 0; i < LINES_KINDS; i++) {
        if (strcmp(disk_line_words[i], kind) == 0) {
            e->lines = (enum lines_kind)i;
        }
    }
    e->slot = (uint32_t)read_number(r);
    e->line.key = read_text(r);
    e->line.agent = read_text(r);
    e->line.present = read_number(r) != 0;
    e->line.attributes = read_text(r);
    e->line.lease_ns = read_number(r);
    e->line.stamp_ns = read_number(r);
    e->line.origin = read_text(r);
}

static void read_clock(struct reading *r, struct journal_entry *e)
{
    e->kind = JOURNAL_CLOCK;
    e->run_wall_ns = read_number(r);
}

static void read_capsule(struct reading *r, struct journal_entry *e)
{
    e->kind = JOURNAL_SNAPSHOT;
    e->name = read_text(r);
    e->epoch = read_number(r);
    e->snapshot = read_text(r);
}

static void read_mail(struct reading *r, struct journal_entry *e)
{
    muster_Mail *m = &e->letter;
    e->kind = JOURNAL_MAIL;
    e->row = e->last_row = read_number(r);
    m->src = read_text(r);
    m->seq = read_number(r);
    e->waiting = read_text(r);
    m->level = (muster_Level)read_number(r);
    e->expires_wall_ns = read_number(r);
    m->dst = read_text(r);
    m->layer = (uint32_t)read_number(r);
    m->performative = read_text(r);
    m->language = read_text(r);
    m->ontology = read_text(r);
    m->reply_with = read_text(r);
    m->in_reply_to = read_text(r);
    m->conversation = read_text(r);
    m->reply_by_ns = read_number(r);
    m->priority = (int32_t)read_number(r);
    m->hops = (uint32_t)read_number(r);
    m->due_ns = (int64_t)(read_number(r) - 1);
    m->ttl_ns = read_number(r);
    m->content = read_text(r);
}

mu_result disk_load(struct disk *d, struct broker *b, uint64_t *refused)
{
    const struct {
        const char *sql;
        void (*read)(struct reading *r, struct journal_entry *e);
    } tables[] = {
        {"SELECT * FROM agents", read_agent},
        {"SELECT * FROM lines", read_line},
        {"SELECT value FROM meta WHERE key = 'run_wall_ns' AND value != 0", read_clock},
        {"SELECT * FROM capsules", read_capsule},
        {disk_bundle_select, read_mail},
    };
    *refused = 0;
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
        sqlite3_stmt *s = NULL;
        int result = sqlite3_prepare_v2(d->db, tables[i].sql, -1, &s, NULL);
        while (result == SQLITE_OK && sqlite3_step(s) == SQLITE_ROW) {
            struct reading r = {.statement = s};
            struct journal_entry e = {.name = NULL};
            tables[i].read(&r, &e);
            *refused += !durable_restore(b, &e);
        }
        if (sqlite3_finalize(s) != SQLITE_OK || result != SQLITE_OK) {
            fprintf(stderr, "muster broker: %s: %s\n", d->path, sqlite3_errmsg(d->db));
            return MU_FAULT_FILE;
        }
    }
    return MU_OK;
}
