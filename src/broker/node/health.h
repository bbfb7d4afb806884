/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file health.h
 * Tells any DDS tool how the broker is: the topics BrokerStatus and PartStatus.
 *
 * What has changed is written at once, but at most every HEALTH_NEWS_NS; what changes with time
 * alone (ages, processor time, memory) every HEALTH_DRIFT_NS.
 */
#ifndef MUSTER_BROKER_HEALTH_H
#define MUSTER_BROKER_HEALTH_H

#include "broker/control/broker.h"
#include "broker/services/counters.h"
#include "bus/bus.h"

#define HEALTH_NEWS_NS  100000000ull
#define HEALTH_DRIFT_NS 1000000000ull

struct health {
    struct bus *bus;
    struct bus_writer status, parts;
    muster_BrokerStatus told; /* without what drifts */
    uint64_t told_ns;         /* when all was told, whether it was news or not */
    bool begun;
    uint64_t values[COUNTERS_MAX]; /* that were told last, in the order of the table */
};

MU_MUST_USE mu_result health_open(struct health *h, struct bus *bus);

/** Tells what there is to tell; to be called every HEALTH_NEWS_NS of the machine's clock. */
void health_tell(struct health *h, struct broker *b, uint64_t now_ns);

/** Tells everything for the last time, and waits until readers have it. */
void health_close(struct health *h, struct broker *b);

#endif
