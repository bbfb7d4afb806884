/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file claims.h
 * Others want a name, and wait for its holder to go: each for so long, and in the order in which
 * they came.
 */
#ifndef MUSTER_BROKER_CLAIMS_H
#define MUSTER_BROKER_CLAIMS_H

#include "broker/names/registry.h"

enum { CLAIMS_MAX = REGISTRY_MAX };

struct claim {
    uint32_t agent;   /* whose name it is */
    uint32_t process; /* that wants it, */
    uint32_t slot;    /* for this agent of its own */
    uint64_t until_ns;
    struct presence presence;
    uint32_t behind;     /* the next one on the same name, or MU_NONE */
    uint32_t next, prev; /* in order of until_ns; next also in the free list; MU_NONE: none */
};

struct claims {
    struct claim *pool; /* CLAIMS_MAX of them */
    uint32_t used;      /* high-water mark */
    uint32_t free;
    uint32_t first, last;
    uint32_t count;
};

void claims_init(struct claims *c);

/** @return the claim of a process among those that begin with `first`, or MU_NONE */
uint32_t claims_find(const struct claims *c, uint32_t first, uint32_t process);

/**
 * Enters a claim behind those that *first begins; the times of successive ones must not decrease.
 * @return whether there was room
 */
bool claims_add(struct claims *c, uint32_t *first, const struct claim *claim);

/** Ends one of the claims that *first begins. */
void claims_drop(struct claims *c, uint32_t *first, uint32_t index);

#endif
