/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file returns.h
 * Mail that does not get through, and its receivers: for an agent whose own code does not keep its
 * mail, as rules do not.
 */
#ifndef MUSTER_RUNTIME_RETURNS_H
#define MUSTER_RUNTIME_RETURNS_H

#include "muster/agent.h"
#include "wire.h"

/**
 * The broker has answered that a mail will not arrive.
 *
 * @param to         as it was addressed; valid until this returns
 * @param directive  it was one
 * @param outcome    why: neither delivered, nor stored, nor a duplicate
 */
typedef void returns_handler(void *self, mu_agent *a, const char *to, bool directive,
                             enum mu_outcome outcome);

/** Tells an agent's handlers (mu_handlers.self) that a mail does not get through, by the
 * broker's first answer.  @param on_return  NULL: none is told */
void returns_hear(mu_agent *a, returns_handler *on_return);

/** Takes a receipt, before the outbox forgets the mail. */
void returns_take(mu_agent *a, const muster_Receipt *receipt);

#endif
