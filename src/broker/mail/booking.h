/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file booking.h
 * What mail takes of the store is booked on its sender's account, and what is refused is counted
 * and told to whoever looks.
 */
#ifndef MUSTER_BROKER_BOOKING_H
#define MUSTER_BROKER_BOOKING_H

#include "broker/base/events.h"
#include "broker/base/share.h"
#include "broker/base/store.h"

struct broker;

/** Books a mail and its places in boxes.  @return false: refused and counted */
bool booking_take(struct broker *b, struct mail *m, uint32_t posts);

/** Books a mail of an earlier life of the broker.  @return false: the store is full */
bool booking_restore(struct broker *b, struct mail *m, uint32_t posts);

/**
 * Books places in boxes outside the lock step that the sender is in.  They are not on its account
 * inside, where its room must not depend on who acknowledges by the wall clock.
 *
 * @return false: refused and counted; nobody inside may be told
 */
bool booking_take_veiled(struct broker *b, struct mail *m, uint32_t posts);

/** Takes off its accounts what it has no more of: places, and with the last of them the mail. */
void booking_give_back(struct broker *b, struct mail *m);

/** Counts receivers that a mail does not reach; agent is whose box, or the broker itself. */
void booking_refused(struct broker *b, const struct mail *m, uint32_t agent, enum share_answer why,
                     uint64_t receivers);

/** One more event of a kind, now. */
void booking_event(struct broker *b, enum event_kind kind, uint32_t agent, uint32_t sender);

#endif
