/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file feed.h
 * Bytes to topics: for who replays samples that a tap or the simulator has recorded.
 *
 * A feed is a writer of one of our topics.  It keeps each sample until every reliable reader has
 * it, however fast they come.
 */
#ifndef MUSTER_BUS_FEED_H
#define MUSTER_BUS_FEED_H

#include "bus/bus.h"

struct feed {
    enum bus_topic topic;
    struct bus_writer out;
    const void *type; /* DDS's own, of the topic */
};

/** Finds one of our topics by its name.  @return false: there is none */
bool feed_topic(const char *name, enum bus_topic *topic);

/** Opens a feed into one or two partitions, as bus_writer_open.  @return MU_OK or MU_FAULT_DDS */
MU_MUST_USE mu_result feed_open(struct feed *feed, struct bus *bus, enum bus_topic topic,
                                const char *first, const char *second);

/**
 * Writes a sample.
 *
 * @param bytes  with the four bytes of the encapsulation; looked through before they are written
 * @return MU_OK; MU_BUSY: readers do not keep up, try again; MU_MALFORMED: these bytes are no such
 *         sample; MU_FAULT_DDS
 */
MU_MUST_USE mu_result feed_write(struct feed *feed, const void *bytes, size_t size);

#endif
