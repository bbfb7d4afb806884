/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file feed.h
 * Bytes to topics: for who replays samples that a tap or the simulator has recorded.
 *
 * A feed is a writer of one of our topics, or of any whose type a tap has kept.  It keeps each
 * sample until every reliable reader has it, however fast they come.
 */
#ifndef MUSTER_BUS_FEED_H
#define MUSTER_BUS_FEED_H

#include "bus/bus.h"
#include "bus/gone.h"

struct feed {
    struct bus_writer out;
    const void *type; /* DDS's own, of the topic */
};

/* A topic that we were not compiled with, as a recording has it. */
struct feed_foreign {
    const char *topic, *type; /* their names on DDS */
    const void *type_bytes;   /* as from tap_type */
    size_t type_size;
    const char *words; /* what its writer offered: offer.h */
    const char *const *partitions;
    size_t partition_count;
};

/** Finds one of our topics by its name, and that of its type on DDS; NULL: it is not known.
 * @return false: there is none */
bool feed_topic(const char *name, const char *type, enum bus_topic *topic);

/** Opens a feed into one or two partitions, as bus_writer_open.  @return MU_OK or MU_FAULT_DDS */
MU_MUST_USE mu_result feed_open(struct feed *feed, struct bus *bus, enum bus_topic topic,
                                const char *first, const char *second);

/**
 * Opens a feed of a topic that is not ours, for whoever read what was recorded: it offers what the
 * writer did, and is reliable.
 *
 * @return MU_OK; MU_MALFORMED: the bytes are no such type; MU_REFUSED: there can be no such writer
 */
MU_MUST_USE mu_result feed_open_foreign(struct feed *feed, struct bus *bus,
                                        const struct feed_foreign *of);

/**
 * Writes a sample.
 *
 * @param bytes  with the four bytes of the encapsulation; looked through before they are written
 * @return MU_OK; MU_BUSY: readers do not keep up, try again; MU_MALFORMED: these bytes are no such
 *         sample; MU_FAULT_DDS
 */
MU_MUST_USE mu_result feed_write(struct feed *feed, const void *bytes, size_t size);

/**
 * Says that an instance has gone.
 *
 * @param key  of the instance, as a tap had it
 * @return as feed_write
 */
MU_MUST_USE mu_result feed_gone(struct feed *feed, enum gone_what what, const void *key,
                                size_t size);

#endif
