/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file disk_story.h
 * A broker_story.h with a disk that is an array, and with brokers that die and come back.
 */
#ifndef MUSTER_TESTS_DISK_STORY_H
#define MUSTER_TESTS_DISK_STORY_H

#include "broker/journal.h"
#include "broker/parts.h"
#include "broker_story.h"

enum { ROWS_MAX = 2048, NAMES_MAX = 64, SLOTS = 16 };

#define SECOND 1000000000ull
#define WALL   1000000000000000000ull

/* What is on the disk. */
static struct {
    struct row {
        uint64_t row;
        char src[32], dst[64], content[64], waiting[256];
        muster_Mail letter;
        uint64_t expires_wall_ns;
    } rows[ROWS_MAX];
    uint32_t rows_count;
    struct name {
        char name[32];
        muster_Kind kind;
        uint64_t durable_seq, failed_seq, reserved_seq;
    } names[NAMES_MAX];
    uint32_t names_count;
    uint64_t run_wall_ns;
    struct line {
        struct journal_line line;
        char key[32], agent[32], attributes[64], origin[32];
    } lines[JOURNAL_LINE_KINDS][SLOTS];
} disk, before;

static uint64_t wall_ns;      /* when this life began */
static muster_Level level;    /* of the last commit */
static uint32_t writes;       /* entries of the last commit */
static uint32_t lines_resets; /* ever */

/* --- the disk --------------------------------------------------------------------------------- */

static inline void write_agent(const struct journal_entry *e)
{
    uint32_t i = 0;
    while (i < disk.names_count && strcmp(disk.names[i].name, e->name) != 0) {
        i++;
    }
    disk.names_count += i == disk.names_count;
    struct name *n = &disk.names[i];
    *n = (struct name){.kind = e->agent_kind,
                       .durable_seq = e->durable_seq,
                       .failed_seq = e->failed_seq,
                       .reserved_seq = e->reserved_seq};
    snprintf(n->name, sizeof n->name, "%s", e->name);
}

static inline void write_mail(const struct journal_entry *e)
{
    CU_ASSERT_TRUE_FATAL(disk.rows_count < ROWS_MAX);
    struct row *r = &disk.rows[disk.rows_count++];
    r->row = e->row;
    r->letter = e->letter;
    r->expires_wall_ns = e->expires_wall_ns;
    snprintf(r->src, sizeof r->src, "%s", e->letter.src);
    snprintf(r->dst, sizeof r->dst, "%s", e->letter.dst);
    snprintf(r->content, sizeof r->content, "%s", e->letter.content);
    snprintf(r->waiting, sizeof r->waiting, "%s", e->waiting);
}

static inline void write_waiting(const struct journal_entry *e)
{
    for (uint32_t i = 0; i < disk.rows_count; i++) {
        if (disk.rows[i].row == e->row) {
            snprintf(disk.rows[i].waiting, sizeof disk.rows[i].waiting, "%s", e->waiting);
        }
    }
}

static inline void write_gone(const struct journal_entry *e)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < disk.rows_count; i++) {
        if (disk.rows[i].row < e->row || disk.rows[i].row > e->last_row) {
            disk.rows[kept++] = disk.rows[i];
        }
    }
    CU_ASSERT_EQUAL(disk.rows_count - kept, e->last_row - e->row + 1);
    disk.rows_count = kept;
}

static inline void write_line(const struct journal_entry *e)
{
    CU_ASSERT_TRUE_FATAL(e->slot < SLOTS);
    struct line *l = &disk.lines[e->lines][e->slot];
    *l = (struct line){.line = e->line};
    if (e->line.key) {
        snprintf(l->key, sizeof l->key, "%s", e->line.key);
        snprintf(l->agent, sizeof l->agent, "%s", e->line.agent);
        snprintf(l->attributes, sizeof l->attributes, "%s", e->line.attributes);
        snprintf(l->origin, sizeof l->origin, "%s", e->line.origin);
    }
}

static inline void write_entry(const struct journal_entry *e)
{
    writes++;
    switch (e->kind) {
    case JOURNAL_AGENT: write_agent(e); break;
    case JOURNAL_MAIL: write_mail(e); break;
    case JOURNAL_WAITING: write_waiting(e); break;
    case JOURNAL_GONE: write_gone(e); break;
    case JOURNAL_LINE: write_line(e); break;
    case JOURNAL_RESET:
        lines_resets++;
        memset(disk.lines[e->lines], 0, sizeof disk.lines[0]);
        break;
    case JOURNAL_CLOCK: disk.run_wall_ns = e->run_wall_ns; break;
    }
}

