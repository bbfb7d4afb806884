/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file receivers.h
 * TO and TARGETS of the command line: whom a mail is for.
 */
#ifndef MUSTER_CTL_RECEIVERS_H
#define MUSTER_CTL_RECEIVERS_H

#include "muster/agent.h"

/* What a person is told whose receivers are not valid. */
#define RECEIVERS_EXPECTED \
    "a name, names joined by commas, all, robots, special, group:G or SCHEME:REST"

/** @return whether nobody in particular is meant, so that nobody in particular has to answer */
bool receivers_are_many(const char *to);

/** @return whether all, robots, special or group:G means that agent */
bool receivers_have(const mu_process *p, const char *to, const struct mu_member *m);

/**
 * Counts those whose answer may be waited for: with names, each of them; else who is there now.
 *
 * @param from         the sender, who gets no mail of its own
 * @param robots_only  only robots know how to answer
 */
unsigned receivers_count(const mu_process *p, const char *to, const char *from, bool robots_only);

#endif
