/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file minds.h
 * What went on in the minds of a recorded run, out of their diaries (docs/observing.md).
 *
 * Pure: diaries are added in the order of steps, then anything can be asked of any step.  All
 * memory is taken by minds_open.  One thread.
 */
#ifndef MUSTER_STORY_MINDS_H
#define MUSTER_STORY_MINDS_H

#include "core/table.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* No line. */
enum { MINDS_NONE = -1 };

/* A line of a diary.  Lines of a robot are a list, by their order. */
struct minds_line {
    uint32_t at, bytes; /* its text without the letter, and without the end of the line */
    uint32_t step;
    int32_t robot;
    int32_t before;   /* of the same robot */
    int32_t cause;    /* the line with a capital letter above it; its own: it is one */
    int32_t end;      /* of a fact: the line with which it went; MINDS_NONE: it stands */
    int32_t below[2]; /* of a fact that stands: others that do, by the next bit of their indices */
    char letter;
    long long fact; /* of + and -: its index */
};

struct minds_robot {
    char *name;
    int32_t first, last;
    int32_t stands; /* facts that stand at the end: the root of their tree */
    int32_t cause;  /* of what comes next */
    int32_t sensed; /* the last percept */
    uint64_t lost;  /* lines that its diary had no room for */
};

/* So many lines together, of all robots: which may be passed over when facts are looked for. */
enum { MINDS_BLOCK = 256 };

struct minds_block {
    int32_t stands; /* facts of it that stand at the end */
    int32_t end;    /* the last line with which one of the others went; 0: none has */
};

struct minds {
    char *text;
    size_t text_len, text_max;
    struct minds_line *lines;
    int32_t lines_count, lines_max;
    struct minds_block *blocks; /* one for each MINDS_BLOCK lines */
    struct minds_robot *robots;
    int32_t robots_count, robots_max;
    struct mu_table names;
    bool cut; /* there was no room for all of it */
};

/**
 * Takes the memory for diaries of text_max bytes together; pages that stay empty cost nothing.
 *
 * @param robots_max  robots at most, 1 or more
 */
struct minds *minds_open(size_t text_max, uint32_t robots_max);

/** Forgets all of it. */
void minds_clear(struct minds *m);

/** Adds a robot's diary of one step; steps come in order.  What is not a diary's line is skipped.
 */
void minds_add(struct minds *m, const char *robot, uint32_t step, const char *diary);

/** @return the robot of that name, or MINDS_NONE: it has no diary */
int32_t minds_robot(const struct minds *m, const char *name);

/** @return a line's text, without letter and index; *bytes: its length */
const char *minds_text(const struct minds *m, int32_t line, size_t *bytes);

/** @return the last line of a robot up to the end of a step, or MINDS_NONE */
int32_t minds_at(const struct minds *m, int32_t robot, uint32_t step);

/**
 * Goes through the facts that stood behind a line, the oldest first.
 *
 * @param line  from minds_at; MINDS_NONE: there was none
 * @param from  the fact before, or MINDS_NONE for the first
 * @return the line that asserted it, or MINDS_NONE: there is no other
 */
int32_t minds_next_fact(const struct minds *m, int32_t line, int32_t from);

/** @return the line that asserted the fact that stood behind a line, or MINDS_NONE */
int32_t minds_fact(const struct minds *m, int32_t line, long long index);

/** @return the last line with that letter up to a line, or MINDS_NONE */
int32_t minds_last(const struct minds *m, int32_t line, char letter);

#endif
