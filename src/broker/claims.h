/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file claims.h
 * Somebody else wants a name, and waits for its holder to go.
 */
#ifndef MUSTER_BROKER_CLAIMS_H
#define MUSTER_BROKER_CLAIMS_H

#include "broker/registry.h"

struct claim {
    uint32_t agent;   /* whose name it is */
    uint32_t process; /* that wants it, */
    uint32_t slot;    /* for this agent of its own */
    uint64_t until_ns;
    struct presence presence;
    uint32_t next, prev; /* in order of until_ns; next also in the free list; MU_NONE: none */
};

struct claims {
    struct claim *pool; /* REGISTRY_MAX: a name has one claim at most */
    uint32_t used;      /* high-water mark */
    uint32_t free;
    uint32_t first, last;
    uint32_t count;
};

void claims_init(struct claims *c);

/** Enters a claim; the times of successive ones must not decrease.  @return its index */
uint32_t claims_add(struct claims *c, const struct claim *claim);

/** Ends a claim. */
void claims_drop(struct claims *c, uint32_t index);

#endif
