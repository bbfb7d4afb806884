/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file direct.h
 * A directive to one agent or many, each of which gets a mail of its own and has a line of its own:
 * its answer, a refusal, or its silence.
 */
#ifndef MUSTER_CTL_DIRECT_H
#define MUSTER_CTL_DIRECT_H

#include "ctl/operator.h"

struct direct {
    const char *to, *performative, *content;
    double wait_s; /* for answers */
    bool may_wait; /* an agent that is away does it when it is back: that counts as done */
};

/** Lets the operator hand over what comes; before it joins. */
void direct_hear(struct operator_options *options);

/** @return whether the command line can say which agents are meant: no resolver is asked */
bool direct_is_possible(const char *to);

/**
 * Sends it to each and waits for what becomes of it; of several receivers, counts are the last
 * object with --json.
 *
 * @return MU_EXIT_DONE if all did it, else the smallest exit code of a receiver
 */
int direct_send(struct operator* o, const struct direct *d);

#endif
