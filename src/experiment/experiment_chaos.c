/* SPDX-License-Identifier: Apache-2.0 */
/* What goes wrong on purpose: which keys belong together, and what they may say. */
#include "core/sensors.h"
#include "core/text.h"
#include "experiment/experiment_source.h"

#include <string.h>

/* What is struck: a body of the world, or a part of the run that is a process. */
enum chaos_object { CHAOS_BODY, CHAOS_ROBOT, CHAOS_PART, CHAOS_PAIR };

/* The first key of each, and which keys may stand beside it. */
static const struct {
    const char *key;
    enum experiment_chaos_kind kind;
    enum chaos_object object;
    const char *needs, *may[3];
} chaos_kinds[] = {
    {"push", CHAOS_PUSH, CHAOS_BODY, NULL, {"force", "torque", "for"}},
    {"place", CHAOS_PLACE, CHAOS_BODY, "pose", {NULL}},
    {"block", CHAOS_BLOCK, CHAOS_ROBOT, "sensor", {"for"}},
    {"kill", CHAOS_KILL, CHAOS_PART, NULL, {"for", "wall_s"}},
    {"restart", CHAOS_RESTART, CHAOS_PART, NULL, {NULL}},
    {"stop", CHAOS_STOP, CHAOS_PART, NULL, {"for", "wall_s"}},
    {"continue", CHAOS_CONTINUE, CHAOS_PART, NULL, {NULL}},
    {"cut", CHAOS_CUT, CHAOS_PAIR, NULL, {"for", "wall_s"}},
    {"lose", CHAOS_LOSE, CHAOS_PAIR, "share", {"for"}},
    {"delay", CHAOS_DELAY, CHAOS_PAIR, "by_ms", {"for"}},
};

enum { CHAOS_WALL_MAX_S = 3600 };

enum { KINDS = sizeof chaos_kinds / sizeof chaos_kinds[0] };

static const char chaos_words[] =
    "push, place, block, kill, restart, stop, continue, cut, lose, delay";

/* --- filling ---------------------------------------------------------------------------------- */

mu_result experiment_fill_chaos(struct experiment_source *s, size_t index)
{
    struct experiment_chaos *c = &s->experiment->chaos[index];
    int node = experiment_item(s, "chaos", index);
    int lasts = yaml_tree_child(s->tree, node, "for");
    c->mark = experiment_mark(s, node);
    c->for_mark = lasts ? experiment_mark(s, lasts) : c->mark;
    for (size_t i = 0; i < KINDS; i++) {
        int child = yaml_tree_child(s->tree, node, chaos_kinds[i].key);
        if (!child) {
            continue;
        }
        if (c->kind != CHAOS_NONE) {
            return yaml_tree_fault(s->tree, child, s->fault, "expected only one of %s",
                                   chaos_words);
        }
        c->kind = chaos_kinds[i].kind;
    }
    return c->kind != CHAOS_NONE
               ? MU_OK
               : yaml_tree_fault(s->tree, node, s->fault, "expected one of %s", chaos_words);
}

/* --- checking --------------------------------------------------------------------------------- */

static bool is_part(const struct experiment *e, const char *name)
{
    bool known = strcmp(name, "broker") == 0 || strcmp(name, "simulator") == 0;
    return known || experiment_robot_find(e, name) >= 0 ||
           experiment_find_broker(e, name) < e->brokers_count ||
           experiment_find_host(e, name) < e->hosts_count || experiment_is_resolver(e, name);
}

static bool has_body(const struct experiment *e, const char *name)
{
    int robot = experiment_robot_find(e, name);
    return robot >= 0 && (unsigned)robot < e->robots_count;
}

static mu_result part_check(struct experiment_source *s, const char *name, int node)
{
    return is_part(s->experiment, name)
               ? MU_OK
               : experiment_fault(
                     s, NULL, node,
                     "no part '%.80s' in this run; expected a robot, an agent, a host, "
                     "resolver.SCHEME, broker, a broker's name, or simulator",
                     name);
}

