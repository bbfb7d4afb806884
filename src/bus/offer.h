/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file offer.h
 * What a writer offers, as words: for recordings, out of which a writer is made that the readers of
 * the first one take for the same.
 *
 * "reliability=1 durability=0 deadline=100000000 ..."; a policy's kind is its number in DDS, times
 * are nanoseconds.
 */
#ifndef MUSTER_BUS_OFFER_H
#define MUSTER_BUS_OFFER_H

#include "core/text.h"

#include <dds/dds.h>

/** Writes all that readers match by, but for partitions; 384 bytes are enough. */
void offer_write(const dds_qos_t *qos, struct mu_text *words);

/** Sets what the words say, for a writer and for its publisher.  What is no policy, or no value of
 * one, is passed over. */
void offer_read(const char *words, dds_qos_t *qos);

#endif
