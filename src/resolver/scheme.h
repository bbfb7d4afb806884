/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file scheme.h
 * The addresses that muster-resolver knows, a file each.
 */
#ifndef MUSTER_RESOLVER_SCHEME_H
#define MUSTER_RESOLVER_SCHEME_H

#include "core/address.h"
#include "muster/muster.h"

struct scheme {
    const char *name;
    const char *means;  /* for people */
    mu_resolve resolve; /* self is the mu_process */
    /* A control step begins, as mu_handlers.on_world; NULL: bodies do not matter. */
    void (*see)(const struct mu_percept *bodies, size_t count);
};

/** role:R is every agent that offers something with role=R; task:T likewise. */
extern const struct scheme role_scheme, task_scheme;

/** near:D is whose body is at most D metres away from the sender's, centre to centre. */
extern const struct scheme near_scheme;

/** Adds all agents that offer something with this attribute.  @return as mu_resolve */
bool offers_resolve(mu_process *p, const char *key, const char *value, mu_resolution *r);

#endif
