/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file herald.h
 * The Beacon on the network: says that this broker is there, and hears of the others.
 */
#ifndef MUSTER_BROKER_HERALD_H
#define MUSTER_BROKER_HERALD_H

#include "broker/control/broker.h"
#include "broker/node/beacons.h"
#include "broker/node/mailbags.h"
#include "broker/node/pulse.h"
#include "bus/bus.h"

struct herald {
    struct bus *bus;
    struct beacons beacons;
    struct bus_reader heard;
    struct bus_writer beacon;
    struct pulse pulse;
    bool sure;   /* no other broker has our name */
    bool yields; /* another one has it: this one is to end */
};

MU_MUST_USE mu_result herald_open(struct herald *h, struct bus *bus,
                                  const struct broker_options *broker);

/** Hears the other brokers; sets yields, and says so, when one of them has our name. */
void herald_hear(struct herald *h);

/**
 * Says that the broker is there, when that is due by the machine's clock.
 *
 * @param bags  those who are to hear of it
 */
void herald_tell(struct herald *h, struct broker *b, const struct mailbags *bags);

/** Nobody was heard that has our name: agents may come from now on. */
void herald_be_sure(struct herald *h);

/** Takes the Beacon back; a broker that yields leaves it to the other one. */
void herald_close(struct herald *h);

#endif
