/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file peers.h
 * The other brokers on the network: what this one says to them, and hears from them.
 */
#ifndef MUSTER_BROKER_PEERS_H
#define MUSTER_BROKER_PEERS_H

#include "broker/control/broker.h"
#include "broker/node/beacons.h"
#include "bus/bus.h"

/* Acknowledgements go into the partition of the broker that they are for. */
struct peers_line {
    char name[MU_NAME_MAX + 1];
    struct bus_writer ups;
};

struct peers {
    struct bus *bus;
    struct bus_reader deliveries;
    struct bus_writer registration;
    struct peers_line lines[MU_BROKERS_MAX];
    uint32_t count;
};

/** @param place  "broker.NAME" of this broker */
MU_MUST_USE mu_result peers_open(struct peers *p, struct bus *bus, const char *place);

/** Opens a line to each broker that is there, and closes the others. */
void peers_follow(struct peers *p, const struct beacons *beacons, struct broker *b,
                  uint64_t now_ns);

/** Takes what other brokers deliver. */
void peers_take(struct peers *p, struct broker *b, uint64_t now_ns);

/** Announces and acknowledges, after the commit.  @return whether the network took all */
bool peers_tell(struct peers *p, struct broker *b);

#endif