static mu_result object_check(struct experiment_source *s, const struct experiment_chaos *c,
                              size_t kind, int node)
{
    int child = yaml_tree_child(s->tree, node, chaos_kinds[kind].key);
    switch (chaos_kinds[kind].object) {
    case CHAOS_BODY: return MU_OK; /* it may be a thing: the run knows when it has the world */
    case CHAOS_PART: return part_check(s, c->who, child);
    case CHAOS_ROBOT:
        return has_body(s->experiment, c->who)
                   ? MU_OK
                   : experiment_fault(s, NULL, child, "no robot '%.80s' in this experiment",
                                      c->who);
    case CHAOS_PAIR: break;
    }
    MU_TRY(part_check(s, c->who, yaml_tree_item(s->tree, child, 0)));
    if (strcmp(c->who, c->whom) == 0) {
        return experiment_fault(s, NULL, child, "expected two different parts");
    }
    return strcmp(c->whom, "all") == 0 ? MU_OK
                                       : part_check(s, c->whom, yaml_tree_item(s->tree, child, 1));
}

static bool may_stand(size_t kind, const char *key)
{
    bool may = strcmp(key, "at") == 0 || strcmp(key, "when") == 0 ||
               strcmp(key, chaos_kinds[kind].key) == 0 ||
               (chaos_kinds[kind].needs && strcmp(key, chaos_kinds[kind].needs) == 0);
    for (size_t i = 0; i < 3 && chaos_kinds[kind].may[i]; i++) {
        may = may || strcmp(key, chaos_kinds[kind].may[i]) == 0;
    }
    return may;
}

static mu_result keys_check(struct experiment_source *s, size_t kind, int node)
{
    const char *needs = chaos_kinds[kind].needs;
    for (size_t i = 0; i < yaml_tree_count(s->tree, node); i++) {
        int key = yaml_tree_key(s->tree, node, i);
        if (!may_stand(kind, yaml_tree_scalar(s->tree, key))) {
            return experiment_fault(s, NULL, key, "'%.40s' says nothing beside '%s'",
                                    yaml_tree_scalar(s->tree, key), chaos_kinds[kind].key);
        }
    }
    if (needs && !yaml_tree_child(s->tree, node, needs)) {
        return experiment_fault(s, NULL, node, "expected '%s' beside '%s'", needs,
                                chaos_kinds[kind].key);
    }
    return MU_OK;
}

static mu_result time_check(struct experiment_source *s, const struct experiment_chaos *c, int node)
{
    const struct experiment *e = s->experiment;
    int at = yaml_tree_child(s->tree, node, "at");
    int when = yaml_tree_child(s->tree, node, "when");
    if ((at != 0) + (when != 0) != 1) {
        return experiment_fault(s, NULL, node, "expected either at: a time, or when: a condition");
    }
    if (when) {
        return experiment_check_condition(s, c->when, when);
    }
    if (!(c->at >= 0)) {
        return experiment_fault(s, NULL, at, "expected a time from 0, not %g", c->at);
    }
    if (c->at > e->duration && !experiment_overridden(s, &e->duration)) {
        return experiment_fault(s, NULL, at, "expected a time of at most the duration, %g s",
                                e->duration);
    }
    return MU_OK;
}

/* How long it lasts. */
static mu_result times_check(struct experiment_source *s, const struct experiment_chaos *c,
                             int node)
{
    int lasts = yaml_tree_child(s->tree, node, "for");
    int wall = yaml_tree_child(s->tree, node, "wall_s");
    if (lasts && (!(c->for_s > 0) || c->for_s > EXPERIMENT_DURATION_MAX_S)) {
        return experiment_fault(s, NULL, lasts, "expected a time of more than 0 and at most %d s",
                                EXPERIMENT_DURATION_MAX_S);
    }
    if (wall && (!(c->wall_s > 0) || c->wall_s > CHAOS_WALL_MAX_S)) {
        return experiment_fault(s, NULL, wall, "expected a time of more than 0 and at most %d s",
                                CHAOS_WALL_MAX_S);
    }
    return lasts && wall ? experiment_fault(s, NULL, wall, "expected for or wall_s, not both")
                         : MU_OK;
}

