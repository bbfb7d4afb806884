/* SPDX-License-Identifier: Apache-2.0 */
#include "platter.h"

#include "samples.h"

#include <stdio.h>
#include <string.h>

/* --- writing ---------------------------------------------------------------------------------- */

#define KEEP(to, text) ((size_t)snprintf(to, sizeof(to), "%s", text) < sizeof(to))

static bool name_write(struct platter *p, const struct journal_entry *e)
{
    uint32_t i = 0;
    while (i < p->names_count && strcmp(p->names[i].name, e->name) != 0) {
        i++;
    }
    if (i == PLATTER_NAMES) {
        return false;
    }
    p->names_count += i == p->names_count;
    struct platter_name *n = &p->names[i];
    *n = (struct platter_name){.kind = e->agent_kind,
                               .durable_seq = e->durable_seq,
                               .failed_seq = e->failed_seq,
                               .reserved_seq = e->reserved_seq};
    return KEEP(n->name, e->name);
}

/* @return where a row is, or would be */
static uint32_t row_find(const struct platter *p, uint64_t row)
{
    uint32_t i = 0;
    while (i < p->rows_count && p->rows[i].row < row) {
        i++;
    }
    return i;
}

static bool row_write(struct platter *p, const struct journal_entry *e)
{
    uint32_t i = row_find(p, e->row);
    struct platter_row *r = &p->rows[i];
    if (p->rows_count == PLATTER_ROWS || (i < p->rows_count && r->row == e->row)) {
        return false;
    }
    memmove(r + 1, r, (p->rows_count - i) * sizeof *r);
    p->rows_count++;
    *r = (struct platter_row){
        .row = e->row, .expires_wall_ns = e->expires_wall_ns, .letter = e->letter};
    return KEEP(r->src, e->letter.src) && KEEP(r->dst, e->letter.dst) &&
           KEEP(r->content, e->letter.content) && KEEP(r->performative, e->letter.performative) &&
           KEEP(r->reply_with, e->letter.reply_with) && KEEP(r->waiting, e->waiting);
}

static bool waiting_write(struct platter *p, const struct journal_entry *e)
{
    uint32_t i = row_find(p, e->row);
    return i < p->rows_count && p->rows[i].row == e->row && KEEP(p->rows[i].waiting, e->waiting);
}

static bool rows_erase(struct platter *p, uint64_t row, uint64_t last_row)
{
    uint32_t first = row_find(p, row), end = row_find(p, last_row + 1);
    memmove(&p->rows[first], &p->rows[end], (p->rows_count - end) * sizeof p->rows[0]);
    p->rows_count -= end - first;
    return end - first == last_row - row + 1;
}

static bool line_write(struct platter *p, const struct journal_entry *e)
{
    if (e->slot >= PLATTER_SLOTS) {
        return false;
    }
    struct platter_line *l = &p->lines[e->lines][e->slot];
    *l = (struct platter_line){.line = e->line};
    return !e->line.key ||
           (KEEP(l->key, e->line.key) && KEEP(l->agent, e->line.agent) &&
            KEEP(l->attributes, e->line.attributes) && KEEP(l->origin, e->line.origin));
}

bool platter_write(struct platter *p, const struct journal_entry *e)
{
    switch (e->kind) {
    case JOURNAL_AGENT: return name_write(p, e);
    case JOURNAL_MAIL: return row_write(p, e);
    case JOURNAL_WAITING: return waiting_write(p, e);
    case JOURNAL_GONE: return rows_erase(p, e->row, e->last_row);
    case JOURNAL_LINE: return line_write(p, e);
    case JOURNAL_RESET: memset(p->lines[e->lines], 0, sizeof p->lines[0]); return true;
    case JOURNAL_CLOCK: p->run_wall_ns = e->run_wall_ns; return true;
    case JOURNAL_SNAPSHOT: break; /* nobody moves in these histories */
    }
    return false;
}

/* --- reading ---------------------------------------------------------------------------------- */

static struct journal_entry name_entry(const struct platter_name *n)
{
    return (struct journal_entry){.kind = JOURNAL_AGENT,
                                  .name = n->name,
                                  .agent_kind = n->kind,
                                  .durable_seq = n->durable_seq,
                                  .failed_seq = n->failed_seq,
                                  .reserved_seq = n->reserved_seq};
}

static struct journal_entry line_entry(const struct platter *p, enum lines_kind lines,
                                       uint32_t slot)
{
    const struct platter_line *l = &p->lines[lines][slot];
    struct journal_entry e = {.kind = JOURNAL_LINE, .lines = lines, .slot = slot, .line = l->line};
    e.line.key = l->key;
    e.line.agent = l->agent;
    e.line.attributes = l->attributes;
    e.line.origin = l->origin;
    return e;
}

static struct journal_entry row_entry(const struct platter_row *r)
{
    struct journal_entry e = {.kind = JOURNAL_MAIL,
                              .row = r->row,
                              .letter = r->letter,
                              .waiting = r->waiting,
                              .expires_wall_ns = r->expires_wall_ns};
    e.letter.src = words(r->src);
    e.letter.dst = words(r->dst);
    e.letter.content = words(r->content);
    e.letter.performative = words(r->performative);
    e.letter.reply_with = words(r->reply_with);
    e.letter.language = e.letter.ontology = words("");
    e.letter.in_reply_to = e.letter.conversation = words("");
    return e;
}

static void lines_read(const struct platter *p, enum lines_kind lines,
                       void (*restore)(const struct journal_entry *e))
{
    for (uint32_t slot = 0; slot < PLATTER_SLOTS; slot++) {
        struct journal_entry e = line_entry(p, lines, slot);
        if (e.line.key[0] != '\0') {
            restore(&e);
        }
    }
}

void platter_read(const struct platter *p, void (*restore)(const struct journal_entry *e))
{
    for (uint32_t i = 0; i < p->names_count; i++) {
        struct journal_entry e = name_entry(&p->names[i]);
        restore(&e);
    }
    lines_read(p, LINES_GROUPS, restore);
    lines_read(p, LINES_SERVICES, restore);
    if (p->run_wall_ns) {
        restore(&(struct journal_entry){.kind = JOURNAL_CLOCK, .run_wall_ns = p->run_wall_ns});
    }
    for (uint32_t i = 0; i < p->rows_count; i++) {
        struct journal_entry e = row_entry(&p->rows[i]);
        restore(&e);
    }
}
