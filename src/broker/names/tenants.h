/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file tenants.h
 * Which agents live in a place, part by part, and which of them may have something to be told.
 */
#ifndef MUSTER_BROKER_TENANTS_H
#define MUSTER_BROKER_TENANTS_H

#include "broker/names/places.h"
#include "broker/names/registry.h"

/** No agent: the broker itself lives in no place. */
enum { TENANTS_NONE = REGISTRY_BROKER };

/** An agent, which lives nowhere, moves into a slot of a place. */
void tenants_add(struct registry *r, struct places *p, uint32_t place, uint32_t slot,
                 uint32_t agent);

/** An agent leaves its place. */
void tenants_remove(struct registry *r, struct places *p, uint32_t agent);

/** @return the first agent of a place, or of a part of it, or TENANTS_NONE */
uint32_t tenants_first(const struct places *p, uint32_t place);
uint32_t tenants_first_of(const struct places *p, uint32_t place, uint32_t part);

/** @return the next agent of the same place, or of the same part, or TENANTS_NONE */
uint32_t tenants_next(const struct registry *r, const struct places *p, uint32_t agent);
uint32_t tenants_next_of(const struct registry *r, uint32_t agent);

/** The agent may have something to be told, and its place with it; without a place, nothing. */
void tenants_wake(struct registry *r, struct places *p, uint32_t agent);

/**
 * @return an agent of the place that was woken since it was last served or calmed, or TENANTS_NONE:
 *         so nobody who waits has to be looked at twice
 */
uint32_t tenants_stirred(const struct places *p, uint32_t place);

/** What the agent has to be told can wait, until it is woken again. */
void tenants_calm(struct registry *r, struct places *p, uint32_t agent);

/** Takes the agent that waits longest out of a place's queue.  @return TENANTS_NONE: none waits */
uint32_t tenants_pop(struct registry *r, struct places *p, uint32_t place);

#endif
