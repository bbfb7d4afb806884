/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file complete.h
 * What a half-typed word of a line may become.  Pure.
 */
#ifndef MUSTER_DESK_COMPLETE_H
#define MUSTER_DESK_COMPLETE_H

#include <stdbool.h>
#include <stddef.h>

enum { COMPLETE_REST = 128, COMPLETE_LISTED_MAX = 200 };

/* The word before the cursor. */
struct complete_word {
    const char *at;
    size_t len;
    bool begins; /* it stands behind an open parenthesis: a function or a relation */
};

/* One that it may become. */
struct complete_match {
    const char *at; /* in the words */
    size_t len;
};

/** Finds the word before the cursor in a line of len bytes. */
struct complete_word complete_word(const char *line, size_t len);

/**
 * Finds the next word that begins as w does, each once: two kinds may share a name.
 *
 * @param words  lines "KIND NAME", as a robot lists them; see docs/console.md
 * @param from   where to look; moved on
 * @return false: there is none
 */
bool complete_next(const char *words, const char **from, struct complete_word w,
                   struct complete_match *match);

/** @return how many bytes behind w all matches share; *count: how many there are */
size_t complete_common(const char *words, struct complete_word w, size_t *count,
                       struct complete_match *first);

/**
 * Says how the line is to go on behind w: with what all matches share, and a space when there is
 * one match alone.
 *
 * @param rest  out: ""; there is none, or several that differ from here on
 * @return how many matches there are
 */
size_t complete_rest(const char *words, struct complete_word w, char rest[COMPLETE_REST]);

#endif
