/* SPDX-License-Identifier: Apache-2.0 */
/* (plan x y): a way over the map of what stands in the world. */
#include "mind/functions/table.h"
#include "planner/planner.h"

#include <math.h>

/* The cells of the map that cost as much as one turn of a loop. */
enum { PLAN_CELLS_A_TICK = 8 };

void path_has_map(void *env, DATA_OBJECT *out)
{
    value_bool(env, out, environment_mind(env)->options.planner != NULL);
}

void path_plan(void *env, DATA_OBJECT *out)
{
    static struct path path; /* large; read only until the fields are made */
    struct mind *m = environment_mind(env);
    const struct mu_percept *p = &inputs_of(m)->percept;
    double to_mm[2];
    value_bool(env, out, false);
    if (!value_numbers(env, "plan", 2, to_mm)) {
        return;
    }
    if (!sensors_have_body(env, "plan") || !m->options.planner ||
        inputs_of(m)->body != PERCEPT_BODY || !isfinite(to_mm[0]) || !isfinite(to_mm[1])) {
        return;
    }
    double from_m[2] = {p->x_m, p->y_m};
    double to_m[2] = {to_mm[0] / 1000, to_mm[1] / 1000};
    mu_result found = planner_search(m->options.planner, from_m, to_m, m->options.half_m, &path);
    (void)budget_charge(m, BUDGET_UNITS_A_TICK * (path.looked / PLAN_CELLS_A_TICK));
    if (found != MU_OK) {
        return;
    }
    double points_mm[2 * PATH_POINTS_MAX];
    for (size_t i = 0; i < 2 * path.count; i++) {
        points_mm[i] = 1000 * path.points_m[i / 2][i % 2];
    }
    value_floats(env, out, 2 * path.count, points_mm);
}
