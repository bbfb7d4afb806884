/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file policy.h
 * The trust policy: whose directives are carried out.
 */
#ifndef MUSTER_BROKER_POLICY_H
#define MUSTER_BROKER_POLICY_H

#include <stdbool.h>

/** @return whether that agent may send directives */
bool policy_may_direct(const char *src);

#endif