/* @return whether there was anything to write */
static inline bool commit(bool works)
{
    struct journal_entry e = {.name = NULL};
    writes = 0;
    before = disk;
    if (!journal_wanted(story.b, &level)) {
        return false;
    }
    while (journal_next(story.b, &e)) {
        write_entry(&e);
    }
    if (!works) {
        disk = before;
    }
    journal_committed(story.b, works, story.now_ns);
    return true;
}

/* --- lives ------------------------------------------------------------------------------------ */

static inline void life_begin(uint64_t at_wall_ns)
{
    struct broker_options options = {.name = "alpha",
                                     .incarnation = at_wall_ns,
                                     .host = "here",
                                     .pid = 9,
                                     .wall_ns = at_wall_ns,
                                     .has_store = true};
    story.b = broker_kept(&options);
    story.now_ns = 0;
    wall_ns = at_wall_ns;
    mu_text_init(&story.text, story.buffer, sizeof story.buffer);
}

static uint32_t refused;

static inline void lines_come_back(void)
{
    for (int kind = 0; kind < JOURNAL_LINE_KINDS; kind++) {
        for (uint32_t slot = 0; slot < SLOTS; slot++) {
            const struct line *l = &disk.lines[kind][slot];
            struct journal_entry e = {.kind = JOURNAL_LINE,
                                      .lines = (enum journal_lines)kind,
                                      .slot = slot,
                                      .line = l->line};
            e.line.key = l->key;
            e.line.agent = l->agent;
            e.line.attributes = l->attributes;
            e.line.origin = l->origin;
            refused += l->key[0] != '\0' && !journal_restore(story.b, &e);
        }
    }
}

/* The broker dies now, and is back later. */
static inline void die_and_come_back(uint64_t later_ns)
{
    life_begin(wall_ns + story.now_ns + later_ns);
    refused = 0;
    for (uint32_t i = 0; i < disk.names_count; i++) {
        const struct name *n = &disk.names[i];
        struct journal_entry e = {.kind = JOURNAL_AGENT,
                                  .name = n->name,
                                  .agent_kind = n->kind,
                                  .durable_seq = n->durable_seq,
                                  .failed_seq = n->failed_seq,
                                  .reserved_seq = n->reserved_seq};
        refused += !journal_restore(story.b, &e);
    }
    lines_come_back();
    struct journal_entry clock = {.kind = JOURNAL_CLOCK, .run_wall_ns = disk.run_wall_ns};
    if (disk.run_wall_ns) {
        refused += !journal_restore(story.b, &clock);
    }
    for (uint32_t i = 0; i < disk.rows_count; i++) {
        struct row *r = &disk.rows[i];
        struct journal_entry e = {.kind = JOURNAL_MAIL,
                                  .row = r->row,
                                  .letter = r->letter,
                                  .waiting = r->waiting,
                                  .expires_wall_ns = r->expires_wall_ns};
        static char none[1];
        e.letter.src = r->src;
        e.letter.dst = r->dst;
        e.letter.content = r->content;
        e.letter.performative = e.letter.language = e.letter.ontology = none;
        e.letter.reply_with = e.letter.in_reply_to = e.letter.conversation = none;
        refused += !journal_restore(story.b, &e);
    }
}

/* A new team on a new disk; green and blue have been there and are gone. */
static inline void team(void)
{
    memset(&disk, 0, sizeof disk);
    life_begin(WALL);
    story_join("red");
    story_join("green");
    story_join("blue");
    CU_ASSERT_TRUE(commit(true));
    story_gone("p-green");
    story_gone("p-blue");
    (void)story_collect();
    CU_ASSERT_FALSE(commit(true));
}

static inline void send_at(muster_Level at, uint64_t seq, const char *dst, const char *content)
{
    muster_Mail m = letter("red", seq, dst, content);
    m.level = at;
    story_mail(m);
}

static inline void log_mail(uint64_t seq, const char *dst, const char *content)
{
    send_at(muster_LEVEL_LOGGED, seq, dst, content);
}

static inline void again(uint64_t seq, muster_Level at)
{
    muster_Mail m = letter("red", seq, "green", "again");
    m.level = at;
    m.again = true;
    story_mail(m);
}

#endif
