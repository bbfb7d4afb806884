/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file experiment_schema.h
 * The keys of an experiment file, and the steps in which experiment.c loads one.
 */
#ifndef MUSTER_EXPERIMENT_SCHEMA_H
#define MUSTER_EXPERIMENT_SCHEMA_H

#include "experiment/experiment.h"
#include "experiment/yaml_tree.h"

#include <cyaml/cyaml.h>

extern const cyaml_schema_value_t experiment_schema;

/* Of a robot's name, and others. */
enum { EXPERIMENT_TEXT_MAX = 4096 };

/* An experiment while it is loaded. */
struct experiment_source {
    const char *path;
    struct yaml_tree *tree;
    struct experiment *experiment;
    struct mu_fault *fault;
    struct {
        const void *field; /* of the experiment: what was set */
        const char *text;  /* "duration=30" */
    } overrides[EXPERIMENT_OVERRIDES_MAX];
    size_t overrides_count;
};

/**
 * Fills what the schema leaves open: robots' globals, the observer's targets, who is near whom,
 * and the values of keys that are not there.
 */
MU_MUST_USE mu_result experiment_fill(struct experiment_source *source);

/** Applies one override.  @return MU_OK or MU_FAULT_USAGE */
MU_MUST_USE mu_result experiment_override(struct experiment_source *source, const char *set);

/** Makes of a robot with a count so many robots, and says which share a process. */
MU_MUST_USE mu_result experiment_multiply(struct experiment_source *source);

/** Checks what no schema can: names, ranges, times, files; makes paths absolute. */
MU_MUST_USE mu_result experiment_check(struct experiment_source *source);

/**
 * Fills the fault for a wrong value.
 *
 * @param field  of the experiment; when an override set it, the fault is the override's
 * @param node   where the file has it
 * @return MU_FAULT_FILE, or MU_FAULT_USAGE for an override
 */
mu_result experiment_fault(struct experiment_source *source, const void *field, int node,
                           const char *format, ...) __attribute__((format(printf, 4, 5)));

#endif