static mu_result values_check(struct experiment_source *s, const struct experiment_chaos *c,
                              int node)
{
    if (c->sensor && mu_sensor_bits(c->sensor) == 0) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "sensor"),
                                "expected %s or all, not '%.40s'", MU_SENSOR_WORDS, c->sensor);
    }
    if (c->kind == CHAOS_PUSH && !c->force && !yaml_tree_child(s->tree, node, "torque")) {
        return experiment_fault(s, NULL, node, "expected force: [X, Y] or torque beside 'push'");
    }
    if (c->kind == CHAOS_LOSE && (!(c->share > 0) || c->share > 1)) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "share"),
                                "expected a share of more than 0 and at most 1, not %g", c->share);
    }
    if (c->kind == CHAOS_DELAY && (!(c->by_ms > 0) || c->by_ms > 10000)) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "by_ms"),
                                "expected a delay of more than 0 and at most 10000 ms, not %g",
                                c->by_ms);
    }
    return times_check(s, c, node);
}

/* What it does, for people. */
static void text_write(struct experiment_chaos *c)
{
    static const char *const words[] = {[CHAOS_NONE] = "",
                                        [CHAOS_PUSH] = "push",
                                        [CHAOS_PLACE] = "place",
                                        [CHAOS_BLOCK] = "block",
                                        [CHAOS_KILL] = "kill",
                                        [CHAOS_RESTART] = "restart",
                                        [CHAOS_STOP] = "stop",
                                        [CHAOS_CONTINUE] = "continue",
                                        [CHAOS_CUT] = "cut between",
                                        [CHAOS_LOSE] = "lose between",
                                        [CHAOS_DELAY] = "delay between"};
    struct mu_text t = mu_text_in(c->text, sizeof c->text);
    mu_text_format(&t, "%s %.40s", words[c->kind], c->who);
    if (c->whom) {
        mu_text_format(&t, " and %.40s", c->whom);
    }
    if (c->force) {
        mu_text_format(&t, " with %g, %g %s", c->force->x_m, c->force->y_m,
                       c->for_s > 0 ? "N" : "N s");
    }
    if (c->pose) {
        mu_text_format(&t, " at %g, %g, %g degrees", c->pose->x_m, c->pose->y_m,
                       c->pose->heading_deg);
    }
    if (c->sensor) {
        mu_text_format(&t, "'s %s", strcmp(c->sensor, "all") == 0 ? "sensors" : c->sensor);
    }
    if (c->kind == CHAOS_LOSE) {
        mu_text_format(&t, ": %g %% of the packets", c->share * 100);
    }
    if (c->kind == CHAOS_DELAY) {
        mu_text_format(&t, ": %g ms", c->by_ms);
    }
    if (c->for_s > 0) {
        mu_text_format(&t, " for %g s", c->for_s);
    }
    if (c->wall_s > 0) {
        mu_text_format(&t, " for %g s on the wall", c->wall_s);
    }
    if (c->when) {
        mu_text_format(&t, " when %.60s", c->when);
    }
}

mu_result experiment_check_chaos(struct experiment_source *s, size_t index)
{
    struct experiment_chaos *c = &s->experiment->chaos[index];
    int node = experiment_item(s, "chaos", index);
    size_t kind = 0;
    while (chaos_kinds[kind].kind != c->kind) {
        kind++;
    }
    MU_TRY(keys_check(s, kind, node));
    MU_TRY(object_check(s, c, kind, node));
    MU_TRY(time_check(s, c, node));
    MU_TRY(values_check(s, c, node));
    text_write(c);
    return MU_OK;
}
