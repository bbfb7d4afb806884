/* SPDX-License-Identifier: Apache-2.0 */
#include "story/story.h"

#include "muster/memory.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Lines are longer than this, in the mean. */
enum { MINDS_LINE_BYTES = 8, MINDS_LINES_LEAST = 1024 };

static const char minds_causes[] = "0SMELR";
static const char minds_effects[] = "+=-VTA";

struct minds *minds_open(size_t text_max, uint32_t robots_max)
{
    struct minds *m = mu_startup_alloc(sizeof *m);
    size_t lines = text_max / MINDS_LINE_BYTES + MINDS_LINES_LEAST;
    m->text_max = text_max < UINT32_MAX ? text_max : UINT32_MAX;
    m->text = mu_startup_alloc(m->text_max + 1);
    m->lines_max = lines < INT32_MAX ? (int32_t)lines : INT32_MAX;
    m->lines = mu_startup_array((size_t)m->lines_max, sizeof *m->lines);
    m->blocks = mu_startup_array((size_t)m->lines_max / MINDS_BLOCK + 1, sizeof *m->blocks);
    m->robots_max = (int32_t)robots_max;
    m->robots = mu_startup_array(robots_max, sizeof *m->robots);
    mu_table_init(&m->names, robots_max);
    return m;
}

void minds_clear(struct minds *m)
{
    for (int32_t i = 0; i < m->robots_count; i++) {
        (void)mu_table_remove(&m->names, m->robots[i].name);
    }
    memset(m->blocks, 0, ((size_t)m->lines_count / MINDS_BLOCK + 1) * sizeof *m->blocks);
    m->robots_count = m->lines_count = 0;
    m->text_len = 0;
    m->cut = false;
}

/* Keeps text with a zero behind it. */
static const char *text_keep(struct minds *m, const char *text, size_t len)
{
    if (len >= m->text_max - m->text_len) {
        m->cut = true;
        return NULL;
    }
    char *to = m->text + m->text_len;
    memcpy(to, text, len);
    to[len] = '\0';
    m->text_len += len + 1;
    return to;
}

int32_t minds_robot(const struct minds *m, const char *name)
{
    uint32_t index = mu_table_find(&m->names, name);
    return index == MU_NONE ? MINDS_NONE : (int32_t)index;
}

static int32_t robot_enter(struct minds *m, const char *name)
{
    int32_t index = minds_robot(m, name);
    if (index != MINDS_NONE) {
        return index;
    }
    char *kept = m->robots_count < m->robots_max
                     ? (char *)(uintptr_t)text_keep(m, name, strlen(name))
                     : NULL;
    if (!kept) {
        m->cut = true;
        return MINDS_NONE;
    }
    m->robots[m->robots_count] = (struct minds_robot){.name = kept,
                                                      .first = MINDS_NONE,
                                                      .last = MINDS_NONE,
                                                      .stands = MINDS_NONE,
                                                      .cause = MINDS_NONE,
                                                      .sensed = MINDS_NONE};
    (void)mu_table_put(&m->names, kept, (uint32_t)m->robots_count);
    return m->robots_count++;
}

/* --- facts that stand ------------------------------------------------------------------------- */

/*
 * A robot's facts that stand are a tree, in which each is below those whose indices begin with the
 * same bits, from the lowest on.  In whatever order facts come and go, it is no deeper than an
 * index has bits.
 */

/* @return the link to the fact of an index, or to where it is to be */
static int32_t *fact_find(struct minds *m, struct minds_robot *r, long long index)
{
    unsigned long long bits = (unsigned long long)index;
    int32_t *link = &r->stands;
    while (*link != MINDS_NONE && m->lines[*link].fact != index) {
        link = &m->lines[*link].below[bits & 1];
        bits >>= 1;
    }
    return link;
}

static void fact_goes(struct minds *m, int32_t fact, int32_t line)
{
    struct minds_block *block = &m->blocks[fact / MINDS_BLOCK];
    m->lines[fact].end = line;
    block->stands--;
    block->end = line;
}

static void fact_put(struct minds *m, int32_t *link, int32_t fact, const int32_t below[2])
{
    m->lines[fact].below[0] = below[0];
    m->lines[fact].below[1] = below[1];
    *link = fact;
}

/* What stands under its index already has gone, and the diary had no room to say so. */
static void fact_comes(struct minds *m, struct minds_robot *r, int32_t line)
{
    static const int32_t none[2] = {MINDS_NONE, MINDS_NONE};
    int32_t *link = fact_find(m, r, m->lines[line].fact);
    int32_t former = *link;
    fact_put(m, link, line, former == MINDS_NONE ? none : m->lines[former].below);
    m->blocks[line / MINDS_BLOCK].stands++;
    if (former != MINDS_NONE) {
        fact_goes(m, former, line);
    }
}

/* @return the link to one that has none below it, from a link to a fact on */
static int32_t *leaf_find(struct minds *m, int32_t *link)
{
    int32_t *below = m->lines[*link].below;
    while (below[0] != MINDS_NONE || below[1] != MINDS_NONE) {
        link = &below[below[0] == MINDS_NONE];
        below = m->lines[*link].below;
    }
    return link;
}

/* A leaf below the fact takes its place: it has the same bits up to there. */
static void fact_end(struct minds *m, struct minds_robot *r, int32_t line)
{
    int32_t *link = fact_find(m, r, m->lines[line].fact);
    int32_t gone = *link;
    if (gone == MINDS_NONE) {
        return;
    }
    int32_t *leaf = leaf_find(m, link);
    int32_t heir = *leaf;
    *leaf = MINDS_NONE;
    if (heir != gone) {
        fact_put(m, link, heir, m->lines[gone].below);
    }
    fact_goes(m, gone, line);
}

