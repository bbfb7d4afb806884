/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file spell.h
 * Which known word was meant.
 */
#ifndef MUSTER_CORE_SPELL_H
#define MUSTER_CORE_SPELL_H

#include <stddef.h>

/* The search for the nearest of many words, which are offered one by one. */
struct mu_spell {
    const char *word;    /* as it was typed */
    const char *nearest; /* so far; NULL: none is near */
    size_t distance;     /* of the nearest; at first one more than is still near */
};

/** Starts a search.  Near is one slip in every three letters, and at least one. */
void mu_spell_init(struct mu_spell *s, const char *word);

/** Offers a known word; of two that are as near, the first stays.  It must outlive the search. */
void mu_spell_offer(struct mu_spell *s, const char *known);

/**
 * Counts the slips between two words: letters that are missing, too many, wrong, or swapped with
 * their neighbour (optimal string alignment).
 *
 * @return the count; for words longer than 63 bytes the longer one's length
 */
size_t mu_spell_distance(const char *a, const char *b);

#endif
