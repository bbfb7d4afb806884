/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file relay.h
 * Mail, receipts and lines that other brokers deliver to this one, and what it acknowledges.
 *
 * A mail from a neighbour is taken once, whatever becomes of it: what has no room, or may not be
 * carried out, is answered to its sender by way of the neighbour.
 */
#ifndef MUSTER_BROKER_RELAY_H
#define MUSTER_BROKER_RELAY_H

#include "wire.h"

#include <stdbool.h>

struct broker;

/** As broker_delivery, broker_up_next and broker_up_sent. */
void relay_take(struct broker *b, const muster_Delivery *d);
bool relay_up_next(struct broker *b, const char **peer, muster_Up *out);
void relay_up_sent(struct broker *b);

#endif
