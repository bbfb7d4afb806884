/* SPDX-License-Identifier: Apache-2.0 */
/* What is expected of a run: which keys belong together, and what they may say. */
#include "experiment/experiment_source.h"
#include "muster/memory.h"

#include <math.h>
#include <string.h>

static mu_result event_note(struct experiment_source *s, const char *text, int node)
{
    struct experiment *e = s->experiment;
    MU_TRY(experiment_check_condition(s, text, node));
    if (!e->events) {
        e->events = mu_startup_array(EXPERIMENT_EVENTS_MAX, sizeof *e->events);
        e->event_marks = mu_startup_array(EXPERIMENT_EVENTS_MAX, sizeof *e->event_marks);
    }
    if (experiment_event_find(e, text) < EXPERIMENT_EVENTS_MAX) {
        return MU_OK;
    }
    if (e->events_count == EXPERIMENT_EVENTS_MAX) {
        return experiment_fault(s, NULL, node, "expected at most %d different events",
                                EXPERIMENT_EVENTS_MAX);
    }
    e->event_marks[e->events_count] = experiment_mark(s, node);
    e->events[e->events_count++] = text;
    return MU_OK;
}

/* --- each expectation ------------------------------------------------------------------------- */

/* What is judged from a time on must be judged at all, unless the run is cut short. */
static mu_result check_from(struct experiment_source *s,
                            const struct experiment_expectation *expect, int node)
{
    const struct experiment *e = s->experiment;
    if (!(expect->from_s >= 0)) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "from"),
                                "expected from: a time from 0");
    }
    if (expect->from_s >= e->duration && !experiment_overridden(s, &e->duration)) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "from"),
                                "expected a time before the end of the run, %g s", e->duration);
    }
    return MU_OK;
}

static mu_result check_near(struct experiment_source *s, struct experiment_expectation *expect,
                            int node)
{
    const struct experiment *e = s->experiment;
    int near = yaml_tree_child(s->tree, node, "near");
    const char *names[] = {expect->near_robot, expect->near_mate};
    for (size_t i = 0; i < 2; i++) {
        int robot = experiment_robot_find(e, names[i]);
        if (robot < 0 || (unsigned)robot >= e->robots_count) {
            return experiment_fault(s, NULL, yaml_tree_item(s->tree, near, i),
                                    "no robot '%.80s' in this experiment", names[i]);
        }
    }
    if (strcmp(names[0], names[1]) == 0) {
        return experiment_fault(s, NULL, near, "expected two different robots");
    }
    if (!(expect->within_m > 0)) {
        int within = yaml_tree_child(s->tree, node, "within");
        return experiment_fault(s, NULL, within ? within : node,
                                "expected within: a distance of more than 0 m");
    }
    if (expect->from_s < 0 || !(expect->to_s > expect->from_s)) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "from"),
                                "expected from: a time from 0, and to: a later one");
    }
    MU_TRY(check_from(s, expect, node));
    if (!(expect->share > 0) || expect->share > 1) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "share"),
                                "expected a share of more than 0 and at most 1, not %g",
                                expect->share);
    }
    return MU_OK;
}

static mu_result check_objects(struct experiment_source *s, struct experiment_expectation *expect,
                               int node)
{
    if (!expect->at) {
        return experiment_fault(s, NULL, node, "expected at: [X, Y] beside 'objects'");
    }
    if (!(expect->within_m > 0)) {
        int within = yaml_tree_child(s->tree, node, "within");
        return experiment_fault(s, NULL, within ? within : node,
                                "expected within: a distance of more than 0 m");
    }
    int count = yaml_tree_child(s->tree, node, "count");
    if (count && expect->count == 0) {
        return experiment_fault(s, NULL, count, "expected a count of 1 or more");
    }
    return check_from(s, expect, node);
}

static mu_result check_inside(struct experiment_source *s, struct experiment_expectation *expect,
                              int node)
{
    if (strcmp(expect->inside, "arena") != 0) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "inside"),
                                "expected arena, not '%.80s'", expect->inside);
    }
    return MU_OK;
}

static mu_result check_stall(struct experiment_source *s, struct experiment_expectation *expect,
                             int node)
{
    if (!(expect->stall_max_s > 0)) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "stall-max"),
                                "expected a time of more than 0 s");
    }
    return MU_OK;
}

