/* SPDX-License-Identifier: Apache-2.0 */
/* What no schema can say: names, ranges, times, files. */
#include "core/address.h"
#include "core/attributes.h"
#include "core/name.h"
#include "experiment/experiment_source.h"
#include "muster/limits.h"
#include "world/world_load.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    CHECK_DURATION_MAX_S = EXPERIMENT_DURATION_MAX_S,
    CHECK_STEP_MAX_MS = 10000,
    CHECK_INTERVAL_MAX_MS = 60000,
    CHECK_SUBSTEP_MS = 20,
    CHECK_NAME_MAX = 63,
    CHECK_CHECKPOINT_MAX_S = 1000000,
    CHECK_RESTARTS_MAX = 1000,
    CHECK_RETURN_MAX_S = 3600
};

/* @return whether muster-resolver knows it */
static bool check_scheme(const char *scheme)
{
    static const char *const schemes[] = {MU_SCHEMES};
    for (size_t i = 0; i < sizeof schemes / sizeof schemes[0]; i++) {
        if (strcmp(scheme, schemes[i]) == 0) {
            return true;
        }
    }
    return false;
}

static mu_result check_resolvers(struct experiment_source *s)
{
    const struct experiment *e = s->experiment;
    for (unsigned i = 0; i < e->resolvers_count; i++) {
        if (!check_scheme(e->resolvers[i])) {
            return experiment_fault(s, NULL, experiment_item(s, "resolvers", i),
                                    "expected a scheme of addresses: role, task or near, not "
                                    "'%.80s'",
                                    e->resolvers[i]);
        }
        for (unsigned k = 0; k < i; k++) {
            if (strcmp(e->resolvers[k], e->resolvers[i]) == 0) {
                return experiment_fault(s, NULL, experiment_item(s, "resolvers", i),
                                        "'%s' stands here a second time", e->resolvers[i]);
            }
        }
    }
    return MU_OK;
}

static mu_result check_hosts(struct experiment_source *s)
{
    const struct experiment *e = s->experiment;
    for (unsigned i = 0; i < e->hosts_count; i++) {
        const char *name = e->hosts[i];
        if (!mu_name_valid(name) || mu_name_reserved(name)) {
            return experiment_fault(s, NULL, experiment_item(s, "hosts", i),
                                    "'%.80s' cannot be a host's name", name);
        }
        if (experiment_find_host(e, name) != i || experiment_find_robot(e, name)) {
            return experiment_fault(s, NULL, experiment_item(s, "hosts", i),
                                    "a second host, or a robot, has the name '%s'", name);
        }
    }
    return MU_OK;
}

/* Without a simulator there is nothing that has a place. */
static mu_result check_no_simulator(struct experiment_source *s)
{
    static char none[] = WORLD_NONE;
    struct experiment *e = s->experiment;
    if (e->world) {
        return experiment_fault(s, &e->world, experiment_section(s, "world"),
                                "expected no world: there is no simulator");
    }
    if (e->robots_count > 0) {
        return experiment_fault(s, NULL, experiment_section(s, "robots"),
                                "expected agents alone: there is no simulator that moves robots");
    }
    e->world = none;
    return MU_OK;
}

/* 0 stands for a number that is not given. */
static mu_result check_simulator(struct experiment_source *s)
{
    const uint64_t *threads = &s->experiment->simulator.threads;
    int node = yaml_tree_child(s->tree, experiment_section(s, "simulator"), "threads");
    bool said = node != 0 || experiment_overridden(s, threads);
    if ((said && *threads == 0) || *threads > EXPERIMENT_THREADS_MAX) {
        return experiment_fault(s, threads, node, "expected 1 to %d threads, not %llu",
                                EXPERIMENT_THREADS_MAX, (unsigned long long)*threads);
    }
    return MU_OK;
}

static mu_result check_checkpoint(struct experiment_source *s, const double *checkpoint_s, int node)
{
    if (*checkpoint_s >= 0 && *checkpoint_s <= CHECK_CHECKPOINT_MAX_S) {
        return MU_OK;
    }
    return experiment_fault(s, checkpoint_s, node, "expected a time of 0 to %d s, not %g",
                            CHECK_CHECKPOINT_MAX_S, *checkpoint_s);
}

