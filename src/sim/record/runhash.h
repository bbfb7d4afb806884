/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file runhash.h
 * The hash of a run: SHA-256 over everything that happened, in one fixed order.
 *
 * What an agent did in a step becomes a digest of its own when its answer arrives; the digests are
 * folded in the order of the robots when the step is complete, so that no order of arrival shows.
 */
#ifndef MUSTER_SIM_RUNHASH_H
#define MUSTER_SIM_RUNHASH_H

#include "wire.h"

#include <stddef.h>
#include <stdint.h>

enum { RUNHASH_BYTES = 32, RUNHASH_TEXT = 65 };

struct runhash; /* one in a process */

/** Starts a run's hash; takes memory at start-up. */
struct runhash *runhash_open(void);

/** Digests what an agent did: command, rules fired, mails sent. */
void runhash_act(struct runhash *h, const muster_Act *act, unsigned char digest[RUNHASH_BYTES]);

/** Folds bytes into the run: the bits of body states, digests. */
void runhash_fold(struct runhash *h, const void *bytes, size_t count);

/** Folds a number in, the same on every machine. */
void runhash_fold_number(struct runhash *h, uint64_t number);

/** Folds in what somebody outside did to the world: which order, to whom, and its numbers. */
void runhash_order(struct runhash *h, const muster_RunCommand *order);

/** Digests the mails that came from outside the roster in one step. */
void runhash_outside(struct runhash *h, const muster_Mail *mails, uint32_t count,
                     unsigned char digest[RUNHASH_BYTES]);

/** @return the first 64 bits of what the hash would be if the run ended here */
uint64_t runhash_peek(struct runhash *h);

/** Ends the run: 64 hexadecimal digits. */
void runhash_end(struct runhash *h, char text[RUNHASH_TEXT]);

#endif
