/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_origin.h
 * Who wrote a recording, for messages to people.
 */
#ifndef MUSTER_MCAP_MCAP_ORIGIN_H
#define MUSTER_MCAP_MCAP_ORIGIN_H

#include "core/text.h"
#include "mcap/mcap_read.h"

/** Adds "muster 0.1.0 on 2026-02-28", or "somebody else" where the recording does not say it; 100
 * bytes are enough. */
void mcap_origin_write(const struct mcap_reader *r, struct mu_text *to);

#endif