static mu_result check_restart(struct experiment_source *s)
{
    const struct experiment *e = s->experiment;
    MU_TRY(check_checkpoint(s, &e->checkpoint_s, experiment_section(s, "checkpoint")));
    if (e->restarts > CHECK_RESTARTS_MAX) {
        return experiment_fault(s, &e->restarts, experiment_section(s, "restarts"),
                                "expected 0 to %d restarts, not %u", CHECK_RESTARTS_MAX,
                                e->restarts);
    }
    if (!(e->return_within_s > 0) || e->return_within_s > CHECK_RETURN_MAX_S) {
        return experiment_fault(s, &e->return_within_s, experiment_section(s, "return-within"),
                                "expected a time of more than 0 and at most %d s, not %g",
                                CHECK_RETURN_MAX_S, e->return_within_s);
    }
    return MU_OK;
}

static mu_result check_top(struct experiment_source *s)
{
    struct experiment *e = s->experiment;
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";
    size_t len = strlen(e->name);
    if (e->name[strspn(e->name, letters)] || len > CHECK_NAME_MAX || strchr(".-", e->name[0])) {
        return experiment_fault(s, &e->name, experiment_section(s, "name"),
                                "expected a name of at most %d letters, digits, _ . - that begins "
                                "with a letter, digit or _, not '%.80s'",
                                CHECK_NAME_MAX, e->name);
    }
    if (!(e->duration > 0) || e->duration > CHECK_DURATION_MAX_S) {
        return experiment_fault(s, &e->duration, experiment_section(s, "duration"),
                                "expected a duration of more than 0 and at most %d s, not %g",
                                CHECK_DURATION_MAX_S, e->duration);
    }
    if (e->step_ms < 1 || e->step_ms > CHECK_STEP_MAX_MS) {
        return experiment_fault(s, &e->step_ms, experiment_section(s, "step_ms"),
                                "expected a control step of 1 to %d ms, not %g", CHECK_STEP_MAX_MS,
                                e->step_ms);
    }
    if (fmod(e->step_ms, CHECK_SUBSTEP_MS) != 0.0) {
        return experiment_fault(s, &e->step_ms, experiment_section(s, "step_ms"),
                                "expected a multiple of %d ms, the step of the physics, not %g",
                                CHECK_SUBSTEP_MS, e->step_ms);
    }
    for (unsigned i = 0; i < e->brokers_count; i++) {
        if (!mu_name_valid(e->brokers[i]) || mu_name_reserved(e->brokers[i])) {
            return experiment_fault(s, NULL, experiment_item(s, "brokers", i),
                                    "'%.80s' cannot be a broker's name", e->brokers[i]);
        }
        if (experiment_find_broker(e, e->brokers[i]) != i) {
            return experiment_fault(s, NULL, experiment_item(s, "brokers", i),
                                    "a second broker with the name '%s'", e->brokers[i]);
        }
    }
    double interval_ms = e->broker.delivery_interval_ms;
    if (!(interval_ms >= 0 && interval_ms <= CHECK_INTERVAL_MAX_MS)) {
        int broker = experiment_section(s, "broker");
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, broker, "delivery-interval"),
                                "expected an interval of 0 to %d ms, not %g", CHECK_INTERVAL_MAX_MS,
                                interval_ms);
    }
    MU_TRY(check_restart(s));
    if (e->policy) {
        MU_TRY(experiment_check_file(s, &e->policy, experiment_section(s, "policy"), "policy"));
    }
    return e->simulator.none
               ? check_no_simulator(s)
               : experiment_check_file(s, &e->world, experiment_section(s, "world"), "world");
}

/* A global's value goes into a CLIPS line: one field, so that it cannot be anything else. */
static bool check_field(const char *value)
{
    size_t len = strlen(value);
    if (len >= 2 && value[0] == '"' && value[len - 1] == '"') {
        for (size_t i = 1; i + 1 < len; i++) {
            if (value[i] == '"' || (value[i] == '\\' && ++i + 1 == len)) {
                return false;
            }
        }
        return true;
    }
    return len > 0 && value[strcspn(value, " \t\r\n\"()&|<~;$?")] == '\0';
}

