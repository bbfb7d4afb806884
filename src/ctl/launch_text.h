/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file launch_text.h
 * What a host is sent of an agent that is launched there: a passport, a line for each global and
 * group, and the rules.  It goes in pieces, as directives `launch`.
 */
#ifndef MUSTER_CTL_LAUNCH_TEXT_H
#define MUSTER_CTL_LAUNCH_TEXT_H

#include "core/text.h"
#include "muster/result.h"

#include <stdbool.h>
#include <stdint.h>

enum { LAUNCH_RULES_MAX = 512 * 1024, LAUNCH_HEAD_MAX = 8 * 1024 };

/** Begins the text, in memory that lives as long as the process.  @param start  it runs at once */
struct mu_text *launch_text_begin(const char *name, bool start, int64_t seed);

/** Adds the rules of a file.  @return MU_OK; MU_FAULT_FILE: what is wrong is said */
MU_MUST_USE mu_result launch_text_rules(struct mu_text *out, const char *file);

#endif
