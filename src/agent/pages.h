/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pages.h
 * Groups and the yellow pages, as a mind's ports want them.
 */
#ifndef MUSTER_AGENT_PAGES_H
#define MUSTER_AGENT_PAGES_H

#include "mind/mind.h"
#include "muster/muster.h"

/** Begins a change; see mind_ports.change. */
MU_MUST_USE mu_result pages_change(mu_agent *a, enum mind_change change, const char *name,
                                   const char *attributes);

/** @return the index-th name of a list; see mind_ports.entry */
const char *pages_entry(const mu_process *p, enum mind_list list, const char *of, size_t index);

#endif