static mu_result check_globals(struct experiment_source *s, const struct experiment_robot *robot,
                               int node)
{
    int globals = yaml_tree_child(s->tree, node, "globals");
    for (unsigned i = 0; i < robot->globals_count; i++) {
        const struct experiment_global *global = &robot->globals[i];
        int place = yaml_tree_key(s->tree, globals, i);
        for (unsigned k = 0; k < i; k++) {
            if (strcmp(robot->globals[k].name, global->name) == 0) {
                return experiment_fault(s, &global->value, place,
                                        "global '%s' stands here a second time", global->name);
            }
        }
        if (!mu_name_valid(global->name)) {
            return experiment_fault(s, &global->value, place,
                                    "expected the name of a global without ?* and *, not '%.80s'",
                                    global->name);
        }
        if (!check_field(global->value)) {
            return experiment_fault(s, &global->value, yaml_tree_value(s->tree, globals, i),
                                    "expected one CLIPS field: a symbol, a number, or '\"text\"', "
                                    "not '%.80s'",
                                    global->value);
        }
    }
    return MU_OK;
}

static mu_result check_groups(struct experiment_source *s, const struct experiment_robot *robot,
                              int node)
{
    int groups = yaml_tree_child(s->tree, node, "groups");
    for (unsigned i = 0; i < robot->groups_count; i++) {
        if (!mu_name_of_group(robot->groups[i])) {
            return experiment_fault(s, NULL, yaml_tree_item(s->tree, groups, i),
                                    "expected the name of a group, not '%.80s'", robot->groups[i]);
        }
    }
    return MU_OK;
}

/* A service, and behind it key=value, separated by spaces. */
static mu_result check_services(struct experiment_source *s, const struct experiment_robot *robot,
                                int node)
{
    int services = yaml_tree_child(s->tree, node, "services");
    for (unsigned i = 0; i < robot->services_count; i++) {
        char name[MU_NAME_MAX + 2];
        const char *service = robot->services[i];
        size_t len = strcspn(service, " ");
        snprintf(name, sizeof name, "%.*s", (int)(len < sizeof name ? len : sizeof name), service);
        if (!mu_name_valid(name) || !mu_attributes_valid(service + len)) {
            return experiment_fault(s, NULL, yaml_tree_item(s->tree, services, i),
                                    "expected a service and its attributes, such as 'mapper "
                                    "role=scout', not '%.80s'",
                                    service);
        }
    }
    return MU_OK;
}

/* Whether the run has a lock step is not known here: the fault is kept for when it has. */
static mu_result check_broker(struct experiment_source *s, struct experiment_robot *robot, int node)
{
    if (!robot->broker) {
        return MU_OK;
    }
    int place = yaml_tree_child(s->tree, node, "broker");
    if (experiment_find_broker(s->experiment, robot->broker) == s->experiment->brokers_count) {
        return experiment_fault(s, NULL, place, "no broker '%.80s' in this experiment's brokers",
                                robot->broker);
    }
    (void)yaml_tree_fault(s->tree, place, &robot->broker_fault,
                          "in lock step all robots are with the first broker; leave it out, or "
                          "run with --free");
    return MU_OK;
}

/* Where a robot begins. */
static mu_result check_host(struct experiment_source *s, const struct experiment_robot *robot,
                            int node)
{
    int host = yaml_tree_child(s->tree, node, "host");
    if (!robot->host) {
        return MU_OK;
    }
    if (experiment_find_host(s->experiment, robot->host) == s->experiment->hosts_count) {
        return experiment_fault(s, NULL, host, "no host '%.80s' in this experiment's hosts",
                                robot->host);
    }
    if (robot->standby) {
        return experiment_fault(s, NULL, host, "expected a host, or standby, not both");
    }
    if (robot->broker || yaml_tree_child(s->tree, node, "processes")) {
        return experiment_fault(s, NULL, host,
                                "expected a host, or processes and a broker, not both");
    }
    return MU_OK;
}

