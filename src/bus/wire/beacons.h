/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file beacons.h
 * The brokers that a process has heard of by their heartbeats.  Pure.
 */
#ifndef MUSTER_BUS_WIRE_BEACONS_H
#define MUSTER_BUS_WIRE_BEACONS_H

#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>

struct beacons_broker {
    char name[MU_NAME_MAX + 1];
    char host[MU_FIELD_MAX + 1];
    uint64_t incarnation;
    uint32_t index, agents;
    bool there; /* not silent */
    bool takes_agents;
};

struct beacons {
    struct beacons_broker at[MU_BROKERS_MAX];
    uint32_t count;
};

enum beacons_news {
    BEACONS_KNOWN, /* or of a second broker of a name, which is not sure of that yet */
    BEACONS_MET,   /* a broker that was not there before, or another life of one */
    BEACONS_FULL,  /* it is passed over */
};

/** Notes a heartbeat.  When the table is full, a broker that is silent makes room. */
enum beacons_news beacons_note(struct beacons *b, const muster_Beacon *beacon);

/** A broker is silent, or has left.  @return whether it was there */
bool beacons_lose(struct beacons *b, const char *name);

/** @return the broker of that name, silent or not, or NULL */
struct beacons_broker *beacons_find(struct beacons *b, const char *name);

#endif
