/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file options_config.h
 * The parts of options.c that it shares: one value put into its target, and the configuration file.
 */
#ifndef MUSTER_CORE_OPTIONS_CONFIG_H
#define MUSTER_CORE_OPTIONS_CONFIG_H

#include "core/options.h"

enum { MU_OPTION_WHY_MAX = 128 };

/**
 * Puts a value into an option's target.  Strings are not copied.
 *
 * The source must be set before: a list on the command line takes one item a call; any other
 * source gives the whole list, with commas.
 *
 * @param why  the expected value, when the answer is false
 */
bool mu_option_set(struct mu_option *option, const char *value, char why[MU_OPTION_WHY_MAX]);

/**
 * Reads the configuration file into the options that are still at their default.
 *
 * @param path  what --config said, which must exist; NULL: the usual places, which need not
 * @return MU_OK or MU_FAULT_FILE, already explained on standard error
 */
MU_MUST_USE mu_result mu_options_read_config(struct mu_options *options, const char *path);

#endif
