/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file announce.h
 * What this broker says to the others of the agents that it knows: its own, those beyond other
 * brokers, and those that are absent.  An agent's slot is its place in the white pages.
 */
#ifndef MUSTER_BROKER_ANNOUNCE_H
#define MUSTER_BROKER_ANNOUNCE_H

#include "wire.h"

#include <stdbool.h>
#include <stdint.h>

struct broker;

/** So many other brokers are there; the first one to come is told everything. */
void announce_to(struct broker *b, uint32_t listeners);

/** Everything is to be said again. */
void announce_all(struct broker *b);

/** As broker_announcement and broker_announced. */
bool announce_next(struct broker *b, muster_Registration *out);
void announce_done(struct broker *b);

void announce_tick(struct broker *b);
uint64_t announce_deadline_ns(const struct broker *b);

#endif
