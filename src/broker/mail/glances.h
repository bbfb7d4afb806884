/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file glances.h
 * Lines that only look, on their way to a mind and back: beside all mail, and outside of every
 * step.
 *
 * A glance is known by its asker and the asker's number.  It is kept from the question until its
 * answer is out, and every question is answered, but for words that there is no room for: where
 * nobody can look, or may, it is declined, and the asker sends the line as a directive, which says
 * why it is refused.
 */
#ifndef MUSTER_BROKER_GLANCES_H
#define MUSTER_BROKER_GLANCES_H

#include "broker/names/registry.h"

struct broker;

/* Words that wait for the network: one for each glance, and those that were declined. */
enum { GLANCES_WORDS = 4 * MU_GLANCES_MAX };

struct glance {
    bool used;
    uint32_t asker, agent;
    uint64_t number;
    uint32_t from, to; /* places: the asker's, and of whom is asked; MU_NONE: answered */
    char *text;        /* MU_GLANCE_BYTES_MAX: the line, then what it showed */
};

/* What a process is to be told. */
struct glances_word {
    uint32_t place;
    muster_GlanceWord word;
    uint32_t glance; /* MU_NONE: declined before it was kept */
    uint32_t asker, agent;
    uint64_t number;
};

struct glances {
    struct glance at[MU_GLANCES_MAX];
    uint32_t count;
    struct glances_word words[GLANCES_WORDS]; /* in order */
    uint32_t words_count, open;               /* open: the one that courier_next has in hand */
    uint64_t asked, declined, lost;           /* counters */
};

void glances_init(struct glances *g);

/** Takes a word of a process. */
void glances_hear(struct broker *b, uint32_t place, const muster_Glance *glance);

/** A process is no more: what it was asked is declined, what it asked is forgotten. */
void glances_gone(struct broker *b, uint32_t place);

/**
 * Gives the first word for a process.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false: there is none
 */
bool glances_next(struct broker *b, uint32_t place, muster_Glance *out);

/** The word that was given last is out. */
void glances_sent(struct broker *b);

#endif
