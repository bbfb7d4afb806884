/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file change.h
 * Changes of groups and services from the command line, in the operator's name or another's.
 */
#ifndef MUSTER_CTL_CHANGE_H
#define MUSTER_CTL_CHANGE_H

#include "core/text.h"
#include "ctl/operator.h"

struct change {
    const char *program;      /* "muster group join" */
    const char *performative; /* of the mail to the broker */
    const char *content;      /* without the agent */
    bool of_nobody;           /* it concerns no agent */
};

/** Adds what `advertise` says of a service: its name, its attributes, its lease. */
void change_add_offer(struct mu_text *t, const char *service, const char *attributes,
                      double lease_s);

/** @return whether that can be an agent's name in which a change is made; said if not */
bool change_name_check(const char *program, const char *as);

/**
 * Makes a change in the name of options->as and leaves the operator joined.
 *
 * The operator says it to the broker, which asks the trust policy; an agent that nobody has heard
 * of joins for the moment, so that its name is known.
 *
 * @return the exit code, explained
 */
int change_make(struct operator* op, const struct operator_options *options,
                const struct change *c);

#endif
