/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file directive.h
 * What the broker can be told to do while it runs: `muster do broker '(WORD VALUE...)'`.
 *
 *   (delivery-interval MS)  ->  inform   delivery-interval MS
 *   a wrong value           ->  failure  "delivery-interval: expected ..."
 *   another word            ->  failure  "the broker carries out: ..."
 */
#ifndef MUSTER_BROKER_DIRECTIVE_H
#define MUSTER_BROKER_DIRECTIVE_H

#include "broker/base/store.h"

struct broker;

/** Carries out a directive that the policy has let through, and answers it. */
void directive_take(struct broker *b, uint32_t own, const struct mail *m);

#endif
