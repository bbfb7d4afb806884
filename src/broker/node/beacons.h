/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file beacons.h
 * The brokers of the network as this one sees them, and whether its own name is its own.  Pure.
 */
#ifndef MUSTER_BROKER_BEACONS_H
#define MUSTER_BROKER_BEACONS_H

#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

struct beacon_other {
    char name[MU_NAME_MAX + 1];
    uint64_t incarnation;
    bool there; /* not silent */
};

struct beacons {
    char name[MU_NAME_MAX + 1]; /* of this broker */
    char host[MU_FIELD_MAX + 1];
    uint64_t incarnation;
    uint32_t pid;
    struct beacon_other others[MU_BROKERS_MAX];
    uint32_t count;
    uint64_t refused; /* brokers that did not fit */
};

enum beacon_news {
    BEACON_NOTHING, /* it is known, or our own, or does not fit and is counted */
    BEACON_MET,     /* a broker that was not there before, or another life of one */
    BEACON_LATER,   /* another broker has our name, and must give way */
    BEACON_EARLIER, /* another broker has our name, and we must give way */
};

/** Takes a heartbeat. */
enum beacon_news beacons_hear(struct beacons *b, const muster_Beacon *beacon);

/** A broker is silent, or has left.  @return whether it was there */
bool beacons_lose(struct beacons *b, const char *name);

#endif
