/* SPDX-License-Identifier: Apache-2.0 */
/* What libcyaml's schemas cannot say: keys that the user invents, one value or a list of them, and
 * values of keys that are absent. */
#include "experiment/experiment_source.h"
#include "muster/limits.h"
#include "muster/memory.h"

#include <math.h>
#include <string.h>

enum { FILL_CHECKPOINT_S = 1, FILL_RESTARTS = 5, FILL_RETURN_WITHIN_S = 20 };

static int fill_section(struct experiment_source *s, const char *key, size_t index)
{
    int list = yaml_tree_child(s->tree, yaml_tree_root(s->tree), key);
    return yaml_tree_item(s->tree, list, index);
}

static mu_result fill_globals(struct experiment_source *s, struct experiment_robot *robot, int node)
{
    int globals = yaml_tree_child(s->tree, node, "globals");
    size_t count = yaml_tree_count(s->tree, globals);
    if (globals && yaml_tree_kind(s->tree, globals) != YAML_TREE_MAPPING) {
        return yaml_tree_fault(s->tree, globals, s->fault,
                               "expected a mapping of globals, such as {mate: red}");
    }
    if (count > EXPERIMENT_GLOBALS_MAX) {
        return yaml_tree_fault(s->tree, globals, s->fault, "expected at most %d globals, not %zu",
                               EXPERIMENT_GLOBALS_MAX, count);
    }
    /* Room for what overrides add. */
    robot->globals = mu_startup_array(count + EXPERIMENT_OVERRIDES_MAX, sizeof *robot->globals);
    for (size_t i = 0; i < count; i++) {
        int value = yaml_tree_value(s->tree, globals, i);
        if (yaml_tree_kind(s->tree, value) != YAML_TREE_SCALAR) {
            return yaml_tree_fault(s->tree, value, s->fault, "expected one CLIPS field");
        }
        struct experiment_global *global = &robot->globals[robot->globals_count++];
        int key = yaml_tree_key(s->tree, globals, i);
        global->name = mu_startup_string(yaml_tree_scalar(s->tree, key));
        global->value = mu_startup_string(yaml_tree_scalar(s->tree, value));
    }
    return MU_OK;
}

/* `do: red`, or `do: [red, blue]`. */
static mu_result fill_targets(struct experiment_source *s, struct experiment_command *command,
                              int node)
{
    int targets = yaml_tree_child(s->tree, node, "do");
    bool list = yaml_tree_kind(s->tree, targets) == YAML_TREE_LIST;
    size_t count = list ? yaml_tree_count(s->tree, targets) : 1;
    if (count == 0 || count > MU_ROBOTS_MAX) {
        return yaml_tree_fault(s->tree, targets, s->fault, "expected 1 to %d names, not %zu",
                               MU_ROBOTS_MAX, count);
    }
    command->targets = mu_startup_array(count, sizeof *command->targets);
    for (size_t i = 0; i < count; i++) {
        int target = list ? yaml_tree_item(s->tree, targets, i) : targets;
        if (yaml_tree_kind(s->tree, target) != YAML_TREE_SCALAR) {
            return yaml_tree_fault(s->tree, target, s->fault,
                                   "expected a robot's name, all, or a list of names");
        }
        command->targets[i] = mu_startup_string(yaml_tree_scalar(s->tree, target));
        command->targets_count++;
    }
    return MU_OK;
}

static mu_result fill_expectation(struct experiment_source *s,
                                  struct experiment_expectation *expect, int node)
{
    int near = yaml_tree_child(s->tree, node, "near");
    if (near && yaml_tree_count(s->tree, near) != 2) {
        return yaml_tree_fault(s->tree, near, s->fault,
                               "expected two robots, who and whom, such as [blue, red]");
    }
    if (near) {
        expect->near_robot =
            mu_startup_string(yaml_tree_scalar(s->tree, yaml_tree_item(s->tree, near, 0)));
        expect->near_mate =
            mu_startup_string(yaml_tree_scalar(s->tree, yaml_tree_item(s->tree, near, 1)));
    }
    if (!yaml_tree_child(s->tree, node, "share")) {
        expect->share = 1.0;
    }
    if (!yaml_tree_child(s->tree, node, "at_least")) {
        expect->at_least = -INFINITY;
    }
    if (!yaml_tree_child(s->tree, node, "at_most")) {
        expect->at_most = INFINITY;
    }
    return MU_OK;
}

/* The file's name without folder and ending; what no folder may bear becomes a dash. */
static char *fill_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *name = mu_startup_string(slash ? slash + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot && dot != name) {
        *dot = '\0';
    }
    static const char good[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
    for (char *c = name + strspn(name, good); *c; c += strspn(c, good)) {
        *c = '-';
    }
    if (name[0] == '.' || name[0] == '-') {
        name[0] = '_';
    }
    return name;
}

static void fill_absent(struct experiment_source *s)
{
    struct experiment *e = s->experiment;
    int root = yaml_tree_root(s->tree);
    e->file = mu_startup_string(s->path);
    if (!e->name) {
        e->name = fill_name(s->path);
    }
    if (!yaml_tree_child(s->tree, root, "seed")) {
        e->seed = 1;
    }
    if (!yaml_tree_child(s->tree, root, "step_ms")) {
        e->step_ms = (double)MU_STEP_NS / 1e6;
    }
    if (!yaml_tree_child(s->tree, root, "checkpoint")) {
        e->checkpoint_s = FILL_CHECKPOINT_S;
    }
    if (!yaml_tree_child(s->tree, root, "restarts")) {
        e->restarts = FILL_RESTARTS;
    }
    if (!yaml_tree_child(s->tree, root, "return-within")) {
        e->return_within_s = FILL_RETURN_WITHIN_S;
    }
}

static mu_result fill_robot(struct experiment_source *s, size_t index)
{
    struct experiment_robot *robot = &s->experiment->robots[index];
    struct mu_fault here;
    (void)yaml_tree_fault(s->tree, experiment_item(s, "robots", index), &here, "%s", "");
    robot->mark = (struct experiment_mark){here.line, here.column};
    return fill_globals(s, robot, fill_section(s, "robots", index));
}

mu_result experiment_fill(struct experiment_source *source)
{
    struct experiment *e = source->experiment;
    mu_result result = MU_OK;
    fill_absent(source);
    for (size_t i = 0; i < e->robots_count && result == MU_OK; i++) {
        result = fill_robot(source, i);
    }
    for (size_t i = 0; i < e->observer_count && result == MU_OK; i++) {
        result = fill_targets(source, &e->observer[i], fill_section(source, "observer", i));
    }
    for (size_t i = 0; i < e->expect_count && result == MU_OK; i++) {
        result = fill_expectation(source, &e->expect[i], fill_section(source, "expect", i));
    }
    for (size_t i = 0; i < e->monitors_count; i++) {
        experiment_fill_monitor(source, i);
    }
    for (size_t i = 0; i < e->chaos_count && result == MU_OK; i++) {
        result = experiment_fill_chaos(source, i);
    }
    return result;
}