static mu_result check_place(struct experiment_source *s, const struct experiment_robot *robot,
                             int node)
{
    int place = yaml_tree_child(s->tree, node, "place");
    int pose = yaml_tree_child(s->tree, node, "pose");
    if (robot->place && strcmp(robot->place, "random") != 0) {
        return experiment_fault(s, NULL, place, "expected random, not '%.80s'", robot->place);
    }
    if (robot->place && robot->pose) {
        return experiment_fault(s, NULL, place, "expected a place or a pose, not both");
    }
    if (robot->pose && yaml_tree_child(s->tree, node, "count")) {
        return experiment_fault(s, NULL, pose, "expected place: random for many robots");
    }
    if (robot->body && !robot->pose && !robot->place) {
        return experiment_fault(s, &robot->body, yaml_tree_child(s->tree, node, "body"),
                                "expected a pose: [x, y, degrees], or place: random, beside a "
                                "body");
    }
    return MU_OK;
}

/* What a robot does not say of its death is as the experiment has it. */
static mu_result check_death(struct experiment_source *s, struct experiment_robot *robot, int node)
{
    int on_crash = yaml_tree_child(s->tree, node, "on-crash");
    int checkpoint = yaml_tree_child(s->tree, node, "checkpoint");
    if (!on_crash && !experiment_overridden(s, &robot->on_crash)) {
        robot->on_crash = s->experiment->on_crash;
    }
    if (!checkpoint && !experiment_overridden(s, &robot->checkpoint_s)) {
        robot->checkpoint_s = s->experiment->checkpoint_s;
    }
    return check_checkpoint(s, &robot->checkpoint_s, checkpoint);
}

/* What controls it: rules, or a program. */
static mu_result check_mind(struct experiment_source *s, struct experiment_robot *robot, int node)
{
    int rules = yaml_tree_child(s->tree, node, "rules");
    int controller = yaml_tree_child(s->tree, node, "controller");
    char **program = &robot->controller.program;
    if (!robot->rules == !*program) {
        return experiment_fault(s, &robot->rules, *program ? controller : node,
                                "expected either rules: FILE, or controller: {program: FILE}");
    }
    if (!*program) {
        return experiment_check_file(s, &robot->rules, rules, "rules");
    }
    if (robot->globals_count > 0) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "globals"),
                                "expected args of the controller: globals are for rules");
    }
    if (robot->host || robot->standby || robot->broker) {
        return experiment_fault(s, NULL, controller,
                                "expected no host, broker or standby beside a controller");
    }
    /* A recording has no programs. */
    mu_result checked =
        experiment_check_program(s, program, yaml_tree_child(s->tree, controller, "program"));
    return experiment_is_recorded() ? MU_OK : checked;
}

static mu_result check_robot(struct experiment_source *s, size_t index)
{
    struct experiment_robot *robot = &s->experiment->robots[index];
    int node = experiment_member(s, index);
    int name = yaml_tree_child(s->tree, node, "name");
    if (!mu_name_valid(robot->name)) {
        return experiment_fault(s, NULL, name,
                                "expected a name of 1 to %d of A-Z a-z 0-9 _ . - that begins with "
                                "a letter or _, not '%.80s'",
                                MU_NAME_MAX, robot->name);
    }
    if (mu_name_reserved(robot->name)) {
        return experiment_fault(s, NULL, name, "the name '%s' is reserved", robot->name);
    }
    if (experiment_find_robot(s->experiment, robot->name) != robot) {
        return experiment_fault(s, NULL, name, "a second %s with the name '%s'",
                                index < s->experiment->robots_count ? "robot" : "robot or agent",
                                robot->name);
    }
    MU_TRY(check_place(s, robot, node));
    MU_TRY(check_globals(s, robot, node));
    MU_TRY(check_groups(s, robot, node));
    MU_TRY(check_services(s, robot, node));
    MU_TRY(check_broker(s, robot, node));
    MU_TRY(check_death(s, robot, node));
    MU_TRY(check_host(s, robot, node));
    return check_mind(s, robot, node);
}

