/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file probes.h
 * Probes of agents by others, and their answers.
 */
#ifndef MUSTER_BROKER_PROBES_H
#define MUSTER_BROKER_PROBES_H

#include "broker/directory/directory.h"

/* --- probes.c -------------------------------------------------------------------------------- */

/*
 * Lines that only look, on their way to a mind and back: beside all mail, and outside of every
 * step.
 *
 * A probe is known by its asker and the asker's number.  It is kept from the question until its
 * answer is out, and every question is answered, but for words that there is no room for: where no
 * agent can look, or may, it is declined, and the asker sends the line as a directive, which says
 * why it is refused.
 */

/* Words that wait for the network: one for each probe, and those that were declined. */
enum { PROBES_WORDS = 4 * MU_GLANCES_MAX };

struct probe {
    bool used;
    uint32_t asker, agent;
    uint64_t number;
    uint32_t from, to; /* places: of the asker, and of the agent that is asked; MU_NONE: answered */
};

/* What a process is to be told. */
struct probes_word {
    uint32_t place;
    muster_GlanceWord word;
    uint32_t probe; /* MU_NONE: declined before it was kept */
    uint32_t asker, agent;
    uint64_t number;
};

struct probes {
    struct probe at[MU_GLANCES_MAX];
    char texts[MU_GLANCES_MAX][MU_GLANCE_BYTES_MAX]; /* of each: the line, then what it showed */
    uint32_t count;
    struct probes_word words[PROBES_WORDS]; /* in order */
    uint32_t words_count, open;             /* open: the one that broker_next has in hand */
    uint64_t asked, declined, lost;         /* counters */
};

/** Takes a word of a process. */
void probes_hear(struct broker *b, uint32_t place, const muster_Glance *probe);

/** A process is no more: what it was asked is declined, what it asked is forgotten. */
void probes_gone(struct broker *b, uint32_t place);

/**
 * Gives the first word for a process.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false: there is none
 */
bool probes_next(struct broker *b, uint32_t place, muster_Glance *out);

/** The word that was given last is out. */
void probes_sent(struct broker *b);

#endif
