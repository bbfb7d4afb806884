/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file yaml_tree.h
 * A YAML document with the place of each node, for what libcyaml cannot load (keys that the user
 * invents, one-or-many values) and for errors with line and column; and its comparison with a
 * libcyaml schema, before libcyaml loads it.
 *
 * Nodes are numbers from 1; 0 is "there is none", and every call understands it.
 */
#ifndef MUSTER_EXPERIMENT_YAML_TREE_H
#define MUSTER_EXPERIMENT_YAML_TREE_H

#include "core/fault.h"

#include <cyaml/cyaml.h>
#include <stdbool.h>
#include <stddef.h>

struct yaml_tree;

enum yaml_tree_kind { YAML_TREE_NONE, YAML_TREE_SCALAR, YAML_TREE_LIST, YAML_TREE_MAPPING };

/**
 * Parses a text.  It must live as long as the tree.
 *
 * @param path  for faults
 * @return MU_OK, or MU_FAULT_FILE for wrong YAML
 */
MU_MUST_USE mu_result yaml_tree_open(struct yaml_tree **out, const char *path, const char *text,
                                     size_t len, struct mu_fault *fault);

void yaml_tree_close(struct yaml_tree *tree);

int yaml_tree_root(struct yaml_tree *tree);
enum yaml_tree_kind yaml_tree_kind(struct yaml_tree *tree, int node);

/** @return the text of a scalar, "" for anything else */
const char *yaml_tree_scalar(struct yaml_tree *tree, int node);

/** @return the items of a list, or the keys of a mapping */
size_t yaml_tree_count(struct yaml_tree *tree, int node);

int yaml_tree_item(struct yaml_tree *tree, int node, size_t index);
int yaml_tree_key(struct yaml_tree *tree, int node, size_t index);
int yaml_tree_value(struct yaml_tree *tree, int node, size_t index);

/** @return the value of a key of a mapping, or 0 */
int yaml_tree_child(struct yaml_tree *tree, int node, const char *key);

/**
 * Fills a fault with the place of a node.
 *
 * @return MU_FAULT_FILE
 */
mu_result yaml_tree_fault(struct yaml_tree *tree, int node, struct mu_fault *fault,
                          const char *format, ...) __attribute__((format(printf, 4, 5)));

/**
 * Compares a node with a schema.
 *
 * libcyaml stops at the first mismatch, too, but it names neither the known keys nor the allowed
 * words, reads "010" as eight, and takes NaN and -1 where they make no sense.
 *
 * @return MU_OK, or MU_FAULT_FILE with the place and what was expected there
 */
MU_MUST_USE mu_result yaml_check(struct yaml_tree *tree, int node,
                                 const cyaml_schema_value_t *schema, struct mu_fault *fault);

/** @return whether a text is a finite decimal number, all of it */
bool yaml_check_real(const char *text, double *value);

/** @return whether a text is a whole number from 0 to 2^64-1, decimal, without leading zeros */
bool yaml_check_uint(const char *text, unsigned long long *value);

#endif
