/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file admission.h
 * A mail comes in from the wire: taken once, whole, and only if there is room for it.
 */
#ifndef MUSTER_BROKER_ADMISSION_H
#define MUSTER_BROKER_ADMISSION_H

#include "broker/base/store.h"

struct broker;

/**
 * Takes a mail of an agent from the wire into the store.
 *
 * @return the mail, to be routed or dropped; or NULL: refused, counted, and the sender told
 */
struct mail *admission_take(struct broker *b, uint32_t sender, const muster_Mail *letter);

#endif
