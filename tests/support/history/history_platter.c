/* SPDX-License-Identifier: Apache-2.0 */
/* A disk that is an array: what was committed, and nothing else, is there in the next life. */
#include "history.h"

#include "broker/journal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = MAILS, LINES = 256, TEXT = 128 };

static struct {
    struct row {
        uint64_t row, expires_wall_ns;
        muster_Mail letter;
        char src[8], dst[TEXT], performative[16], reply_with[16], content[64], waiting[TEXT];
    } rows[ROWS];
    uint32_t rows_count;
    struct bearer {
        char name[32];
        muster_Kind kind;
        uint64_t durable_seq, failed_seq, reserved_seq;
    } bearers[2 * NAMES];
    uint32_t bearers_count;
    uint64_t run_wall_ns;
    struct line {
        struct journal_line line;
        char key[32], agent[32], attributes[64], origin[32];
    } lines[JOURNAL_LINE_KINDS][LINES];
} disk;

void platter_clear(void)
{
    memset(&disk, 0, sizeof disk);
}

static void write_bearer(const struct journal_entry *e)
{
    uint32_t i = 0;
    while (i < disk.bearers_count && strcmp(disk.bearers[i].name, e->name) != 0) {
        i++;
    }
    disk.bearers_count += i == disk.bearers_count;
    struct bearer *n = &disk.bearers[i];
    n->kind = e->agent_kind;
    n->durable_seq = e->durable_seq;
    n->failed_seq = e->failed_seq;
    n->reserved_seq = e->reserved_seq;
    snprintf(n->name, sizeof n->name, "%s", e->name);
}

static uint32_t row_find(uint64_t row)
{
    uint32_t i = 0;
    while (i < disk.rows_count && disk.rows[i].row < row) {
        i++;
    }
    return i;
}

static void write_mail(const struct journal_entry *e)
{
    HOLD(disk.rows_count < ROWS);
    uint32_t i = row_find(e->row);
    struct row *r = &disk.rows[i];
    HOLD(i == disk.rows_count || r->row != e->row);
    memmove(r + 1, r, (disk.rows_count - i) * sizeof *r);
    disk.rows_count++;
    r->row = e->row;
    r->letter = e->letter;
    r->expires_wall_ns = e->expires_wall_ns;
    snprintf(r->src, sizeof r->src, "%s", e->letter.src);
    snprintf(r->dst, sizeof r->dst, "%s", e->letter.dst);
    snprintf(r->performative, sizeof r->performative, "%s", e->letter.performative);
    snprintf(r->reply_with, sizeof r->reply_with, "%s", e->letter.reply_with);
    snprintf(r->content, sizeof r->content, "%s", e->letter.content);
    snprintf(r->waiting, sizeof r->waiting, "%s", e->waiting);
}

static void write_waiting(const struct journal_entry *e)
{
    struct row *r = &disk.rows[row_find(e->row)];
    HOLD(r->row == e->row);
    snprintf(r->waiting, sizeof r->waiting, "%s", e->waiting);
}

static void write_gone(const struct journal_entry *e)
{
    uint32_t first = row_find(e->row), end = row_find(e->last_row + 1);
    HOLD(end - first == e->last_row - e->row + 1);
    memmove(&disk.rows[first], &disk.rows[end], (disk.rows_count - end) * sizeof disk.rows[0]);
    disk.rows_count -= end - first;
}

static void write_line(const struct journal_entry *e)
{
    HOLD(e->slot < LINES);
    struct line *l = &disk.lines[e->lines][e->slot];
    *l = (struct line){.line = e->line};
    if (e->line.key) {
        snprintf(l->key, sizeof l->key, "%s", e->line.key);
        snprintf(l->agent, sizeof l->agent, "%s", e->line.agent);
        snprintf(l->attributes, sizeof l->attributes, "%s", e->line.attributes);
        snprintf(l->origin, sizeof l->origin, "%s", e->line.origin);
    }
}

