/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file topics.h
 * The table of topics: type, quality of service, partition, border check.
 */
#ifndef MUSTER_BUS_TOPICS_H
#define MUSTER_BUS_TOPICS_H

#include "bus/bus.h"
#include "muster/version.h"

#include <dds/dds.h>

/* The user data of such a writer.  It is read before any sample, whose type may be another. */
#define TOPICS_TEXT_(number) #number
#define TOPICS_WIRE_(number) TOPICS_TEXT_(number)
#define TOPICS_VERSION       "muster " MU_VERSION " wire " TOPICS_WIRE_(muster_WIRE)

/* The processes that say of a topic what its type is, for tools.  A description costs a millisecond
 * where it is given, and again wherever it is heard, so that one side alone gives it; observers,
 * which are few, always do. */
enum topic_describer {
    DESCRIBED_BY_HUBS,
    DESCRIBED_BY_AGENTS,
    DESCRIBED_TO_ALL, /* by a hub's endpoint in the partition BUS_TO_ALL */
};

struct topic {
    const char *name;
    const dds_topic_descriptor_t *descriptor;
    bool keeps_all;       /* history KEEP_ALL; else KEEP_LAST */
    int32_t depth;        /* of KEEP_LAST; 0: 1 */
    bool for_late_comers; /* durability TRANSIENT_LOCAL */
    bool local;           /* between processes of one host its samples go by sockets (local.h) */
    enum topic_describer describer;
    int64_t liveliness_ns;             /* 0: infinite */
    bool (*check)(const void *sample); /* false: breaks a rule of the wire */
    const char *partition;             /* in words, for the reference page */
    const char *from_to;
    const char *carries;
};

extern const struct topic topic_table[BUS_TOPICS];

/** @return one of our topics, by its name and that of its type on DDS; NULL: it is none */
const struct topic *topics_find(const char *name, const char *type);

/** @return how many samples of an instance KEEP_LAST keeps */
int32_t topics_depth(const struct topic *topic);

/** Makes the quality of service of a topic; the caller deletes it. */
dds_qos_t *topics_qos(const struct topic *topic);

/** @return the topic as an endpoint in that partition has it, or the fault of DDS */
dds_entity_t topics_open(struct bus *bus, enum bus_topic topic, const char *partition);

/** Makes a writer, with a publisher of its own, into one or two partitions, as bus_writer_open.
 * @return it, or the fault of DDS */
dds_entity_t topics_writer(struct bus *bus, enum bus_topic topic, const char *first,
                           const char *second);

/** Deletes a writer and its publisher, if there is one. */
void topics_writer_delete(dds_entity_t writer);

#endif
