/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file letter.h
 * A mail from the wire as programs see it.
 */
#ifndef MUSTER_RUNTIME_LETTER_H
#define MUSTER_RUNTIME_LETTER_H

#include "muster/agent.h"
#include "wire.h"

/** @return the same mail; its strings stay the sample's, and it has no place in a box */
struct mu_mail letter_of(const muster_Mail *m);

#endif
