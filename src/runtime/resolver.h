/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file resolver.h
 * An agent that resolves addresses: what it offers, and its answers to the broker.
 */
#ifndef MUSTER_RUNTIME_RESOLVER_H
#define MUSTER_RUNTIME_RESOLVER_H

#include "muster/kind.h"
#include "muster/resolver.h"

/* An agent's resolver; all zero: it resolves nothing. */
struct resolver {
    char scheme[MU_NAME_MAX + 1];
    mu_resolve resolve;
    void *self;
    bool due; /* the broker is still to be told */
};

/** Tells a broker that has just accepted the agent which addresses the agent resolves. */
void resolver_offer(mu_agent *a);

/** The outbox has room again: tells the broker if that did not go in before. */
void resolver_retry(mu_agent *a);

/** Takes the broker's question, a handler of every kind. */
enum mu_take resolver_take(void *self, mu_agent *a, const struct mu_mail *mail);

#endif
