/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file local_shared.h
 * One writer on DDS that finds the readers of many partitions (local.h).
 *
 * A broker writes to a partition for each process.  Each process would hear of each of those
 * writers, which took a fifth of the time until a hundred of them were there.  So one in the
 * partition "*" finds the readers of all of them, and never writes: samples go by sockets.  A
 * writer to one partition is on DDS only if a reader needs that: of another host, or a tool.
 */
#ifndef MUSTER_BUS_LOCAL_SHARED_H
#define MUSTER_BUS_LOCAL_SHARED_H

#include "bus/local.h"

#define LOCAL_SHARED_PARTITION "*"

struct local_found;

struct local_shared {
    struct bus *bus;
    enum bus_topic topic;
    dds_entity_t writer;
    dds_entity_t news;         /* what readers there are: a reader of DCPSSubscription */
    struct local_found *found; /* those of the topic */
    uint32_t patterns;         /* of partitions, that they name: those look at any */
    uint32_t seen;             /* of bus->matches, when it last looked */
};

/** Opens the bus's.  Without it, as when DDS has no room, all writers are on DDS. */
void local_shared_open(struct bus *bus, enum bus_topic topic);

/** Frees the bus's, if it has one; DDS has closed what was on it. */
void local_shared_close(struct bus *bus);

/** Takes note of readers that have come and gone, and marks the writers to their partitions. */
void local_shared_look(struct local_shared *s);

/** @return how many readers name a partition, the first ones of which it fills in; DDS may not have
 * matched them yet */
uint32_t local_shared_readers(const struct local_shared *s, const char *partition,
                              dds_instance_handle_t *readers, uint32_t most);

#endif
