/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file desk.h
 * Mail to the broker itself and to its parts: directives, questions for a state, questions to the
 * white pages.
 */
#ifndef MUSTER_BROKER_DESK_H
#define MUSTER_BROKER_DESK_H

#include "broker/base/store.h"

struct broker;

/** Does what the mail wants, and answers it; own is whom it is for. */
void desk_take(struct broker *b, uint32_t own, struct mail *m);

#endif