static bool check_target(const struct experiment *e, const char *target)
{
    static const char *const wide[] = {"all", "robots", "special"};
    for (size_t i = 0; i < sizeof wide / sizeof wide[0]; i++) {
        if (strcmp(target, wide[i]) == 0) {
            return true;
        }
    }
    if (strchr(target, ':')) {
        return mu_address_valid(target);
    }
    return experiment_find_robot(e, target) != NULL;
}

/* A new agent on hosts, with its rules. */
static mu_result check_launch(struct experiment_source *s, struct experiment_command *command,
                              int node)
{
    if (!mu_name_valid(command->launch) || mu_name_reserved(command->launch) ||
        experiment_find_host(s->experiment, command->launch) < s->experiment->hosts_count) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "launch"),
                                "'%.80s' cannot be an agent's name", command->launch);
    }
    return experiment_check_file(s, &command->rules, yaml_tree_child(s->tree, node, "rules"),
                                 "rules");
}

/* What is commanded: a line, a move, or a launch. */
static mu_result check_deed(struct experiment_source *s, struct experiment_command *command,
                            int node)
{
    const struct experiment *e = s->experiment;
    int deeds = (command->line != NULL) + (command->move != NULL) + (command->launch != NULL);
    if (deeds != 1 || !command->launch != !command->rules) {
        return experiment_fault(s, NULL, node,
                                "expected a line, or move: HOST, or launch: NAME and rules: FILE");
    }
    if (command->launch) {
        return check_launch(s, command, node);
    }
    if (command->move && experiment_find_host(e, command->move) == e->hosts_count) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "move"),
                                "no host '%.80s' in this experiment's hosts", command->move);
    }
    return MU_OK;
}

static mu_result check_targets(struct experiment_source *s,
                               const struct experiment_command *command, int node)
{
    const struct experiment *e = s->experiment;
    for (unsigned i = 0; i < command->targets_count; i++) {
        const char *name = command->targets[i];
        int targets = yaml_tree_child(s->tree, node, "do");
        int target = yaml_tree_item(s->tree, targets, i);
        target = target ? target : targets;
        if (command->launch && experiment_find_host(e, name) == e->hosts_count) {
            return experiment_fault(s, NULL, target, "no host '%.80s' in this experiment's hosts",
                                    name);
        }
        if (!command->launch && !check_target(e, name)) {
            return experiment_fault(s, NULL, target,
                                    "no robot '%.80s' in this experiment; expected one of its "
                                    "robots, or all, robots, special, group:NAME, SCHEME:REST",
                                    name);
        }
    }
    return MU_OK;
}

static mu_result check_command(struct experiment_source *s, size_t index)
{
    struct experiment_command *command = &s->experiment->observer[index];
    const struct experiment *e = s->experiment;
    int node = experiment_item(s, "observer", index);
    int at = yaml_tree_child(s->tree, node, "at");
    if (command->at < 0) {
        return experiment_fault(s, NULL, at, "expected a time from 0, not %g", command->at);
    }
    /* A run that is cut short on purpose leaves out its later commands. */
    if (command->at > e->duration && !experiment_overridden(s, &e->duration)) {
        return experiment_fault(s, NULL, at, "expected a time of at most the duration, %g s",
                                e->duration);
    }
    MU_TRY(check_targets(s, command, node));
    return check_deed(s, command, node);
}

mu_result experiment_check(struct experiment_source *source)
{
    const struct experiment *e = source->experiment;
    MU_TRY(check_top(source));
    MU_TRY(check_simulator(source));
    MU_TRY(check_resolvers(source));
    for (size_t i = 0; i < experiment_members(e); i++) {
        MU_TRY(check_robot(source, i));
    }
    MU_TRY(check_hosts(source));
    MU_TRY(experiment_multiply(source));
    for (size_t i = 0; i < e->monitors_count; i++) {
        MU_TRY(experiment_check_monitor(source, i));
    }
    for (size_t i = 0; i < e->observer_count; i++) {
        MU_TRY(check_command(source, i));
    }
    for (size_t i = 0; i < e->expect_count; i++) {
        MU_TRY(experiment_check_expectation(source, i));
    }
    for (size_t i = 0; i < e->chaos_count; i++) {
        MU_TRY(experiment_check_chaos(source, i));
    }
    return MU_OK;
}
