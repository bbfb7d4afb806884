/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file yaml_tree.h
 * A YAML document with the place of each node, for errors with line and column; and tables of keys,
 * by which mappings are read into structs.
 *
 * Nodes are numbers from 1; 0 is "there is none", and every call understands it.
 */
#ifndef MUSTER_EXPERIMENT_YAML_TREE_H
#define MUSTER_EXPERIMENT_YAML_TREE_H

#include "core/fault.h"

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

/* The value of a key, or each entry of its list, and what it is read into. */
enum yaml_key_kind {
    YAML_KEY_ANY,   /* the caller reads it */
    YAML_KEY_TEXT,  /* char *: not empty */
    YAML_KEY_REAL,  /* double: finite */
    YAML_KEY_WHOLE, /* uint64_t */
    YAML_KEY_COUNT, /* unsigned */
    YAML_KEY_BOOL,  /* bool */
    YAML_KEY_WORD,  /* an enum: the index of one of `words`; `what` lists them */
    YAML_KEY_KEYS   /* a struct: a mapping with `keys` */
};

/* One key of a mapping; a table of them ends with a key NULL. */
struct yaml_key {
    const char *key;
    enum yaml_key_kind kind;
    size_t offset; /* in the struct: of the value, of a list's pointer, or of a pair's first */
    bool needed;
    bool set;          /* a command line may replace the value */
    unsigned min, max; /* entries of the list; 0, 0: it is one value */
    size_t size;       /* of an entry */
    size_t count;      /* in the struct: of the unsigned that counts entries; 0: none */
    bool single;       /* one value may stand for a list of one */
    bool pair;         /* two entries, in the struct itself */
    const struct yaml_key *keys;
    const char *alone; /* a word that may stand for the mapping; then the struct's first, a bool, is
                          true */
    const char *const *words;
    const char *what; /* is expected, for people; NULL: as the kind says */
    double absent;    /* a number that the file does not have */
};

/**
 * Reads a mapping into a struct of zeros; lists and texts become start-up memory.
 *
 * @return MU_OK, or MU_FAULT_FILE with the place and what was expected there
 */
MU_MUST_USE mu_result yaml_keys_read(struct yaml_tree *tree, int node, const struct yaml_key *keys,
                                     void *into, struct mu_fault *fault);

/** Reads one scalar.  @return NULL, or what was expected, for people */
const char *yaml_keys_put(const struct yaml_key *key, void *field, const char *text);

#endif
