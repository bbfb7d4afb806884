/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file yaml_check.h
 * Compares a YAML tree with a libcyaml schema, before libcyaml loads it.
 *
 * libcyaml stops at the first mismatch, too, but it names neither the known keys nor the allowed
 * words, reads "010" as eight, and takes NaN and -1 where they make no sense.
 */
#ifndef MUSTER_EXPERIMENT_YAML_CHECK_H
#define MUSTER_EXPERIMENT_YAML_CHECK_H

#include "experiment/yaml_tree.h"

#include <cyaml/cyaml.h>

/** @return MU_OK, or MU_FAULT_FILE with the place and what was expected there */
MU_MUST_USE mu_result yaml_check(struct yaml_tree *tree, int node,
                                 const cyaml_schema_value_t *schema, struct mu_fault *fault);

/** @return whether a text is a finite decimal number, all of it */
bool yaml_check_real(const char *text, double *value);

/** @return whether a text is a whole number from 0 to 2^64-1, decimal, without leading zeros */
bool yaml_check_uint(const char *text, unsigned long long *value);

#endif
