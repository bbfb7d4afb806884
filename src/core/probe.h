/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file probe.h
 * Probes: lines of CLIPS that only look.
 *
 * A program that sends a line asks here whether it may go as a probe, and the mind that is to
 * answer asks again.  Pure.
 */
#ifndef MUSTER_CORE_PROBE_H
#define MUSTER_CORE_PROBE_H

#include <stdbool.h>
#include <stddef.h>

/**
 * Says whether a line only looks: it is `(WORD LITERAL...)` with a word of the list and nothing but
 * symbols and numbers behind it, or one global, and at most MU_GLANCE_LINE_MAX bytes.
 */
bool mu_probe_is(const char *line);

/**
 * Finds the word of such a line.
 *
 * @param word  out: where it begins in the line
 * @return its bytes; 0: it is a global
 */
size_t mu_probe_word(const char *line, const char **word);

/** @return the index-th word of the list; NULL past the last */
const char *mu_probe_at(size_t index);

#endif
