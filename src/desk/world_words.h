/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world_words.h
 * What people do to the world of a run that lives, in words: place red 1 2 90.  Pure.
 */
#ifndef MUSTER_DESK_WORLD_WORDS_H
#define MUSTER_DESK_WORLD_WORDS_H

#include "muster/result.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>

enum { WORLD_WORDS_WRONG = 256 };

/** @return whether that is a verb of it */
bool world_words_know(const char *verb);

/**
 * Reads an order: a verb, and what belongs to it.
 *
 * @param push_s  that a push lasts, in simulated seconds; 0: it is an impulse
 * @param c       out: order and what it is about; its texts point into the words.  Simulator,
 *                source, number and times are the caller's
 * @param wrong   out: what was expected, as a line without its end
 * @return MU_OK; MU_FAULT_USAGE
 */
MU_MUST_USE mu_result world_words_read(const char *const *words, size_t count, double push_s,
                                       muster_RunCommand *c, char wrong[WORLD_WORDS_WRONG]);

#endif