static void write_entry(const struct journal_entry *e)
{
    switch (e->kind) {
    case JOURNAL_AGENT: write_bearer(e); break;
    case JOURNAL_MAIL: write_mail(e); break;
    case JOURNAL_WAITING: write_waiting(e); break;
    case JOURNAL_GONE: write_gone(e); break;
    case JOURNAL_LINE: write_line(e); break;
    case JOURNAL_RESET: memset(disk.lines[e->lines], 0, sizeof disk.lines[0]); break;
    case JOURNAL_CLOCK: disk.run_wall_ns = e->run_wall_ns; break;
    }
}

void platter_commit(void)
{
    struct journal_entry e = {.name = NULL};
    muster_Level level;
    if (!journal_wanted(history.life.b, &level)) {
        return;
    }
    bool works = !history.life.disk_fails;
    while (journal_next(history.life.b, &e)) {
        if (works) {
            write_entry(&e);
        }
    }
    history_note("%s", works ? "committed" : "the disk does not take it");
    journal_committed(history.life.b, works, life_now_ns());
    ledger_committed(works);
    if (works) {
        history.book_on_disk = history.book;
    }
}

/* --- the next life ---------------------------------------------------------------------------- */

static void restore(const struct journal_entry *e)
{
    bool taken = journal_restore(history.life.b, e);
    if (!taken) {
        history_note("entry of kind %d, of %s/%llu for %s, is not taken", (int)e->kind,
                     e->letter.src ? e->letter.src : "", (unsigned long long)e->letter.seq,
                     e->waiting ? e->waiting : "");
    }
    bool is_mail = e->kind == JOURNAL_MAIL;
    uint32_t mail = is_mail ? (uint32_t)strtoul(e->letter.content, NULL, 10) : 0;
    /* Two of one name can have given two mails one number. */
    HOLD(taken || (is_mail && history.contested[history.ledger[mail].sender_life]));
}

static void restore_bearers(void)
{
    for (uint32_t i = 0; i < disk.bearers_count; i++) {
        const struct bearer *n = &disk.bearers[i];
        restore(&(struct journal_entry){.kind = JOURNAL_AGENT,
                                        .name = n->name,
                                        .agent_kind = n->kind,
                                        .durable_seq = n->durable_seq,
                                        .failed_seq = n->failed_seq,
                                        .reserved_seq = n->reserved_seq});
    }
}

static void restore_lines(enum journal_lines kind)
{
    for (uint32_t slot = 0; slot < LINES; slot++) {
        const struct line *l = &disk.lines[kind][slot];
        struct journal_entry e = {
            .kind = JOURNAL_LINE, .lines = kind, .slot = slot, .line = l->line};
        e.line.key = l->key;
        e.line.agent = l->agent;
        e.line.attributes = l->attributes;
        e.line.origin = l->origin;
        if (l->key[0] != '\0') {
            restore(&e);
        }
    }
}

static void restore_mails(void)
{
    for (uint32_t i = 0; i < disk.rows_count; i++) {
        struct row *r = &disk.rows[i];
        struct journal_entry e = {.kind = JOURNAL_MAIL,
                                  .row = r->row,
                                  .letter = r->letter,
                                  .waiting = r->waiting,
                                  .expires_wall_ns = r->expires_wall_ns};
        e.letter.src = r->src;
        e.letter.dst = r->dst;
        e.letter.content = r->content;
        e.letter.performative = r->performative;
        e.letter.reply_with = r->reply_with;
        e.letter.language = e.letter.ontology = words("");
        e.letter.in_reply_to = e.letter.conversation = words("");
        restore(&e);
    }
}

void platter_restore(void)
{
    restore_bearers();
    restore_lines(JOURNAL_GROUPS);
    restore_lines(JOURNAL_SERVICES);
    if (disk.run_wall_ns) {
        restore(&(struct journal_entry){.kind = JOURNAL_CLOCK, .run_wall_ns = disk.run_wall_ns});
    }
    restore_mails();
}