static mu_result check_statistic(struct experiment_source *s, struct experiment_expectation *expect,
                                 int node)
{
    int robot;
    if (experiment_statistic_find(s->experiment, expect->statistic, &robot) == STATISTICS) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "statistic"),
                                "no statistic '%.80s'; expected one of summary.json, such as "
                                "explored_fraction, mail.delivered, red.distance_m, or "
                                "robots.distance_m, the mean",
                                expect->statistic);
    }
    if (!isfinite(expect->at_least) && !isfinite(expect->at_most)) {
        return experiment_fault(s, NULL, node, "expected at_least or at_most beside 'statistic'");
    }
    if (expect->at_least > expect->at_most) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "at_most"),
                                "expected at_most: no less than at_least, %g", expect->at_least);
    }
    return check_from(s, expect, node);
}

static mu_result check_sequence(struct experiment_source *s, struct experiment_expectation *expect,
                                int node)
{
    int sequence = yaml_tree_child(s->tree, node, "sequence");
    int within = yaml_tree_child(s->tree, node, "within_s");
    for (unsigned i = 0; i < expect->sequence_count; i++) {
        MU_TRY(event_note(s, expect->sequence[i], yaml_tree_item(s->tree, sequence, i)));
    }
    if (within && !(expect->within_s > 0)) {
        return experiment_fault(s, NULL, within, "expected a time of more than 0 s");
    }
    return check_from(s, expect, node);
}

static mu_result check_never(struct experiment_source *s, struct experiment_expectation *expect,
                             int node)
{
    MU_TRY(event_note(s, expect->never, yaml_tree_child(s->tree, node, "never")));
    return check_from(s, expect, node);
}

/* The first key of each, what checks it, and which keys may stand beside it. */
static const struct {
    const char *key;
    mu_result (*check)(struct experiment_source *s, struct experiment_expectation *expect,
                       int node);
    const char *beside[5];
} expect_kinds[] = {
    {"near", check_near, {"within", "from", "to", "share"}},
    {"objects", check_objects, {"within", "from", "at", "count"}},
    {"inside", check_inside, {NULL}},
    {"stall-max", check_stall, {NULL}},
    {"statistic", check_statistic, {"at_least", "at_most", "from"}},
    {"sequence", check_sequence, {"within_s", "from"}},
    {"never", check_never, {"from"}},
};

enum { KINDS = sizeof expect_kinds / sizeof expect_kinds[0] };

static bool is_beside(size_t kind, const char *key)
{
    for (size_t i = 0; i < 5 && expect_kinds[kind].beside[i]; i++) {
        if (strcmp(expect_kinds[kind].beside[i], key) == 0) {
            return true;
        }
    }
    return false;
}

/* A key that belongs to another expectation: says to which. */
static mu_result check_beside(struct experiment_source *s, size_t kind, int node)
{
    for (size_t i = 0; i < yaml_tree_count(s->tree, node); i++) {
        int key = yaml_tree_key(s->tree, node, i);
        const char *name = yaml_tree_scalar(s->tree, key);
        if (strcmp(name, expect_kinds[kind].key) == 0 || is_beside(kind, name)) {
            continue;
        }
        for (size_t k = 0; k < KINDS; k++) {
            if (is_beside(k, name)) {
                return experiment_fault(s, NULL, yaml_tree_value(s->tree, node, i),
                                        "expected '%s' beside '%s' only", name,
                                        expect_kinds[k].key);
            }
        }
    }
    return MU_OK;
}

mu_result experiment_check_expectation(struct experiment_source *s, size_t index)
{
    int node = experiment_item(s, "expect", index);
    size_t found = 0, kind = 0;
    for (size_t i = 0; i < KINDS; i++) {
        bool there = yaml_tree_child(s->tree, node, expect_kinds[i].key) != 0;
        kind = there ? i : kind;
        found += there;
    }
    if (found != 1) {
        return experiment_fault(s, NULL, node,
                                "expected one of near, inside, stall-max, objects, "
                                "statistic, sequence, never");
    }
    mu_result beside = check_beside(s, kind, node);
    return beside == MU_OK ? expect_kinds[kind].check(s, &s->experiment->expect[index], node)
                           : beside;
}
