/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file query_state.h
 * What a part of the broker has counted, for whoever asks it.
 *
 *   state  to broker.PART  ->  inform   PART COUNTER NUMBER COUNTER NUMBER ...
 *          to broker       ->  inform   broker PART.COUNTER NUMBER ...
 *          in lock step    ->  failure  in-lock-step
 *
 * Members of a lock step are not told: counters depend on the wall clock.
 */
#ifndef MUSTER_BROKER_QUERY_STATE_H
#define MUSTER_BROKER_QUERY_STATE_H

#include "broker/base/store.h"

struct broker;

/** Answers a question for the state of the broker or of one of its parts. */
void query_state_answer(struct broker *b, uint32_t own, const struct mail *question);

#endif
