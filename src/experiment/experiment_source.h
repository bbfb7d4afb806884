/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file experiment_source.h
 * The keys of an experiment file, and the steps in which experiment.c loads one.
 */
#ifndef MUSTER_EXPERIMENT_SOURCE_H
#define MUSTER_EXPERIMENT_SOURCE_H

#include "experiment/experiment.h"
#include "experiment/yaml/yaml_tree.h"

extern const struct yaml_key experiment_schema[];

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

/** Fills what the table of keys leaves open: robots' globals, names, places in the file. */
MU_MUST_USE mu_result experiment_fill(struct experiment_source *source);

/** Applies one override.  @return MU_OK or MU_FAULT_USAGE */
MU_MUST_USE mu_result experiment_override(struct experiment_source *source, const char *set);

/** Makes of a robot with a count so many robots, and says which share a process. */
MU_MUST_USE mu_result experiment_multiply(struct experiment_source *source);

/** Checks what no schema can: names, ranges, times, files; makes paths absolute. */
MU_MUST_USE mu_result experiment_check(struct experiment_source *source);

/* What checks share: a section of the file, an item of it, a robot by name, a broker or a host by
 * name (its index, or how many there are), and whether --set has set a field. */
int experiment_section(struct experiment_source *s, const char *key);
int experiment_item(struct experiment_source *s, const char *key, size_t index);
/* An entry of robots or, behind them, of agents. */
int experiment_member(struct experiment_source *s, size_t index);
const struct experiment_robot *experiment_find_robot(const struct experiment *e, const char *name);
unsigned experiment_find_broker(const struct experiment *e, const char *name);
unsigned experiment_find_host(const struct experiment *e, const char *name);
bool experiment_overridden(const struct experiment_source *s, const void *field);

/**
 * Replaces a path by the absolute one of an existing, readable file.
 *
 * @param what  the file is, for people
 */
MU_MUST_USE mu_result experiment_check_file(struct experiment_source *s, char **path, int node,
                                            const char *what);
/* The same for a program, which may be started. */
MU_MUST_USE mu_result experiment_check_program(struct experiment_source *s, char **path, int node);

/** @return whether the experiment was recorded: it lies elsewhere, with its rules and worlds, and
 * with no program */
bool experiment_is_recorded(void);

/** Checks one expectation, in experiment_expect.c, and notes the events that it is about. */
MU_MUST_USE mu_result experiment_check_expectation(struct experiment_source *s, size_t index);

/** Checks one monitor, in experiment_monitor.c. */
MU_MUST_USE mu_result experiment_check_monitor(struct experiment_source *s, size_t index);

/** Fills and checks one piece of chaos, in experiment_chaos.c. */
MU_MUST_USE mu_result experiment_fill_chaos(struct experiment_source *s, size_t index);
MU_MUST_USE mu_result experiment_check_chaos(struct experiment_source *s, size_t index);

/** @return where the file has a node */
struct experiment_mark experiment_mark(const struct experiment_source *s, int node);

/** Checks a condition.  @return MU_OK, or the fault at node */
MU_MUST_USE mu_result experiment_check_condition(struct experiment_source *s, const char *text,
                                                 int node);

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
