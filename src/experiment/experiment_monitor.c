/* SPDX-License-Identifier: Apache-2.0 */
/* Monitors of a run: rules, or a program of the user's. */
#include "core/name.h"
#include "experiment/experiment_source.h"

#include <string.h>

/* @return whether a part of the run, or a monitor before this one, has the name */
static bool name_is_taken(const struct experiment *e, size_t index)
{
    const char *name = e->monitors[index].name;
    bool taken =
        experiment_find_robot(e, name) != NULL || experiment_find_host(e, name) < e->hosts_count;
    for (size_t i = 0; i < index; i++) {
        taken = taken || strcmp(e->monitors[i].name, name) == 0;
    }
    return taken;
}

static mu_result name_check(struct experiment_source *s, size_t index, int node)
{
    const struct experiment_monitor *m = &s->experiment->monitors[index];
    int name = yaml_tree_child(s->tree, node, "name");
    name = name ? name : node;
    if (!mu_name_valid(m->name) || mu_name_reserved(m->name)) {
        return experiment_fault(s, NULL, name, "'%.80s' cannot be a monitor's name", m->name);
    }
    return name_is_taken(s->experiment, index)
               ? experiment_fault(s, NULL, name,
                                  "the name '%s' is taken; expected a name that no robot, host or "
                                  "other monitor has",
                                  m->name)
               : MU_OK;
}

mu_result experiment_check_monitor(struct experiment_source *s, size_t index)
{
    struct experiment_monitor *m = &s->experiment->monitors[index];
    int node = experiment_item(s, "monitors", index);
    if (!m->rules == !m->program) {
        return experiment_fault(s, NULL, node, "expected either rules: FILE, or program: FILE");
    }
    mu_result checked = name_check(s, index, node);
    if (checked != MU_OK) {
        return checked;
    }
    /* A recording has no programs, and a recorded run that is repeated starts no monitor. */
    if (m->program && experiment_is_recorded()) {
        return MU_OK;
    }
    return m->program
               ? experiment_check_program(s, &m->program, yaml_tree_child(s->tree, node, "program"))
               : experiment_check_file(s, &m->rules, yaml_tree_child(s->tree, node, "rules"),
                                       "rules");
}
