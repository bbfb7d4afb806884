/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file ages.h
 * Mails that wait in boxes, in the order in which they came: the oldest is always at hand.
 */
#ifndef MUSTER_BROKER_AGES_H
#define MUSTER_BROKER_AGES_H

#include "broker/base/store.h"

struct ages {
    struct mail *oldest, *newest;
};

/** A mail waits from now on; mail_ns is the mail clock's time and never less than the last. */
void ages_add(struct ages *a, struct mail *m, uint64_t mail_ns);

/** It waits no more. */
void ages_remove(struct ages *a, struct mail *m);

/** @return how long the oldest has waited; 0 when none waits */
uint64_t ages_oldest_ns(const struct ages *a, uint64_t mail_ns);

#endif
