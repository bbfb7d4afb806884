/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file observer.h
 * Lines on the console of the global controller: (you-do robots wander), (suspend red), ...
 *
 * What a line says, and no more: its receivers and what becomes of it are run_observer.c's.  Pure.
 */
#ifndef MUSTER_RUN_OBSERVER_H
#define MUSTER_RUN_OBSERVER_H

#include "core/text.h"
#include "muster/limits.h"
#include "muster/result.h"

enum observer_answer {
    OBSERVER_HERE, /* the observer knows it itself */
    OBSERVER_MAIL  /* each agent that it is for answers */
};

struct observer_order {
    const char *performative; /* of the directive; NULL: none goes out */
    enum observer_answer answer;
    char who[MU_DST_MAX + 1]; /* a word as receivers are named, or names joined by commas */
    char content[MU_CONTENT_MAX + 1];
};

/**
 * Reads a line.
 *
 * @param why  what is wrong with it, when it is
 * @return MU_OK, or MU_MALFORMED
 */
MU_MUST_USE mu_result observer_read(struct observer_order *o, const char *line,
                                    struct mu_text *why);

/** Lists the words that a line may have, for completion. */
void observer_words(struct mu_text *out);

#endif