static void facts_void(struct minds *m, int32_t fact, int32_t line)
{
    if (fact != MINDS_NONE) {
        facts_void(m, m->lines[fact].below[0], line);
        facts_void(m, m->lines[fact].below[1], line);
        fact_goes(m, fact, line);
    }
}

/* --- lines ------------------------------------------------------------------------------------ */

static void line_take(struct minds *m, struct minds_robot *r, int32_t index)
{
    struct minds_line *line = &m->lines[index];
    if (strchr(minds_causes, line->letter)) {
        r->cause = index;
        r->sensed = line->letter == 'S' ? index : r->sensed;
    }
    line->cause = line->letter == '=' ? r->sensed : r->cause;
    line->letter = line->letter == '=' ? '+' : line->letter;
    switch (line->letter) {
    case '0':
        facts_void(m, r->stands, index);
        r->stands = MINDS_NONE;
        break;
    case '-': fact_end(m, r, index); break;
    case '+': fact_comes(m, r, index); break;
    default: break;
    }
    line->before = r->last;
    r->first = r->last == MINDS_NONE ? index : r->first;
    r->last = index;
}

static void line_add(struct minds *m, int32_t robot, uint32_t step, const char *text, size_t len)
{
    struct minds_robot *r = &m->robots[robot];
    char letter = text[0];
    if (letter == '~') {
        r->lost += strtoull(text + 1, NULL, 10);
        return;
    }
    bool known = letter && (strchr(minds_causes, letter) || strchr(minds_effects, letter));
    bool fact = strchr("+=-", letter) != NULL;
    char *rest = NULL;
    long long number = fact ? strtoll(text + 1, &rest, 10) : 0;
    const char *from = fact ? rest : text + 1;
    from += from < text + len && *from == ' ';
    if (!known || (fact && rest == text + 1) || from > text + len) {
        return;
    }
    size_t bytes = (size_t)(text + len - from);
    const char *kept = m->lines_count < m->lines_max ? text_keep(m, from, bytes) : NULL;
    if (!kept) {
        m->cut = true;
        return;
    }
    m->lines[m->lines_count] = (struct minds_line){.at = (uint32_t)(kept - m->text),
                                                   .bytes = (uint32_t)bytes,
                                                   .step = step,
                                                   .robot = robot,
                                                   .end = MINDS_NONE,
                                                   .fact = number,
                                                   .letter = letter};
    line_take(m, r, m->lines_count++);
}

void minds_add(struct minds *m, const char *robot, uint32_t step, const char *diary)
{
    int32_t index = diary[0] ? robot_enter(m, robot) : MINDS_NONE;
    if (index == MINDS_NONE) {
        return;
    }
    while (*diary) {
        size_t len = strcspn(diary, "\n");
        line_add(m, index, step, diary, len);
        diary += len + (diary[len] == '\n');
    }
}

/* --- questions -------------------------------------------------------------------------------- */

const char *minds_text(const struct minds *m, int32_t line, size_t *bytes)
{
    *bytes = m->lines[line].bytes;
    return m->text + m->lines[line].at;
}

/* @return how many lines there are up to the end of a step, of all robots */
static int32_t lines_until(const struct minds *m, uint32_t step)
{
    int32_t from = 0, to = m->lines_count;
    while (from < to) {
        int32_t middle = from + (to - from) / 2;
        if (m->lines[middle].step <= step) {
            from = middle + 1;
        } else {
            to = middle;
        }
    }
    return from;
}

int32_t minds_at(const struct minds *m, int32_t robot, uint32_t step)
{
    int32_t last = m->robots[robot].last;
    if (last == MINDS_NONE || m->lines[last].step <= step) {
        return last;
    }
    int32_t line = lines_until(m, step) - 1;
    while (line >= 0 && m->lines[line].robot != robot) {
        line--;
    }
    return line >= 0 ? line : MINDS_NONE;
}

/* @return whether a line asserted a fact that stood behind another line */
static bool stood(const struct minds *m, int32_t fact, int32_t line)
{
    const struct minds_line *f = &m->lines[fact];
    return f->letter == '+' && (f->end == MINDS_NONE || f->end > line);
}

/* @return whether no fact of a block stood behind a line */
static bool passed_over(const struct minds *m, int32_t block, int32_t line)
{
    return m->blocks[block].stands == 0 && m->blocks[block].end <= line;
}

int32_t minds_next_fact(const struct minds *m, int32_t line, int32_t from)
{
    if (line == MINDS_NONE) {
        return MINDS_NONE;
    }
    int32_t robot = m->lines[line].robot;
    int32_t at = from == MINDS_NONE ? m->robots[robot].first : from + 1;
    while (at <= line) {
        if (passed_over(m, at / MINDS_BLOCK, line)) {
            at = (at / MINDS_BLOCK + 1) * MINDS_BLOCK;
        } else if (m->lines[at].robot == robot && stood(m, at, line)) {
            return at;
        } else {
            at++;
        }
    }
    return MINDS_NONE;
}

int32_t minds_fact(const struct minds *m, int32_t line, long long index)
{
    for (; line != MINDS_NONE && m->lines[line].letter != '0'; line = m->lines[line].before) {
        if (m->lines[line].letter == '+' && m->lines[line].fact == index) {
            return line;
        }
    }
    return MINDS_NONE;
}

int32_t minds_last(const struct minds *m, int32_t line, char letter)
{
    while (line != MINDS_NONE && m->lines[line].letter != letter) {
        line = m->lines[line].before;
    }
    return line;
}
