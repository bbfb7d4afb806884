/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file link.h
 * A process's way to its broker: which one it is, and when it goes to another.
 */
#ifndef MUSTER_RUNTIME_LINK_H
#define MUSTER_RUNTIME_LINK_H

#include "bus/bus.h"
#include "muster/agent.h"
#include "runtime/choice.h"

enum { LINK_PARTITION_MAX = sizeof "broker." + MU_NAME_MAX };

struct link {
    struct bus_reader beacons;
    struct beacons known;
    char wanted[MU_NAME_MAX + 1];       /* to begin with; "": any */
    char broker[MU_NAME_MAX + 1];       /* "": none yet */
    char partition[LINK_PARTITION_MAX]; /* of its Up reader */
    uint64_t incarnation;               /* of the broker */
    bool silent;                        /* nothing is heard of it */
    uint64_t lives_ns;                  /* its last heartbeat, or word while an agent leaves */
    uint64_t asked_ns;                  /* when it was told of all agents last */
    uint64_t heard_ns;                  /* when the first broker was heard of; 0: none */
    uint64_t looked_ns;                 /* when link_look was here last */
    uint64_t patient_until_ns;          /* no broker's silence counts before */
};

/** Begins to listen for wanted, or NULL.  @return MU_OK; MU_FAULT_USAGE: no name; MU_FAULT_DDS */
MU_MUST_USE mu_result link_open(mu_process *p, const char *wanted);

/**
 * Says whether a Delivery is from our broker.  A later life of it may be heard of in this way
 * first: then the process is with that from now on.
 */
bool link_is_ours(mu_process *p, const muster_Delivery *d);

/**
 * Hears brokers, and goes to one, or to another, when it is time.
 *
 * @param turned  out: it went to one because of a heartbeat, so that the Delivery in hand is of an
 *                earlier broker
 */
MU_MUST_USE mu_result link_look(mu_process *p, bool *turned);

/** Says every agent to the broker anew; none may send before it has answered. */
void link_register(mu_process *p);

#endif
