/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file facts.h
 * The facts of a monitor: a run as rules/monitor.clp describes it, in the units of rules.
 */
#ifndef MUSTER_MONITOR_FACTS_H
#define MUSTER_MONITOR_FACTS_H

#include "core/text.h"
#include "mind/mind.h"
#include "muster/stats.h"

enum { FACTS_TEXT = 2 * MU_CONTENT_MAX + 4096 };

/* The facts that one step leaves for the next to take away; ends with NULL. */
extern const char *const facts_of_a_step[];

/** Adds a word as a symbol, or in quotes where it is none. */
void facts_add_word(struct mu_text *t, const char *word);

/** Adds a mail's content as fields where it is a list of them, else as one string. */
void facts_add_content(struct mu_text *t, const char *language, const char *content);

/** Writes (run-ended ...). */
void facts_write_end(struct mu_text *t, const struct mu_run_result *result);

/** Tells the mind all that a Frame says; the step's own fact is the caller's. */
void facts_tell(struct mind *m, const mu_stats *s, const struct mu_frame *frame);

#endif
