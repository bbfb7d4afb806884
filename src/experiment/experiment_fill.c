/* SPDX-License-Identifier: Apache-2.0 */
/* What the table of keys does not say: keys that the user invents, places in the file, and texts
 * that are absent. */
#include "experiment/experiment_source.h"
#include "muster/memory.h"

#include <string.h>

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

/* Puts the agents without a body behind the robots, in one list. */
static void fill_members(struct experiment *e)
{
    struct experiment_robot *all = mu_startup_array(experiment_members(e), sizeof *all);
    for (unsigned i = 0; i < experiment_members(e); i++) {
        all[i] = i < e->robots_count ? e->robots[i] : e->agents[i - e->robots_count];
    }
    e->robots = all;
    e->agents = all + e->robots_count;
}

mu_result experiment_fill(struct experiment_source *source)
{
    struct experiment *e = source->experiment;
    e->file = mu_startup_string(source->path);
    if (!e->name) {
        e->name = fill_name(source->path);
    }
    if (!e->world && !e->simulator.none) {
        return yaml_tree_fault(source->tree, yaml_tree_root(source->tree), source->fault,
                               "expected a key 'world' here");
    }
    if (experiment_members(e) == 0) {
        return yaml_tree_fault(source->tree, yaml_tree_root(source->tree), source->fault,
                               "expected robots, or agents");
    }
    fill_members(e);
    for (size_t i = 0; i < experiment_members(e); i++) {
        int node = experiment_member(source, i);
        e->robots[i].mark = experiment_mark(source, node);
        MU_TRY(fill_globals(source, &e->robots[i], node));
    }
    for (size_t i = 0; i < e->monitors_count; i++) {
        struct experiment_monitor *m = &e->monitors[i];
        m->mark = experiment_mark(source, experiment_item(source, "monitors", i));
        m->name = m->name ? m->name : mu_startup_string("monitor");
    }
    for (size_t i = 0; i < e->chaos_count; i++) {
        MU_TRY(experiment_fill_chaos(source, i));
    }
    return MU_OK;
}
